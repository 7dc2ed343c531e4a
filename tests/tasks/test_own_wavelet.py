"""A wavelet from outside: one file transforms, is trained on, and is asked for again."""

import math
import runpy
from pathlib import Path

import numpy as np
import pytest

import gear_damping as gd
from gear_damping.tasks.command import main

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "docs" / "examples" / "my_wavelet.py"
OWN = [f"model.plugins=[{EXAMPLE}]", "wavelet.kind=fourth_derivative"]
SMALL = [
    "experiment=backlash", "model=cwt_lstm", "training=smoke", "training.max_epochs=1", "simulator.n_runs=12",
    "simulator.n_samples=120", "protocol.windows_per_epoch=128", "model.hidden_size=4", "progress=false",
]  # fmt: skip


def test_it_is_trained_on_and_asked_for_again(tmp_path):
    places = [f"hydra.run.dir={tmp_path / 'run'}", f"data_folder={tmp_path / 'data'}"]
    assert main([*SMALL, *OWN, *places]) == 0
    checkpoint = tmp_path / "run" / "cwt_lstm" / "seed_0" / "best.ckpt"
    module = gd.load_estimator(checkpoint, plugins=[str(EXAMPLE)]).module
    assert module.front_end.transform.name == "fourth_derivative"
    assert module.front_end.transform.peak_number == 2.0
    with pytest.raises(gd.InputError, match=r"'fourth_derivative': no such wavelet; .*needs model.plugins"):
        gd.load_estimator(checkpoint)


def test_a_simulation_is_transformed_by_its_definition():
    wavelet = runpy.run_path(str(EXAMPLE))["FourthDerivative"]
    model = gd.Model(gd.GearPair(), [gd.FourierMeshStiffness(), gd.ViscousDamping(damping_coefficient=200.0)])
    runs = gd.simulate(model, sampling_rate=40e3, n_samples=150)
    found, frequencies = runs.cwt(wavelet, frequencies_hz=[2000.0, 5000.0])
    values = np.asarray(runs.transmission_error[0])
    for row, frequency in zip(np.asarray(found)[0], frequencies, strict=True):
        scale = math.sqrt(4.5) * 40e3 / (2 * math.pi * frequency)
        for n in (20, 75, 140):
            t = (np.arange(150) - n) / scale
            mother = (t**4 - 6 * t**2 + 3) * np.exp(-(t**2) / 2) / math.sqrt(math.gamma(4.5))
            assert row[n] == pytest.approx(float(values @ mother) / math.sqrt(scale), rel=1e-6, abs=1e-12)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["wavelet.kind=riker"], "wavelet.kind = 'riker': must be one of morlet, ricker"),
        (["wavelet.omega0=7"], "wavelet.omega0 = 7: belongs to the Morlet wavelet; remedy: choose wavelet=morlet"),
        (["wavelet=morlet", "wavelet.omega0=3"], "wavelet.omega0 = 3: must lie within 5 and 100"),
        (["wavelet=morlet", "wavelet.magnitude=2"], "wavelet.magnitude = 2: must be true or false"),
        ([*OWN, "wavelet.omega=7"], "wavelet.omega: no such key"),
        (["wavelet.n_scales=1"], "wavelet.n_scales = 1: must lie within 2 and 4096"),
    ],
)
def test_what_is_wrong_is_said_before_anything_runs(more, said, tmp_path, caplog):
    assert main([*SMALL, *more, f"hydra.run.dir={tmp_path / 'run'}"]) == 1
    assert said in caplog.text


def test_the_page_shows_the_file_as_it_is():
    page = (ROOT / "docs" / "your_own_wavelet.md").read_text()
    assert page.split("```python\n")[1].split("```")[0] in EXAMPLE.read_text()
