"""A free decay of six periods with its last third held out is named right, and said to be short with what would do."""

from functools import cache

import numpy as np
import pytest
import yaml
from hidden.oscillator.inputs import NONE
from hidden.oscillator.laws import members
from hidden.oscillator.motion import between, move

from gear_damping.explanation.explain import Listener, explain
from gear_damping.measurement.load import load_measurement

FREQUENCY, RATIO, SAMPLES = 2.0, 0.02, 40  # Hz, of critical, a period
START, NOISE = 3.0, 3e-3  # mm at rest; mm
KNOBS = {"linear": {}, "dry": {"dry": 0.02, "dry_width": 1e-3}, "cubic": {"cubic": 0.3}}


def decay(kind: str, periods: float) -> tuple[np.ndarray, np.ndarray]:
    """Stamps in s and displacement in mm of an oscillator that is let go at one natural amplitude of 1 mm."""
    motion = move(members([{"zeta": RATIO} | KNOBS[kind]]), [NONE], np.array([[1.0], [0.0]]), 2 * np.pi * periods + 1)
    time = np.arange(round(periods * SAMPLES)) / SAMPLES
    noise = NOISE * np.random.default_rng(5).standard_normal(len(time))
    return time / FREQUENCY, START + between(motion, 0, 2 * np.pi * time, 0) + noise


@cache
def explained(kind: str, periods: float, folder, library: tuple[str, ...] | None = None):
    """The answer to one record, and what was said on the way."""
    time, displacement = decay(kind, periods)
    path = folder / f"{kind}_{periods}"
    path.mkdir()
    np.savetxt(path / "decay.csv", np.c_[time, displacement], delimiter=",", header="t,x", comments="")
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "mm"}}
    content = {"system": "oscillator", "records": [{"file": "decay.csv", "channels": channels}]}
    (path / "measurement.yaml").write_text(yaml.safe_dump(content))
    said: list[str] = []
    chosen = {} if library is not None else None
    answer = explain(load_measurement(path / "measurement.yaml"), Listener(said.append), library=chosen).content
    return answer, said


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("short_decay")


def test_a_linear_one_is_consistent_with_its_damping(folder):
    content, _ = explained("linear", 6.0, folder)
    assert (content["verdict"], content["causes"]) == ("consistent", [])
    low, high = content["gain"]["damping_ratio_percent"]["after"]["interval95"]
    assert low < 100 * RATIO < high
    assert high - low < 0.4


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "names"),
    [("dry", {"coulomb_friction"}), ("cubic", {"cubic_stiffness"})],
)
def test_one_with_a_clear_effect_is_named(kind, names, folder):
    content, _ = explained(kind, 6.0, folder)
    first = content["causes"][0]
    assert first["status"] == "established", content["sentences"]
    assert first["name"] in names
    held = content["residual"]["holdout"]
    assert held["after"] ** 2 < 1.5 * NOISE**2 < held["before"] ** 2  # the noise that was drawn: 80 samples tell little


def test_what_is_short_is_said_once_the_frequency_is_known_and_with_the_verdict(folder):
    content, said = explained("linear", 6.0, folder)
    (short,) = [sentence for sentence in said if sentence.startswith("This record holds 6")]
    assert "natural periods of 2 Hz" in short.replace("2.0", "2")
    assert "at least 24 are needed to judge more than large effects: record at least 12 s" in short
    assert content["sentences"][-1] == short


def test_what_is_long_enough_is_not_called_short(folder):
    content, said = explained("linear", 30.0, folder, ())
    assert not any("needed to judge" in sentence for sentence in (*said, *content["sentences"]))
