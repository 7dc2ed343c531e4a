"""Tasks from the command line to the files that they leave."""

import json

import numpy as np
import pytest
import torch

from gear_damping.identification.saved import load_estimator
from gear_damping.measurement.load import load_measurement
from gear_damping.reporting.numbers import number
from gear_damping.tasks import dispatch, train
from gear_damping.tasks.command import main

SMALL = ["experiment=backlash", "simulator.n_runs=12", "simulator.n_samples=120", "progress=false"]
QUICK = [*SMALL, "training=smoke", "training.max_epochs=1", "protocol.windows_per_epoch=128"]
SCORES = {"rmse_percent", "rmse_paper", "median_relative_error", "skill", "epochs"}


def record_of(folder):
    return json.loads((folder / "run.json").read_text())


@pytest.fixture
def said(caplog, capsys):
    """Everything that was said so far, through logging or on stderr."""
    return lambda: caplog.text + capsys.readouterr().err


def own(tmp_path):
    return [f"hydra.run.dir={tmp_path / 'run'}", f"data_folder={tmp_path / 'data'}"]


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    folder = tmp_path_factory.mktemp("trained")
    state = torch.random.get_rng_state()
    assert main([*QUICK, "seeds=2", *own(folder)]) == 0
    torch.random.set_rng_state(state)
    return folder / "run"


def test_train_leaves_what_other_programs_read(trained):
    results = json.loads((trained / "results.json").read_text())
    assert results["experiment"] == "backlash"
    assert results["protocol"] == "by_run"
    assert results["family"] == "bench"
    assert results["seeds"] == [0, 1]
    assert set(results["models"]) == {"raw_lstm", "cwt_lstm"}
    assert set(results["controls"]) == {"mean", "white_noise"}
    for scores in (*results["models"].values(), *results["controls"].values()):
        assert set(scores) >= SCORES
        assert set(scores["rmse_percent"]) == {"mean", "std"}
    record = record_of(trained)
    assert record["status"] == "finished"
    assert record["config"]["simulator"]["n_runs"] == 12
    assert record["versions"]["torch"].startswith("2.13.0")
    assert {"revision", "dirty"} == set(record["git"])
    assert record["wall_time_s"] > 0
    assert record["metrics"]["raw_lstm/rmse_percent"] == results["models"]["raw_lstm"]["rmse_percent"]["mean"]


def test_train_leaves_figures_checkpoints_and_events(trained):
    figures = {path.stem for path in trained.glob("*.png")}
    assert figures == {"mesh_stiffness", "response", "scalogram", "predicted_against_true"}
    for model in ("raw_lstm", "cwt_lstm", "white_noise"):
        assert (trained / model / "seed_1" / "best.ckpt").is_file()
        assert list((trained / model / "seed_0").glob("events.*"))
    assert list(trained.glob("events.*"))


def test_a_checkpoint_alone_predicts(trained):
    estimator = load_estimator(trained / "cwt_lstm" / "seed_0" / "best.ckpt")
    record = 1e-5 * torch.sin(torch.arange(200) / 3)
    assert 0 < estimator.predict_record(record, 40e3).damping_ratio_percent < 5


def test_every_trained_network_can_be_shared_and_says_what_its_checkpoint_says(trained):
    record = 1e-5 * torch.sin(torch.arange(200) / 3)
    for place in ("raw_lstm/seed_0", "cwt_lstm/seed_1"):
        shared, kept = (load_estimator(trained / place / name) for name in ("model.safetensors", "best.ckpt"))
        found, expected = (one.predict_record(record, 40e3).per_window_percent for one in (shared, kept))
        assert torch.equal(found, expected)
    assert not (trained / "white_noise" / "seed_0" / "model.safetensors").exists()  # a control is for nobody


def test_a_model_card_says_what_its_run_says(trained):
    card = (trained / "cwt_lstm" / "seed_1" / "model_card.md").read_text()
    results, record = json.loads((trained / "results.json").read_text()), record_of(trained)
    described = json.loads((trained / "cwt_lstm" / "seed_1" / "model.json").read_text())
    rows = {"cwt_lstm |": results["models"]["cwt_lstm"]}
    rows |= {f"{name} (control) |": one for name, one in results["controls"].items()}
    for name, one in rows.items():
        error, (low, high) = one["per_seed"]["rmse_percent"][1], one["per_seed"]["rmse_interval95"][1]
        assert f"| {name} {number(error)} | {number(low)} … {number(high)} |" in card
    for low, high in described["data"]["trained_on"]["ranges"].values():
        assert f"| {number(low)} | {number(high)} |" in card
    for said in ("`transmission_error` in m", "40000 Hz", "bench", "| seed | 1 |", record["command"], "license: mit"):
        assert said in card
    assert record["git"]["revision"] is None or record["git"]["revision"] in card
    assert "no better than a network that was fed white noise" in card  # one epoch of twelve runs


