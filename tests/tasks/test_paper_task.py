"""task=paper: what it leaves, and that finished parts are kept untouched."""

import hashlib
import json

import pytest
import torch

from gear_damping.tasks.command import main
from gear_damping.tasks.paper import study
from gear_damping.tasks.paper.cases import cases

QUICK = [
    "experiment=paper_figures", "training=smoke", "training.max_epochs=1", "simulator.n_runs=12",
    "simulator.n_samples=160", "protocol.windows_per_epoch=64", "progress=false",
]  # fmt: skip
SHOWN = "figures=[figure_05,figure_12,table_1]"


def digests(folder):
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in (folder / "parts").glob("*.json")}


@pytest.fixture(scope="module")
def studied(tmp_path_factory):
    folder = tmp_path_factory.mktemp("studied")
    state = torch.random.get_rng_state()
    assert main([*QUICK, SHOWN, f"hydra.run.dir={folder / 'run'}", f"data_folder={folder / 'data'}"]) == 0
    torch.random.set_rng_state(state)
    return folder


def again(studied, tmp_path, *more):
    places = [f"hydra.run.dir={tmp_path / 'run'}", f"data_folder={studied / 'data'}", f"resume={studied / 'run'}"]
    return main([*QUICK, SHOWN, *places, *more])


def test_it_leaves_figures_tables_and_every_number(studied):
    names = {path.name for path in (studied / "run").iterdir()}
    assert {"figure_05.png", "figure_12.png", "table_1.md", "paper.md", "paper.json", "run.json"} <= names
    found = json.loads((studied / "run" / "paper.json").read_text())
    assert set(found["learned"]["eccentricity"]) == {"paper", "paper_many_runs", "by_run"}
    for protocol in found["learned"]["eccentricity"].values():
        assert set(protocol["scores"]) == {"raw_lstm", "cwt_lstm", "white_noise", "mean"}
        for scores in protocol["scores"].values():
            assert {"rmse_percent", "rmse_paper"} <= set(scores)
            assert set(scores["rmse_percent"]) == {"mean", "std", "values"}
    one_run = found["learned"]["eccentricity"]["paper"]
    assert one_run["n_runs"] == 1
    always_that_label = one_run["scores"]["mean"]["rmse_percent"]["mean"]
    assert always_that_label == pytest.approx(0, abs=1e-9)
    assert json.loads((studied / "run" / "run.json").read_text())["status"] == "finished"


def test_the_printed_eccentricity_moves_nothing_and_that_of_the_centre_does(studied):
    change = json.loads((studied / "run" / "paper.json").read_text())["physics"]["change"]
    assert change["eccentricity_printed"] < 1e-6
    assert change["eccentricity"] > 0.1


def test_finished_parts_are_kept_to_the_byte(studied, tmp_path, monkeypatch):
    monkeypatch.setattr(study, "learn", lambda *_: pytest.fail("trained again"))
    assert again(studied, tmp_path) == 0
    assert digests(tmp_path / "run") == digests(studied / "run")
    assert len(digests(tmp_path / "run")) == len(cases(["figure_12"]))


def test_a_missing_part_is_made_and_no_other(studied, tmp_path, monkeypatch):
    gone = "eccentricity-by_run-seed_0.json"
    made, learn = [], study.learn
    monkeypatch.setattr(study, "learn", lambda ready, seed, fit: made.append(ready.case) or learn(ready, seed, fit))
    before = digests(studied / "run")
    earlier = tmp_path / "earlier"
    (earlier / "parts").mkdir(parents=True)
    for name in set(before) - {gone}:
        (earlier / "parts" / name).write_bytes((studied / "run" / "parts" / name).read_bytes())
    assert again(studied, tmp_path, f"resume={earlier}") == 0
    assert [(case.effect, case.protocol) for case in made] == [("eccentricity", "by_run")]
    after = digests(tmp_path / "run")
    assert {name: after[name] for name in before if name != gone} == {n: h for n, h in before.items() if n != gone}
    old, new = (json.loads((place / "run" / "parts" / gone).read_text()) for place in (studied, tmp_path))
    assert new["scores"] == old["scores"]  # a training depends on its settings alone


def test_parts_of_another_budget_are_made_anew(studied, tmp_path, monkeypatch):
    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(study, "learn", stop)
    assert again(studied, tmp_path, "training.max_epochs=2") == 130
    assert json.loads((tmp_path / "run" / "run.json").read_text())["status"] == "interrupted"
    assert digests(tmp_path / "run") == digests(studied / "run")  # and none is lost before the new one is there


def test_every_learned_figure_has_its_cases_under_the_protocols_that_it_needs():
    for name in ("figure_07", "figure_08", "figure_12", "figure_13", "figure_15"):
        assert {case.protocol for case in cases([name])} == {"paper", "paper_many_runs", "by_run"}
    assert len(cases(["figure_09"])) == 12
    assert {case.ratio_percent for case in cases(["figure_14"])} == {0.1, 0.2, 0.3, 0.4, 0.5, 0.6}
    assert cases(["figure_04", "figure_10", "table_1"]) == ()
