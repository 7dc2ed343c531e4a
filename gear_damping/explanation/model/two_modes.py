"""What makes two modes of one: the modes themselves, and a free motion written so that its numbers are told."""

from collections.abc import Mapping
from math import pi

import numpy as np
from numpy.typing import NDArray

from gear_damping.explanation.model.hypothesis import Given, Outcome, placed
from gear_damping.identification.oscillator.linear_model import DAMPING
from gear_damping.physics.cause import Cause
from gear_damping.physics.model import Model

First = tuple[dict[str, float], float, float]  # own values; stiffness and damping of the first mass, per unit of mass


def figures(outcome: Outcome, name: str, values: Mapping[str, float]) -> NDArray[np.float64]:
    """Frequency in Hz and damping ratio in % of one mode after the other, (4,); fewer where one does not swing.

    Args:
        outcome: A model with the effect.
        name: The effect.
        values: Of its free parameters, by name.
    """
    model = outcome.hypothesis.model
    own, stiffness, damping = _first(model, name, placed(outcome.hypothesis.given, dict(values)))
    poles = _cause(model, name).modes(own, stiffness, damping)
    return np.array([part for pole in poles for part in (abs(pole) / (2 * pi), -100 * pole.real / abs(pole))])


def settled(outcome: Outcome, name: str) -> dict[str, float]:
    """Values by flat name that make the same free motion, the effect's own put where each of them is told."""
    model, given = outcome.hypothesis.model, outcome.flat_given()
    found, stiffness, damping = _first(model, name, given)
    own, changed, damped = _cause(model, name).settles(found, stiffness, damping)
    spring, mass = model.system.spring, float(given[DAMPING]) / damping if damping else 1.0
    return {f"{name}.{key}": value for key, value in own.items()} | {spring: mass * changed, DAMPING: mass * damped}


def _cause(model: Model, name: str) -> Cause:
    return next(effect for effect in model.effects if effect.name == name).cause


def _first(model: Model, name: str, given: Given) -> First:
    prepared = model.prepare(model.values(1, **given))
    mass = float(prepared.derived["equivalent_mass"][0])
    own = {key.removeprefix(f"{name}."): float(v) for key, v in given.items() if key.startswith(f"{name}.")}
    return own, float(prepared.derived["mean_stiffness"][0]) / mass, float(given[DAMPING]) / mass