def test_a_model_card_of_the_papers_protocol_does_not_speak_of_unseen_runs(tmp_path):
    small = ["model=raw_lstm", "protocol=paper_many_runs", "protocol.windows_per_epoch=64", "simulator.n_samples=160"]
    assert main([*QUICK, *small, *own(tmp_path)]) == 0
    card = (tmp_path / "run" / "raw_lstm" / "seed_0" / "model_card.md").read_text()
    assert "the very runs that it was trained on (`protocol=paper_many_runs`)" in card
    assert "how well runs are remembered" in card
    assert "never met" not in card


def test_evaluate_asks_a_shared_network(trained, tmp_path):
    shared = trained / "raw_lstm" / "seed_0" / "model.safetensors"
    assert main([*SMALL, "task=evaluate", f"checkpoint={shared}", *own(tmp_path)]) == 0
    assert set(record_of(tmp_path / "run")["inputs"]) == {str(shared), str(shared.with_suffix(".json"))}


def test_a_folder_without_a_network_is_no_checkpoint(trained, tmp_path, said):
    assert main([*SMALL, "task=evaluate", f"checkpoint={trained / 'raw_lstm'}", *own(tmp_path)]) == 1
    assert "is a folder that holds no network" in said()


def test_evaluate_scores_a_checkpoint_on_fresh_runs(trained, tmp_path):
    checkpoint = trained / "raw_lstm" / "seed_0" / "best.ckpt"
    assert main([*SMALL, "task=evaluate", f"checkpoint={checkpoint}", *own(tmp_path)]) == 0
    found = json.loads((tmp_path / "run" / "evaluation.json").read_text())
    assert 0 < found["rmse_percent"] < 2
    assert list(record_of(tmp_path / "run")["inputs"]) == [str(checkpoint)]


def test_evaluate_asks_every_network_of_a_training_and_what_knows_the_equation(trained, tmp_path):
    asked = [f"checkpoint={trained}", "evaluation.snr_db=[30,10]", "evaluation.known_model=true", "family=bench"]
    asked.append("evaluation.effects=['torque_variation:ramp',tooth_crack]")
    assert main([*SMALL, "task=evaluate", *asked, *own(tmp_path)]) == 0
    found = json.loads((tmp_path / "run" / "evaluation.json").read_text())
    networks = {"raw_lstm", "cwt_lstm", "white_noise"}
    for level in found["snr_db"].values():
        assert set(level["estimators"]) == networks | {"output_error", "unscented_kalman", "mean"}
        assert len(level["estimators"]["cwt_lstm"]["per_seed"]) == 2
        assert level["estimators"]["output_error"]["coverage90"] > 0.5
        assert level["estimators"]["output_error"]["rmse_percent"] < level["estimators"]["mean"]["rmse_percent"]
        for one in level["estimators"].values():
            bands = one["by_damping_ratio"]
            assert sum(band["runs"] for band in bands) == found["test_runs"] - found["irregular_runs"]
            whole = sum(band["runs"] * band["rmse_percent"] ** 2 for band in bands) / sum(b["runs"] for b in bands)
            if "per_seed" not in one:  # of several, the mean of roots is no root of the mean
                assert whole**0.5 == pytest.approx(one["rmse_percent"], rel=1e-4)
    assert found["snr_db"]["30"]["bound_percent"] < found["snr_db"]["10"]["bound_percent"]
    assert "| SNR / dB | RMSE / % of | 0.1 to 0.225 %" in (tmp_path / "run" / "evaluation.txt").read_text()
    assert (tmp_path / "run" / "evaluation.png").is_file()
    assert set(found["effects"]) == {"torque_variation:ramp", "tooth_crack"}
    ramp, crack = (found["effects"][name]["10"] for name in ("torque_variation:ramp", "tooth_crack"))
    assert set(ramp) == networks | {"mean"}
    usual = found["snr_db"]["10"]["estimators"]["raw_lstm"]["median_relative_error"]  # the same runs and noise, but
    assert ramp["raw_lstm"]["median_relative_error"] == pytest.approx(usual, rel=1e-5)  # for a ramp after their end
    assert crack["raw_lstm"]["median_relative_error"] != pytest.approx(usual, rel=1e-5)
    assert "| `torque_variation:ramp` | 30 | `raw_lstm` |" in (tmp_path / "run" / "evaluation.txt").read_text()
    assert len(record_of(tmp_path / "run")["inputs"]) == 6


