"""An estimator from outside: one file is trained beside the others, kept, and asked again."""

import json
from pathlib import Path

import numpy as np
import pytest

import gear_damping as gd
from gear_damping.tasks.command import main

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "docs" / "examples" / "my_estimator.py"
OWN = [f"model.plugins=[{EXAMPLE}]", "model.names=[raw_convolution]"]
SMALL = [
    "experiment=backlash", "training=smoke", "training.max_epochs=1", "simulator.n_runs=12", "simulator.n_samples=120",
    "protocol.windows_per_epoch=128", "progress=false",
]  # fmt: skip


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    folder = tmp_path_factory.mktemp("own")
    places = [f"hydra.run.dir={folder / 'run'}", f"data_folder={folder / 'data'}"]
    own = [f"model.plugins=[{EXAMPLE}]", "model.names=[raw_lstm,raw_convolution]", "model.channels=4"]
    assert main([*SMALL, *own, "model.dropout=0", *places]) == 0
    return folder / "run"


@pytest.fixture
def measured(tmp_path):
    time = np.arange(200) / 40e3
    values = 1e-5 * (1 + 0.3 * np.sin(2 * np.pi * 3000 * time))
    np.savetxt(tmp_path / "a.csv", values, "%.9g", header="te", comments="")
    channels = "{transmission_error: {column: te, unit: m}}"
    held = "conditions: {pinion_torque: 150 N*m, pinion_speed: 4600rpm}"
    text = f"system: gear_pair\nrecords:\n- {{file: a.csv, sampling_rate: 40 kHz, channels: {channels}, {held}}}\n"
    (tmp_path / "measurement.yaml").write_text(text)
    return tmp_path / "measurement.yaml"


def test_it_is_trained_beside_the_others(trained):
    results = json.loads((trained / "results.json").read_text())
    assert set(results["models"]) == {"raw_lstm", "raw_convolution"}
    assert results["models"]["raw_convolution"]["rmse_percent"]["mean"] > 0


def test_it_has_the_settings_that_were_given(trained):
    module = gd.load_estimator(trained / "raw_convolution" / "seed_0" / "best.ckpt", plugins=[str(EXAMPLE)]).module
    assert module.hparams["settings"] == {"channels": 4, "layers": 3, "dropout": 0}
    assert module.network.dense.in_features == 4
    assert gd.load_estimator(trained / "raw_lstm" / "seed_0" / "best.ckpt").module.hparams["settings"]["dropout"] == 0


def test_a_checkpoint_runs_no_code_of_its_own(trained):
    path = trained / "raw_convolution" / "seed_0" / "best.ckpt"
    with pytest.raises(gd.InputError, match=r"no such estimator; .*needs model.plugins=\[its file\]"):
        gd.load_estimator(path)
    assert str(EXAMPLE) not in path.read_bytes().decode("latin-1")


def test_it_is_asked_again_from_the_command_line(trained, measured, tmp_path):
    checkpoint = trained / "raw_convolution" / "seed_0" / "best.ckpt"
    asked = ["task=identify", f"measurement.path={measured}", f"checkpoint={checkpoint}", "progress=false"]
    place = f"hydra.run.dir={tmp_path / 'asked'}"
    assert main([*asked, f"model.plugins=[{EXAMPLE}]", place]) == 0
    found = json.loads((tmp_path / "asked" / "identification.json").read_text())
    assert found["damping_ratio_percent"]["value"] > 0


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (
            ["model.names=[raw_convolution]"],
            "model.names = ['raw_convolution']: must be one of ambient_spectrum, cwt_lstm, half_power",
        ),
        ([*OWN, "model.layers=99"], "model.layers = 99: must lie within 1 and 10"),
        ([*OWN, "model.hidden_size=9"], "model.hidden_size: no such key"),
        ([*OWN, "model.chanels=3"], "did you mean 'channels'?"),
        (["model.plugins=[nowhere.py]"], "model.plugins = 'nowhere.py': no such file"),
        (["model.plugins=[README.md]"], "is no Python file"),
        ([f"model.plugins=[{ROOT / 'docs/examples/my_effect.py'}]"], "declares no estimator"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_before_anything_runs(more, said, tmp_path, caplog):
    assert main([*SMALL, *more, f"hydra.run.dir={tmp_path / 'run'}"]) == 1
    assert said in caplog.text


def test_a_line_of_it_that_fails_is_named(tmp_path, capfd):
    copy = tmp_path / "broken.py"
    copy.write_text(EXAMPLE.read_text().replace("self.body(features.transpose(1, 2)).mean(-1)", "features.nothing"))
    own = [f"model.plugins=[{copy}]", "model.names=[raw_convolution]", f"data_folder={tmp_path / 'data'}"]
    assert main([*SMALL, *own, f"hydra.run.dir={tmp_path / 'run'}"]) == 1
    said = capfd.readouterr().err
    assert f"model.plugins = '{copy}': line " in said
    assert "in state, fails with AttributeError" in said


def test_the_run_remembers_the_file(trained):
    assert str(EXAMPLE) in json.loads((trained / "run.json").read_text())["inputs"]


def test_a_name_that_is_taken_is_refused(tmp_path, caplog):
    copy = tmp_path / "twice.py"
    copy.write_text(EXAMPLE.read_text().replace('"raw_convolution"', '"raw_lstm"'))
    assert main([*SMALL, f"model.plugins=[{copy}]", f"hydra.run.dir={tmp_path / 'run'}"]) == 1
    assert "repeats the name ['raw_lstm']" in caplog.text


@pytest.mark.parametrize(("place", "name"), [(1, "my_record_estimator.py"), (2, "my_estimator.py")])
def test_the_page_shows_the_files_as_they_are(place, name):
    page = (ROOT / "docs" / "your_own_estimator.md").read_text()
    shown = page.split("```python\n")[place].split("```")[0]
    assert shown in (ROOT / "docs" / "examples" / name).read_text()
