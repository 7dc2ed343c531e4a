"""Estimators of records from the command line: those of the package, one's own, and what does not go together."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

import gear_damping as gd
from gear_damping.tasks.command import main

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "docs" / "examples" / "my_record_estimator.py"
RATE, OMEGA, RATIO = 500.0, 2 * np.pi * 10, 0.01


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    folder = tmp_path_factory.mktemp("decay")
    time, random = np.arange(3000) / RATE, np.random.default_rng(1)
    values = 2e-3 * np.exp(-RATIO * OMEGA * time) * np.cos(OMEGA * (1 - RATIO**2) ** 0.5 * time)
    np.savetxt(folder / "a.csv", values + 1e-5 * random.normal(size=3000), "%.9g", header="x", comments="")
    record = "{file: a.csv, name: fall, sampling_rate: 500 Hz, channels: {displacement: {column: x, unit: m}}}"
    (folder / "measurement.yaml").write_text(f"system: oscillator\nrecords:\n- {record}\n")
    return folder / "measurement.yaml"


def run(measured, folder, *more):
    asked = ["task=identify", f"measurement.path={measured}", "progress=false", f"hydra.run.dir={folder}", *more]
    return main(asked)


def test_all_of_them_in_one_table_and_one_figure(measured, tmp_path, capsys):
    assert run(measured, tmp_path / "run", "model=classical") == 0
    found = json.loads((tmp_path / "run" / "damping.json").read_text())["records"]["fall"]
    assert set(found) == {"log_decrement", "half_power", "hilbert_envelope", "wavelet_ridge", "output_error"}
    for one in found.values():
        assert one["damping_ratio_percent"] == pytest.approx(100 * RATIO, rel=0.01)
    assert (tmp_path / "run" / "damping.png").stat().st_size > 10_000
    assert "wavelet_ridge" in capsys.readouterr().err
    metrics = json.loads((tmp_path / "run" / "run.json").read_text())["metrics"]
    assert metrics["half_power/damping_ratio_percent"] == found["half_power"]["damping_ratio_percent"]


def test_the_settings_of_one_count(measured, tmp_path):
    found = []
    for omega0 in (6, 12):
        folder = tmp_path / str(omega0)
        assert run(measured, folder, "model=wavelet_ridge", f"model.omega0={omega0}") == 0
        one = json.loads((folder / "damping.json").read_text())["records"]["fall"]["wavelet_ridge"]
        found.append(one["damping_ratio_percent"])
    assert found[0] != found[1]


def test_a_motion_under_a_random_load_is_asked_by_name(tmp_path):
    load = np.random.default_rng(5).normal(size=20000)
    pole = np.exp((-RATIO * OMEGA + 1j * OMEGA * (1 - RATIO**2) ** 0.5) / RATE)
    values = lfilter([0, 1.0], [1, -2 * pole.real, abs(pole) ** 2], load)
    np.savetxt(tmp_path / "a.csv", values, "%.9g", header="x", comments="")
    record = "{file: a.csv, name: wind, sampling_rate: 500 Hz, channels: {displacement: {column: x, unit: m}}}"
    (tmp_path / "measurement.yaml").write_text(f"system: oscillator\nrecords:\n- {record}\n")
    found = []
    for band in ("1.6", "1.2"):
        where = tmp_path / band
        assert run(tmp_path / "measurement.yaml", where, "model=ambient_spectrum", f"model.band={band}") == 0
        found.append(json.loads((where / "damping.json").read_text())["records"]["wind"]["ambient_spectrum"])
        assert found[-1]["interval95"][0] < 100 * RATIO < found[-1]["interval95"][1]
    assert found[0]["damping_ratio_percent"] != found[1]["damping_ratio_percent"]


def test_one_from_outside_stands_beside_them(measured, tmp_path):
    own = [f"model.plugins=[{EXAMPLE}]", "model.names=[energy_fall,log_decrement]", "model.periods=4"]
    assert run(measured, tmp_path / "run", *own) == 0
    found = json.loads((tmp_path / "run" / "damping.json").read_text())["records"]["fall"]
    assert found["energy_fall"]["damping_ratio_percent"] == pytest.approx(100 * RATIO, rel=0.01)
    low, high = found["energy_fall"]["interval95"]
    assert low < 100 * RATIO < high
    assert str(EXAMPLE) in json.loads((tmp_path / "run" / "run.json").read_text())["inputs"]


def test_what_save_left_is_asked_as_its_settings_are(measured, tmp_path):
    gd.estimator("wavelet_ridge", omega0=9).save(tmp_path / "ridge.json")
    assert run(measured, tmp_path / "kept", f"checkpoint={tmp_path / 'ridge.json'}") == 0
    assert run(measured, tmp_path / "typed", "model=wavelet_ridge", "model.omega0=9") == 0
    kept, typed = (json.loads((tmp_path / name / "damping.json").read_text()) for name in ("kept", "typed"))
    assert kept["records"] == typed["records"]
    assert list(kept["records"]["fall"]) == ["wavelet_ridge"]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["model=wavelet_ridge", "model.omega0=1"], "model.omega0 = 1: must lie within 5 and 100"),
        (["model=wavelet_ridge", "model.smoothing=0.2"], "model.smoothing: no such key"),
        (["model=wavelet_ridge", "wavelet=morlet"], "the estimator wavelet_ridge has model.omega0"),
        (["model=ambient_spectrum", "model.band=9"], "model.band = 9: must lie within 1.1 and 4"),
        (["model=half_power", "model.draws=20.5"], "model.draws = 20.5: must be a whole number"),
        (["model=cwt_lstm"], "names a network, which tells nothing before it is trained"),
        (["model.names=[wavelet_ridge,raw_lstm]"], "names a network, which tells nothing before it is trained"),
        (["model=classical", f"checkpoint={EXAMPLE}"], "is of a network, and model names log_decrement"),
        (["model=wavelet_ridge", "measurement.channel=velocity"], "no such channel"),
    ],
)
def test_what_does_not_go_together_is_said(measured, tmp_path, capfd, caplog, more, said):
    assert run(measured, tmp_path / "run", *more) == 1
    assert said in capfd.readouterr().err + caplog.text


def test_what_learns_nothing_is_not_trained(tmp_path, caplog):
    assert main(["task=train", "model=wavelet_ridge", f"hydra.run.dir={tmp_path / 'run'}"]) == 1
    assert "wavelet_ridge has nothing to learn: it takes a record by itself" in caplog.text
    assert "choose task=identify" in caplog.text


def test_an_extended_simulation_is_what_is_fitted_and_its_law_is_drawn(measured, tmp_path):
    extended = tmp_path / "extended_simulator.yaml"
    text = f"system: oscillator\nstiffness: {1.05 * OMEGA**2}\nviscous_damping: {{damping_coefficient: 1.0}}\n"
    extended.write_text(text)
    more = ["family=none", f"simulator.extended={extended}"]
    assert run(measured, tmp_path / "fit", *more) == 0
    found = json.loads((tmp_path / "fit" / "identification.json").read_text())
    assert found["damping_ratio_percent"]["value"] == pytest.approx(100 * RATIO, rel=0.01)
    assert set(found["parameters"]) >= {"stiffness", "viscous_damping.damping_coefficient"}
    assert run(measured, tmp_path / "both", *more, "model=wavelet_ridge") == 0
    law = json.loads((tmp_path / "both" / "damping.json").read_text())["laws"]["fall"]["extended simulation"]
    np.testing.assert_allclose(law["curve"]["damping_ratio_percent"], 100 * RATIO, rtol=0.01)