@pytest.mark.parametrize(
    ("asked", "rule"),
    [
        (["evaluation.snr_db=[30,30]"], "a list of different numbers"),
        (["evaluation.snr_db=[30]", "+simulator.sensor_noise={}"], "takes the place of simulator.sensor_noise"),
        (["evaluation.known_model=true", "experiment=noise"], "no estimator knows it"),
        (["family=none"], "has no range of damping ratios"),
        (["evaluation.effects=[tooth_crak]"], "did you mean 'tooth_crack'?"),
        (["evaluation.effects=['torque_variation:ramps']"], "torque_variation has no such form"),
        (["evaluation.effects=[fourier_mesh_stiffness]"], "evaluation.effects: fourier_mesh_stiffness"),
        (["simulator.sampling_rate=20000"], "was trained at 40000 Hz"),
    ],
)
def test_what_cannot_be_evaluated_is_said(asked, rule, trained, tmp_path, said):
    checkpoint = trained / "raw_lstm" / "seed_0" / "best.ckpt"
    assert main([*SMALL, "task=evaluate", f"checkpoint={checkpoint}", *asked, *own(tmp_path)]) == 1
    assert rule in said()


def test_simulated_runs_come_back_as_a_measurement_and_are_identified(trained, tmp_path):
    """simulate -> measurement.yaml -> identify with a trained network."""
    arguments = ["task=simulate", "write_measurement=true", "simulator.n_runs=2", "simulator.sensor_offset={}"]
    assert main([*SMALL, *arguments, *own(tmp_path)]) == 0
    folder = tmp_path / "run"
    with np.load(folder / "runs.npz") as runs:
        assert runs["transmission_error"].shape == (2, 120)
        assert runs["t"][1] == pytest.approx(25e-6)
        response = runs["transmission_error"]
    measurement = load_measurement(folder / "measurement" / "measurement.yaml")
    np.testing.assert_allclose(measurement.records[1].channels["transmission_error"].values, response[1], rtol=1e-9)
    assert (folder / "simulation.png").is_file()
    checkpoint = trained / "raw_lstm" / "seed_0" / "best.ckpt"
    path = folder / "measurement" / "measurement.yaml"
    again = [f"hydra.run.dir={tmp_path / 'again'}", "progress=false"]
    assert main(["task=identify", f"measurement.path={path}", f"checkpoint={checkpoint}", *again]) == 0
    found = json.loads((tmp_path / "again" / "identification.json").read_text())
    assert found["damping_ratio_percent"]["value"] > 0
    assert str(path) in record_of(tmp_path / "again")["inputs"]
    assert all("outside_training" in one for one in found["records"].values())
    assert all(one["interval95"] is None for one in found["records"].values())


def a_measurement(folder, system, channel, unit, values, conditions=""):
    """One record of a channel at the rate that the networks here are trained at."""
    folder.mkdir()
    (folder / "run.csv").write_text("\n".join([channel, *(f"{value:.9g}" for value in values)]) + "\n")
    path = folder / "measurement.yaml"
    path.write_text(
        f"system: {system}\nrecords:\n  - file: run.csv\n    sampling_rate: {{value: 40, unit: kHz}}\n{conditions}"
        f"    channels:\n      {channel}: {{column: {channel}, unit: {unit}}}\n"
    )
    return path


def test_a_network_refuses_records_of_another_system(trained, tmp_path, said):
    path = a_measurement(tmp_path / "other", "oscillator", "displacement", "m", np.sin(np.arange(200.0)) * 1e-5)
    checkpoint = trained / "raw_lstm" / "seed_0" / "best.ckpt"
    asked = ["task=identify", f"measurement.path={path}", f"checkpoint={checkpoint}", "progress=false"]
    assert main([*asked, f"hydra.run.dir={tmp_path / 'run'}"]) == 1
    words = said()
    assert "the estimator was trained on gear_pair, not on oscillator" in words
    assert "train one on that system" in words


