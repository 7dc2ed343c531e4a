"""What is said of two modes: their closed form, with deviations that follow from those of the fitted values."""

import math
import re
from types import SimpleNamespace

import numpy as np
import pytest
import torch

from gear_damping.explanation.answer import modes
from gear_damping.explanation.model.two_modes import decay_time
from gear_damping.identification.output_error.records import FreeParameter
from gear_damping.physics.effects.second_mode import SecondMode
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator

DAMPING = "viscous_damping.damping_coefficient"
GIVEN = {"second_mode.mass_ratio": 1e-9, "second_mode.frequency": 3.0, "second_mode.damping_ratio": 0.01}
NAMES = ("stiffness", DAMPING, "second_mode.frequency")


def fitted(stiffness=(2 * math.pi * 2.0) ** 2, damping=0.5, inputs=()):
    """Two masses that hardly act on each other: 2 Hz and 3 Hz."""
    model = Model(Oscillator(), [ViscousDamping(), SecondMode()])
    values = {"stiffness": stiffness, DAMPING: damping, "second_mode.frequency": 3.0}
    free = [FreeParameter(name, values[name], logarithmic=True) for name in NAMES]
    unknowns = SimpleNamespace(parameters=lambda x: {p.name: p.value(x[i]) for i, p in enumerate(free)})
    given = dict.fromkeys(model.parameters(), 0.0) | GIVEN | values | {"force_gain": 1.0}
    return SimpleNamespace(
        hypothesis=SimpleNamespace(model=model, given=given),
        problem=SimpleNamespace(unknowns=unknowns, free=free, records=[SimpleNamespace(inputs=inputs)]),
        fitted=SimpleNamespace(shared=torch.zeros(3, dtype=torch.float64)),
        values=values,
        flat_given=lambda: given,
        values_of=lambda name: {k.partition(".")[2]: v for k, v in given.items() if k.startswith(name + ".")},
    )


def said(outcome, deviations, monkeypatch):
    covariance = torch.diag(torch.tensor(deviations, dtype=torch.float64) ** 2)
    monkeypatch.setattr(modes, "covariance_of", lambda *_: covariance)
    cause = SimpleNamespace(name="second_mode", effect=SecondMode())
    bench = SimpleNamespace(evidence=None)
    return modes.modes_of(SimpleNamespace(outcome=outcome, accepted=[cause], bench=bench))


def test_both_modes_have_a_frequency_and_a_damping_with_intervals(monkeypatch):
    (text,) = said(fitted(), (0.02, 0.1, 0.003), monkeypatch)
    found = np.array([float(one) for one in re.findall(r"\d+\.?\d*", text)]).reshape(4, 3)
    ratio = 100 * 0.5 / (2 * 2 * math.pi * 2.0)
    assert found[:, 0] == pytest.approx([2.0, ratio, 3.0, 1.0], rel=1e-3)
    assert (found[0, 2] - found[0, 1]) / 2 == pytest.approx(1.96 * 2.0 * 0.02 / 2, rel=0.02)
    assert (found[1, 2] - found[1, 1]) / 2 == pytest.approx(1.96 * ratio * math.hypot(0.1, 0.02 / 2), rel=0.02)
    assert (found[2, 2] - found[2, 1]) / 2 == pytest.approx(1.96 * 3.0 * 0.003, rel=0.02)


@pytest.mark.parametrize("deviations", [(1e9, 1e9, 0.003), (math.inf, 0.1, 0.003), (math.nan, 0.1, 0.003)])
def test_a_figure_of_which_nothing_is_known_ends_in_no_error(deviations, monkeypatch):
    assert len(said(fitted(), deviations, monkeypatch)) == (deviations[0] == 1e9)


def test_nothing_is_said_of_a_mode_that_does_not_swing(monkeypatch):
    assert said(fitted(damping=60.0), (0.02, 0.1, 0.003), monkeypatch) == []
    barely = fitted(damping=2 * 2 * math.pi * 2.0 * (1 - 1e-5))  # and a little more does not
    assert said(barely, (0.02, 0.1, 0.003), monkeypatch) == []


def test_what_swings_freely_dies_away_as_the_slower_of_its_modes():
    slow = fitted(damping=0.02)
    assert decay_time(slow, SecondMode()) == pytest.approx(2 / 0.02, rel=1e-3)
    driven = fitted(damping=0.02, inputs=("force",))
    assert decay_time(driven, SecondMode()) == pytest.approx(1 / (2 * math.pi * 3.0 * 0.01), rel=1e-3)
