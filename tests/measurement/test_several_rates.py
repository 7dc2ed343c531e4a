"""Channels of several rates in one file: none folds into another's band, and blank cells are no faults."""

import numpy as np
import pytest
import yaml

from gear_damping.errors import InputError
from gear_damping.measurement.load import load_measurement

RATE, EVERY, COUNT = 1000.0, 5, 4000
TIME = np.arange(COUNT) / RATE
SLOW, FAST = np.sin(2 * np.pi * 7 * TIME), np.sin(2 * np.pi * 190 * TIME)  # 190 Hz are 10 Hz at 200 a second


def _loaded(folder, text, **record):
    (folder / "run.csv").write_text(text)
    channels = {"force": {"column": "F", "unit": "N"}, "displacement": {"column": "x", "unit": "mm"}}
    content = {"file": "run.csv", **record, "channels": channels | record.get("channels", {})}
    (folder / "measurement.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": [content]}))
    return load_measurement(folder / "measurement.yaml").records[0]


def _merged(force, where=lambda k: k % EVERY == 0):
    rows = [
        f"{t:.4f},{f:.6f},{x if where(k) else ''}" for k, (t, f, x) in enumerate(zip(TIME, force, SLOW, strict=True))
    ]
    return "t,F,x\n" + "\n".join(rows)


@pytest.mark.parametrize(
    "clock", [{"channels": {"time": {"column": "t", "unit": "s"}}}, {"sampling_rate": "1 kHz"}], ids=["stamps", "rate"]
)
def test_a_slower_channel_with_blank_cells_between_gives_the_record_its_rate(tmp_path, clock):
    found = _loaded(tmp_path, _merged(SLOW + FAST), **clock)
    assert found.sampling_rate == pytest.approx(RATE / EVERY)
    np.testing.assert_allclose(found.time, TIME[::EVERY])
    np.testing.assert_allclose(found.channels["displacement"].values, SLOW[::EVERY])
    inner = slice(20, -20)
    np.testing.assert_allclose(found.channels["force"].values[inner], SLOW[::EVERY][inner], atol=2e-3)
    kinds = {finding.kind for finding in found.findings}
    assert {"filled_rows", "resampled_away"} <= kinds


def test_blank_cells_that_come_when_they_come_are_faults(tmp_path):
    text = _merged(SLOW, where=lambda k: k % EVERY == 0 and k != 20 * EVERY)
    with pytest.raises(InputError, match="an empty cell"):
        _loaded(tmp_path, text, channels={"time": {"column": "t", "unit": "s"}})


def test_a_faster_channel_with_a_clock_of_its_own_does_not_fold_into_the_record(tmp_path):
    rows = [f"{t:.4f},{f:.6f}" for t, f in zip(TIME, SLOW + FAST, strict=True)]
    slow = [f"{t:.4f},{x:.6f}" for t, x in zip(TIME[::EVERY], SLOW[::EVERY], strict=True)]
    text = "tf,F,t,x\n" + "\n".join(",".join([a, b]) for a, b in zip(rows, slow + [","] * COUNT, strict=False))
    channels = {"time": {"column": "t", "unit": "s"},
                "force": {"column": "F", "unit": "N", "time": {"column": "tf", "unit": "s"}}}  # fmt: skip
    force = _loaded(tmp_path, text, channels=channels).channels["force"].values
    np.testing.assert_allclose(force[20:-20], SLOW[::EVERY][20 : len(force) - 20], atol=2e-3)


def test_a_slower_channel_may_state_its_own_rate_beside_blank_cells(tmp_path):
    own = {"displacement": {"column": "x", "unit": "mm", "sampling_rate": "200 Hz"}}
    found = _loaded(tmp_path, _merged(SLOW), sampling_rate="1 kHz", channels=own)
    np.testing.assert_allclose(found.channels["displacement"].values[:-EVERY], SLOW[:-EVERY], atol=1e-3)