def test_a_network_warns_of_records_outside_its_training(trained, tmp_path, said):
    conditions = "    conditions: {pinion_torque: {value: 900, unit: N*m}, pinion_speed: {value: 9000, unit: rpm}}\n"
    wide = 1e-3 * np.sin(np.arange(200.0))
    path = a_measurement(tmp_path / "far", "gear_pair", "transmission_error", "m", wide, conditions)
    checkpoint = trained / "raw_lstm" / "seed_0" / "best.ckpt"
    asked = ["task=identify", f"measurement.path={path}", f"checkpoint={checkpoint}", "progress=false"]
    assert main([*asked, f"hydra.run.dir={tmp_path / 'run'}"]) == 0
    assert "lies outside what the network was trained on" in said()
    (record,) = json.loads((tmp_path / "run" / "identification.json").read_text())["records"].values()
    assert {sentence.split()[0] for sentence in record["outside_training"]} >= {"ac_rms", "pinion_torque"}


def test_an_interrupted_run_says_so_and_can_go_on(tmp_path, monkeypatch, said):
    original = train.compare_models

    def interrupted(*arguments, **options):
        original(*arguments, **options)
        raise KeyboardInterrupt

    monkeypatch.setattr(train, "compare_models", interrupted)
    assert main([*QUICK, "model=raw_lstm", *own(tmp_path)]) == 130
    folder = tmp_path / "run"
    assert record_of(folder)["status"] == "interrupted"
    assert f"resume={folder}" in said()
    assert (folder / "raw_lstm" / "seed_0" / "last.ckpt").is_file()
    monkeypatch.setattr(train, "compare_models", original)
    again = [f"hydra.run.dir={tmp_path / 'again'}", f"data_folder={tmp_path / 'data'}", f"resume={folder}"]
    assert main([*QUICK, "model=raw_lstm", "seed=3", "training.max_epochs=1", *again]) == 1
    assert "was begun with seed = 0 (here 3); remedy: repeat its command" in said()
    assert main([*QUICK, "model=raw_lstm", *again]) == 0


def test_a_defect_is_recorded_as_one(tmp_path, monkeypatch, said):
    def broken(*_):
        raise ZeroDivisionError("oops")

    monkeypatch.setattr(dispatch, "task_of", lambda settings: broken)
    assert main([*QUICK, *own(tmp_path)]) == 1
    record = record_of(tmp_path / "run")
    assert record["status"] == "failed"
    assert "ZeroDivisionError: oops" in record["error"]
    assert "a defect of gear_damping" in said()


def test_a_diverging_simulator_is_never_trained_on(tmp_path, said):
    wild = [
        "simulator.damping_law=null",
        "family.spreads.damping_ratio_percent=null",
        "simulator.power_law_damping.exponent=5",
        "simulator.power_law_damping.coefficient=1e12",
    ]
    assert main([*QUICK, *wild, *own(tmp_path)]) == 1
    assert "12 of 12 runs diverged" in said()
    assert record_of(tmp_path / "run")["status"] == "failed"


def test_a_sweep_over_a_group_says_which_choice_a_job_had(tmp_path):
    quick = ["training=smoke", "training.max_epochs=1", "simulator.n_runs=12", "simulator.n_samples=120"]
    place = [f"hydra.sweep.dir={tmp_path / 'sweep'}", f"data_folder={tmp_path / 'data'}", "progress=false"]
    windows = "protocol.windows_per_epoch=64"
    assert main(["--multirun", "model=raw_lstm", "family=bench,field", windows, *quick, *place]) == 0
    lines = (tmp_path / "sweep" / "sweep.csv").read_text().splitlines()
    assert [line.split(",")[2] for line in lines] == ["family", "bench", "field"]


def test_a_sweep_with_a_failing_job_leaves_its_table(tmp_path):
    quick = [q for q in QUICK if "experiment" not in q]
    sweep = ["experiment=noise", "simulator.load_noise.snr_db=10,-1000,40", "model=raw_lstm"]
    place = [f"hydra.sweep.dir={tmp_path / 'sweep'}", f"data_folder={tmp_path / 'data'}"]
    assert main(["--multirun", *sweep, *quick, *place]) == 1
    lines = (tmp_path / "sweep" / "sweep.csv").read_text().splitlines()
    assert len(lines) == 4
    assert lines[0].startswith("job,status,simulator.load_noise.snr_db,raw_lstm/rmse_percent")
    assert [line.split(",")[1] for line in lines[1:]] == ["finished", "failed", "finished"]
    assert [line.split(",")[2] for line in lines[1:]] == ["10", "-1000", "40"]
    assert "simulator.load_noise.snr_db" in lines[2]
    assert (tmp_path / "sweep" / "sweep.png").is_file()
