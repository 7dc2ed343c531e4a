"""How much a load straight between its samples moves a resonance less than a band-limited one, by scipy."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lsim

from gear_damping.explanation.answer import between_samples as module
from gear_damping.physics.systems.traits import Trait

FINE = 20  # steps of a sample


@pytest.mark.parametrize("frequency", [5.0, 12.0])
def test_it_is_that_of_a_resonance_under_a_straight_load(monkeypatch, frequency):
    rate, omega = 200.0, 2 * np.pi * frequency
    time = np.arange(int(3 * rate)) / rate
    fine = np.arange(0, time[-1], 1 / (FINE * rate))
    rig = ([[0, 1], [-(omega**2), -0.02 * omega]], [[0], [1]], [[1, 0]], [[0]])
    smooth, straight = (
        lsim(rig, load, fine)[1] for load in (np.sin(omega * fine), np.interp(fine, time, np.sin(omega * time)))
    )
    made = 100 * ((straight - smooth) ** 2).mean() / (smooth**2).mean()
    monkeypatch.setattr(module, "natural_frequency_hz", lambda model, given: frequency)
    assert module.between_samples(state([record(rate)])) == pytest.approx(made, rel=0.05)


def test_there_is_none_of_a_decay_nor_of_a_load_that_is_held_nor_of_a_mesh(monkeypatch):
    monkeypatch.setattr(module, "natural_frequency_hz", lambda model, given: 10.0)
    assert module.between_samples(state([record(200.0, inputs={})])) == 0
    assert module.between_samples(state([record(200.0, held=("force",))])) == 0
    assert module.between_samples(state([record(200.0)], trait=Trait.TEETH)) == 0
    slow, both = record(100.0), [record(200.0), record(100.0)]
    assert module.between_samples(state(both)) == module.between_samples(state([slow])) > 0


def record(rate, inputs=("force",), held=()):
    return SimpleNamespace(sampling_rate=rate, inputs=dict.fromkeys(inputs), held=held)


def state(fit, trait=Trait.REST):
    nominal = SimpleNamespace(hypothesis=SimpleNamespace(model=None), flat_given=dict)
    return SimpleNamespace(
        bench=SimpleNamespace(evidence=SimpleNamespace(fit=fit, has=lambda one: one is trait)), nominal=nominal
    )
