"""A nominal model of the records that it follows, where one is of another kind."""

from dataclasses import dataclass, field, replace
from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.model import followed as followed_module
from gear_damping.explanation.model.followed import followed_alone, of_one_flank
from gear_damping.identification.output_error.records import Observed

NOISE, SAMPLES = 0.01, 400


@dataclass(frozen=True)
class Records:
    """What the function asks of its evidence."""

    fit: tuple
    noise: float = NOISE
    settings: SimpleNamespace = field(default_factory=lambda: SimpleNamespace(lost_share=0.5))

    @property
    def fitted(self):
        return self.fit


def record(name, kind=0):
    wave = torch.sin(torch.linspace(0, 40, SAMPLES, dtype=torch.float64))
    shown = Observed()
    return SimpleNamespace(name=name, kind=kind, stacked=wave, observed=shown, channels=[shown], pieces=())


def fitted(evidence):
    """One model for all: it leaves everything as soon as a record of another kind is among them."""
    generator = torch.Generator().manual_seed(len(evidence.fit))
    kinds = {one.kind for one in evidence.fit}
    scales = [NOISE if len(kinds) == 1 else 1.0 + one.kind for one in evidence.fit]
    left = [s * torch.randn(SAMPLES, generator=generator, dtype=torch.float64) for s in scales]
    return SimpleNamespace(fit_residuals=left)


def calibrated(evidence):
    """To a part of the records, and to all."""
    yield fitted(evidence)
    yield fitted(evidence)


def followed(*kinds):
    evidence = Records(tuple(record(f"run_{i}", kind) for i, kind in enumerate(kinds)))
    return followed_alone(fitted(evidence), evidence, calibrated)


def test_one_record_of_another_kind_is_left_out():
    found, kept = followed(0, 0, 0, 1, 0, 0)
    assert [one.name for one in kept.fit] == ["run_0", "run_1", "run_2", "run_4", "run_5"]
    assert max(float(r.square().mean()) for r in found.fit_residuals) < 2 * NOISE**2


def test_records_of_one_kind_stay_together():
    assert followed(0, 0, 0, 0) is None


def test_no_more_than_a_third_is_left_out():
    assert followed(0, 0, 0, 0, 1, 2) is None  # not one, of six, but two kinds: the first helps too little
    assert followed(0, 1) is None


def test_what_a_part_of_the_records_denies_is_not_fitted_to_all_of_them():
    """Beside a bearing that gave way in all records, the whole of four of five took 15 of 80 s to say the same."""
    evidence = Records(tuple(record(f"run_{i}", kind) for i, kind in enumerate((0, 0, 0, 1, 2))))
    asked = []

    def told(kept):
        for place in ("part", "whole"):
            asked.append(place)
            yield fitted(kept)

    assert followed_alone(fitted(evidence), evidence, told) is None
    assert asked == ["part"]


@pytest.mark.parametrize("level", [2.0, 4.0])
def test_noise_alone_is_no_loss(level):
    evidence = Records((record("run_0"), record("run_1"), record("run_2", 1)))
    quiet = replace(evidence, noise=1.0)  # the waves themselves are below it
    levels = (level, level, 1.2 * level)
    left = SimpleNamespace(fit_residuals=[torch.full((SAMPLES,), one, dtype=torch.float64) for one in levels])
    assert (followed_alone(left, quiet, calibrated) is None) == (level < 3)


def driven(name, torque):
    return SimpleNamespace(name=name, inputs={} if torque is None else {"pinion_torque": torch.as_tensor(torque)})


def steps(*levels):
    return torch.cat([torch.full((100,), float(level), dtype=torch.float64) for level in levels])


@pytest.fixture
def crossed(monkeypatch):
    """The names of records whose error shows that flanks change; none at first."""
    names = set()
    monkeypatch.setattr(followed_module, "are_crossed", lambda evidence: [r.name in names for r in evidence.fit])
    return names


def test_a_record_whose_torque_changes_its_sign_is_left_out_of_the_nominal_fit(crossed):
    zero = steps(30.0, -0.5)  # a meter whose zero is off
    evidence = Records((driven("a", steps(20, 40)), driven("b", steps(-20, 25)), driven("c", None), driven("d", zero)))
    assert [one.name for one in of_one_flank(evidence).fit] == ["a", "c", "d"]


def test_a_record_whose_flanks_change_under_a_steady_torque_is_left_out_too(crossed):
    crossed.add("b")
    evidence = Records(tuple(driven(name, steps(20, 25)) for name in "abc"))
    assert [one.name for one in of_one_flank(evidence).fit] == ["a", "c"]
    crossed.update("ac")
    assert of_one_flank(evidence) is evidence


def test_where_all_or_no_torques_change_their_sign_all_records_stay(crossed):
    for torque in (steps(-20, 25), steps(20, 25), steps(-20, -25)):
        evidence = Records((driven("a", torque), driven("b", torque)))
        assert of_one_flank(evidence) is evidence
