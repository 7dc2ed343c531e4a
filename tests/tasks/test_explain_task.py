"""`task=explain` from a file of measured decays to its report, on a pendulum-like rig that scipy integrated."""

import json
import re

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp

from gear_damping.explanation.report_schema import Explanation
from gear_damping.tasks.command import main

STIFFNESS, DAMPING, CUBIC, NOISE = 900.0, 0.6, -30.0, 2e-4  # 1/s^2, 1/s, 1/(rad^2 s^2), rad
CHANNELS = {"time": {"column": "time", "unit": "s"}, "displacement": {"column": "angle", "unit": "deg"}}
KEYS = {
    "schema_version", "system", "verdict", "sentences", "causes", "misfit", "residual", "gain", "noise",
    "candidates", "not_observable", "next_experiment", "unexplained", "records", "calibration", "findings",
}  # fmt: skip


def write_decay(path, start, seed):
    time = np.arange(1500) / 100
    found = solve_ivp(
        lambda t, y: (y[1], -STIFFNESS * y[0] - DAMPING * y[1] - CUBIC * y[0] ** 3),
        (0, 15), (start, 0), t_eval=time, rtol=1e-9, atol=1e-12,
    )  # fmt: skip
    angle = np.degrees(found.y[0] + NOISE * np.random.default_rng(seed).normal(size=len(time)))
    np.savetxt(path, np.column_stack([time, angle]), delimiter=",", header="time,angle", comments="")


@pytest.fixture(scope="module")
def explained(tmp_path_factory):
    folder = tmp_path_factory.mktemp("decays")
    records = []
    for name, start, role, seed in (("small", 0.3, "fit", 1), ("large", 0.6, "holdout", 2)):
        write_decay(folder / f"{name}.csv", start, seed)
        records.append({"name": name, "file": f"{name}.csv", "role": role, "channels": CHANNELS})
    path = folder / "measurement.yaml"
    path.write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    run = [f"measurement.path={path}", f"hydra.run.dir={folder / 'run'}", "progress=false"]
    before = path.read_bytes()
    assert main(["task=explain", "simulator=oscillator", "family=none", *run]) == 0
    assert path.read_bytes() == before
    return folder / "run"


def test_the_hidden_stiffness_is_named_with_its_size(explained):
    content = json.loads((explained / "explanation.json").read_text())
    Explanation.model_validate(content)
    assert set(content) >= KEYS
    assert content["verdict"] == "explained"
    cause = content["causes"][0]
    assert (cause["name"], cause["status"]) == ("cubic_stiffness", "established")
    size = cause["parameters"]["coefficient"]
    assert size["value"] == pytest.approx(CUBIC * np.radians(1) ** 2, rel=0.05)
    assert size["unit"] == "1/deg^2/s^2"
    assert content["misfit"]["before"] > 4
    assert content["misfit"]["after"] < 1.2
    assert content["noise"]["value"] == pytest.approx(np.degrees(NOISE), rel=0.1)
    after = content["gain"]["damping_ratio_percent"]["after"]
    assert after["value"] == pytest.approx(100 * DAMPING / 2 / STIFFNESS**0.5, rel=0.02)


def test_the_report_needs_nothing_beside_itself(explained):
    page = (explained / "report.html").read_text()
    for said in ("What is random, and what is not", "Too few records tell of it", "How visible each effect is"):
        assert said in page
    assert "cubic_stiffness" in page
    assert "With it only noise is left." in page
    assert not re.findall(r"(?:src|href)=\"(?!data:|#)", page)
    assert page.count("<svg") + page.count("data:image") >= 4


def test_the_extended_simulator_runs_again(explained, tmp_path):
    extended = explained / "extended_simulator.yaml"
    rig = ["simulator=oscillator", "family=none", "simulator.n_samples=50"]
    run = [*rig, f"simulator.extended={extended}", f"hydra.run.dir={tmp_path}", "progress=false"]
    assert main(["task=simulate", *run]) == 0
    config = json.loads((tmp_path / "run.json").read_text())
    assert str(extended) in config["inputs"]
    assert "cubic_stiffness" in yaml.safe_load(extended.read_text())
    assert yaml.safe_load(extended.read_text())["unit"] == "deg"
    assert json.loads((tmp_path / "simulation.json").read_text())["unit"] == "deg"
    with np.load(tmp_path / "runs.npz") as runs:
        assert np.isfinite(runs["displacement"]).all()


def test_a_used_folder_is_not_written_over(explained, caplog, capsys):
    kept, said = ((explained / name).read_bytes() for name in ("extended_simulator.yaml", "run.json"))
    again = [f"measurement.path={explained.parent / 'measurement.yaml'}", f"hydra.run.dir={explained}"]
    assert main(["task=explain", "simulator=oscillator", "family=none", "progress=false", *again]) == 1
    assert "holds an extended_simulator.yaml already" in caplog.text + capsys.readouterr().err
    assert (explained / "extended_simulator.yaml").read_bytes() == kept
    assert (explained / "run.json").read_bytes() == said, "how the first run ended stays known"
