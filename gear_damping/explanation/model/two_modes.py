"""What makes two modes of one: the modes themselves, and a free motion written so that its numbers are told."""

from collections.abc import Mapping
from math import pi

import numpy as np
from numpy.typing import NDArray

from gear_damping.explanation.model.hypothesis import Given, Outcome, placed
from gear_damping.identification.oscillator.linear_model import DAMPING
from gear_damping.physics.cause import Cause
from gear_damping.physics.model import Model
from gear_damping.physics.terms import ExtraStates

OF_TWO = 4  # figures of two modes that both swing: a frequency and a damping ratio of each
First = tuple[dict[str, float], float, float, float]  # own values; stiffness and damping per unit of mass, and the mass


def figures(outcome: Outcome, name: str, values: Mapping[str, float]) -> NDArray[np.float64]:
    """Frequency in Hz and damping ratio in % of one mode after the other, (4,); fewer where one does not swing.

    Args:
        outcome: A model with the effect.
        name: The effect.
        values: Of its free parameters, by name.
    """
    model = outcome.hypothesis.model
    own, stiffness, damping, _ = _first(model, name, placed(outcome.hypothesis.given, dict(values)))
    poles = _cause(model, name).modes(own, stiffness, damping)
    return np.array([part for pole in poles for part in (abs(pole) / (2 * pi), -100 * pole.real / abs(pole))])


def settled(outcome: Outcome, name: str) -> dict[str, float]:
    """Values by flat name that make the same free motion, the effect's own put where each of them is told."""
    model, given = outcome.hypothesis.model, outcome.flat_given()
    found, stiffness, damping, mass = _first(model, name, given)
    own, changed, damped = _cause(model, name).settles(found, stiffness, damping)
    first = {model.system.spring: mass * changed, DAMPING: mass * damped}
    return {f"{name}.{key}": value for key, value in own.items()} | first


def decay_time(outcome: Outcome, effect: ExtraStates) -> float:
    """Of what an effect swings by itself, in s; of a free swing that of the mode that dies away last.

    There two masses share their dampings as their coupling goes, and only those of the modes are told.
    """
    alone = effect.decay_time(outcome.values_of(effect.name))
    if effect.cause.modes is None or outcome.problem.records[0].inputs:
        return alone
    found = figures(outcome, effect.name, outcome.values)
    rates = found[::2] * found[1::2].clip(min=0) * (2 * pi / 100)
    return alone if len(found) < OF_TWO else 1 / max(float(rates.min()), 1e-300)


def _cause(model: Model, name: str) -> Cause:
    return next(effect for effect in model.effects if effect.name == name).cause


def _first(model: Model, name: str, given: Given) -> First:
    prepared = model.prepare(model.values(1, **given))
    mass = float(prepared.derived["equivalent_mass"][0])
    own = {key.removeprefix(f"{name}."): float(v) for key, v in given.items() if key.startswith(f"{name}.")}
    return own, float(prepared.derived["mean_stiffness"][0]) / mass, float(given[DAMPING]) / mass, mass
