"""How the free motion about a fitted one goes on, against the closed form of a decay; and what a random load leaves."""

import math

import numpy as np
import pytest
import torch
from closed_forms import pushed_decay

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.fitting import fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.explanation.trials.assess import assessed
from gear_damping.explanation.trials.innovations import recurrences
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.systems.oscillator import Oscillator

STIFFNESS, DAMPING, RATE, NOISE, SAMPLES = (2 * math.pi * 10) ** 2, 2.0, 100.0, 2e-4, 1200
COEFFICIENT = "viscous_damping.damping_coefficient"


def pushed(load, seed):
    """A decay from .05 that is pushed at random, behind the sensor's noise."""
    random = np.random.default_rng(seed)
    moved = pushed_decay(random, load, 1.0, DAMPING, STIFFNESS, RATE, SAMPLES)
    return torch.as_tensor(moved + NOISE * random.normal(size=SAMPLES))


def fitted(load):
    records = tuple(FitRecord(f"run {i}", pushed(load, i), RATE) for i in range(2))
    evidence = Evidence("oscillator", records, (), Known({}, {}), None, one_record=False, noise=NOISE, sealed=True)
    free = (
        FreeParameter("stiffness", STIFFNESS, logarithmic=True),
        FreeParameter(COEFFICIENT, 1.2 * DAMPING, logarithmic=True),
    )
    return fit_hypothesis(Hypothesis(Oscillator(), (ViscousDamping(),), {"amplitude": 0.05}, free), evidence), evidence


def test_the_free_motion_goes_on_as_that_of_a_linear_oscillator():
    outcome, _ = fitted(0.0)
    stiffness, decrement = outcome.values["stiffness"], outcome.values[COEFFICIENT] / 2
    turn, decay = math.sqrt(stiffness - decrement**2) / RATE, math.exp(-decrement / RATE)
    for found in recurrences(outcome):
        assert len(found.first) == len(found.second) == SAMPLES - 2
        np.testing.assert_allclose(found.first, 2 * decay * math.cos(turn), rtol=1e-4)
        np.testing.assert_allclose(found.second, -(decay**2), rtol=1e-4)


@pytest.mark.parametrize(("load", "is_load"), [(0.0, False), (0.05, True)])
def test_a_random_load_is_told_from_a_sensor_that_is_noisy(load, is_load):
    seen = assessed(*(lambda outcome, evidence: (outcome, [], evidence))(*fitted(load)))
    assert bool(seen.random.loads) is is_load
    assert seen.visible.p > 0.01


class Bursts:
    """A thousandth of all kicks, thirty times as hard."""

    def __init__(self, seed):
        self.source = np.random.default_rng(seed)

    def normal(self, size):
        return 30 * self.source.normal(size=size) * (self.source.random(size) < 0.001)


def test_a_load_that_comes_in_bursts_is_no_random_one(monkeypatch):
    monkeypatch.setattr(f"{__name__}.pushed", in_bursts)
    seen = assessed(*(lambda outcome, evidence: (outcome, [], evidence))(*fitted(0.1)))
    assert not seen.random.loads
    monkeypatch.setattr("gear_damping.explanation.trials.random_part.BURST_KURTOSIS", math.inf)
    assert assessed(*(lambda outcome, evidence: (outcome, [], evidence))(*fitted(0.1))).random.loads


def in_bursts(load, seed):
    moved = pushed_decay(Bursts(seed), load, 1.0, DAMPING, STIFFNESS, RATE, SAMPLES)
    return torch.as_tensor(moved + NOISE * np.random.default_rng(seed).normal(size=SAMPLES))
