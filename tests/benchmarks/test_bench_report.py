"""What the benchmarks write: medians and ratios, engines that are missing, parts of a run."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from benchmarks import harness, reference, report
from benchmarks.members import draw
from benchmarks.simulating import Plan, climb
from benchmarks.transforming import direct_sum, transform_error


class Timed:
    """Stands for a process; says the times it was given, then fails."""

    def __init__(self, *seconds):
        self.seconds = list(seconds)

    def run(self):
        if not self.seconds:
            raise harness.PeerError("no memory")
        return {"cpu": self.seconds.pop(0), "wall": 1.0}

    def close(self):
        pass


def contest(**processes):
    contestants = [harness.Contestant(name, process, 10) for name, process in processes.items()]
    harness.interleave(contestants, 3)
    return {row["engine"]: row for row in harness.rows("cwt", 64, contestants)}


def results(folder, work, rows):
    found = {
        "machine": {"processor": "P", "cores": 2, "system": "S", "python": "3", "torch": "2", "threads": 1},
        "rows": rows, "parts": {work: {"seconds": 1, "quick": False}}, **{name: [] for name in report.TABLES},
    }  # fmt: skip
    report.write(folder, report.merged(folder, found))
    return json.loads((folder / "results.json").read_text())


def test_rows_have_medians_and_ratios():
    rows = contest(ours=Timed(1.0, 9.0, 2.0), peer=Timed(6.0, 5.0, 6.0))
    assert rows["ours"]["cpu_ms_per_item"] == 200
    assert rows["peer"]["ratio_to_ours"] == 3
    wanted = {"work", "engine", "batch", "error_p90", "cpu_ms_per_item", "wall_ms_per_item", "ratio_to_ours"}
    assert wanted <= set(rows["peer"])


def test_an_engine_that_fails_is_a_row_with_its_reason():
    rows = contest(ours=Timed(1.0, 1.0, 1.0), peer=Timed(1.0))
    assert rows["peer"]["reason"] == "no memory"
    assert rows["peer"]["cpu_ms_per_item"] is None
    assert rows["peer"]["ratio_to_ours"] is None


def test_an_engine_that_is_not_installed_is_a_row_with_its_reason(tmp_path, monkeypatch):
    monkeypatch.setattr("benchmarks.simulating.PEERS", tmp_path / "python")
    plan = Plan("diffrax", "simulation_peers", "tolerance", (1e-3,))
    found = climb(plan, {}, np.ones((1, 1)), 4, 90, 1e-5, lambda line: None)
    assert "make bench-setup" in harness.rows("simulate_smooth", 4, [found])[0]["reason"]


def test_parts_of_runs_on_one_machine_are_put_together(tmp_path):
    first, second = (
        list(contest(ours=Timed(1.0, 1.0, 1.0), irfft=Timed(t, t, t)).values()) for t in (0.5, 0.8)
    )  # fmt: skip
    results(tmp_path, "train", [row | {"work": "train"} for row in first])
    results(tmp_path, "cwt", first)
    found = results(tmp_path, "cwt", second)
    assert [row["ratio_to_ours"] for row in found["rows"]] == [1, 0.5, 1, 0.8]
    table = (tmp_path / "table.md").read_text()
    assert "≥ 0.667 |" in table  # an inverse FFT may cost two thirds of ours, or more
    assert "(short)" not in table


def test_a_ratio_below_its_target_is_marked(tmp_path):
    rows = contest(ours=Timed(1.0, 1.0, 1.0), ptwt=Timed(9.0, 9.0, 9.0))
    results(tmp_path, "cwt", list(rows.values()))
    assert "| 9 | ≥ 10 (short) |" in (tmp_path / "table.md").read_text()


def test_the_reference_of_smooth_motion_settles_where_the_mean_stiffness_holds_the_load():
    members = draw(1)
    found = reference.smooth(members)
    assert found.shape == (1, 2000)
    assert found[:, 0] == pytest.approx(members.natural()["y0"])
    assert np.abs(found.mean(axis=1) - 1) == pytest.approx(0, abs=0.15)


def test_members_of_small_batches_are_the_first_of_large_ones():
    assert np.array_equal(draw(4).torque, draw(9).torque[:4])


def test_the_transform_error_leaves_out_a_common_factor_only():
    signals = np.random.default_rng(0).standard_normal((2, 100))
    exact = direct_sum(signals, [2.0, 4.0])
    assert transform_error(3 * exact, exact) < 1e-12
    assert transform_error(exact * np.array([1.0, 2.0])[:, None], exact) > 0.1


def test_the_transform_of_a_pulse_is_the_wavelet():
    pulse = np.zeros((1, 101))
    pulse[0, 50] = 1
    peak = 2 / (np.sqrt(3) * np.pi**0.25) / np.sqrt(3.0)
    assert direct_sum(pulse, [3.0])[0, 0, 50] == pytest.approx(peak)
