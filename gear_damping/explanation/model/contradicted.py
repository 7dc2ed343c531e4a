"""What the file states with an uncertainty and the records put far from it."""

import re
from collections.abc import Mapping, Sequence

import torch

from gear_damping.explanation.evidence.noise import DECLARED, NoiseLevel
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.linear import linear_of
from gear_damping.explanation.model.nominal_gear_pair import FLAT, MESH, SHAPE
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FreeParameter
from gear_damping.measurement.foretold import WAVE, mean_stiffness
from gear_damping.measurement.record import Channel
from gear_damping.physics.cause import SHAFTS

CONTRADICTS = 5.0  # stated standard deviations: of one in two million statements that hold
ABOVE = 3.0  # times what a model leaves, noise and all: a noise that is stated so large is another's


def contradicts_stated(outcome: Outcome, evidence: Evidence) -> str:
    """A sentence of what a model had to move far from what is stated, empty where it is all within its uncertainty.

    Beside a free shape of the mesh stiffness the corners of its ideal wave are nobody's figures: what ramps over a
    third of a period, as wide helical teeth do, has the highest of them far above anything. The mean counts then.
    """
    fitted = {FLAT.get(name, name): name for name in evidence.known.uncertainty}
    if any(parameter.name.startswith(SHAPE) for parameter in outcome.problem.free) and _has_stated_mean(
        linear_of(outcome)[2], evidence.known
    ):
        fitted = {name: key for name, key in fitted.items() if not name.startswith(MESH)}
    return contradicted(outcome.problem.free, outcome.fitted.shared.tolist(), fitted) or ""


def _has_stated_mean(stiffness: float, known: Known) -> bool:
    """Whether a mean mesh stiffness in N/m is the stated one, within what is said of the larger and the smaller one."""
    stated = mean_stiffness(known.values)
    if stated is None:
        return False
    uncertainty = max(known.uncertainty.get(name, 0.0) for name in WAVE)
    return abs(stiffness / stated - 1) <= CONTRADICTS * uncertainty


def contradicted(free: Sequence[FreeParameter], coordinates: Sequence[float], stated: Mapping[str, str]) -> str | None:
    """A sentence of what is stated with an uncertainty that the records contradict; None where nothing is.

    Args:
        free: What was fitted.
        coordinates: What it came to.
        stated: Key of the file by flat name.
    """
    away = {}
    for parameter, coordinate in zip(free, coordinates, strict=True):
        if parameter.name in stated and _surprise(parameter, coordinate) > CONTRADICTS:
            away[stated[parameter.name]] = (parameter, coordinate)
    if not away:
        return None
    said = " and ".join(
        f"{name} lies {_surprise(*one):.3g} of its stated uncertainties away" for name, one in away.items()
    )
    if len(away) == len(SHAFTS) and _are_exchanged(away):
        return f"{said}: each is what is stated of the other, so exchange the two"
    return f"{said}: correct its value or its uncertainty, which draws the other figures to it"


def _surprise(parameter: FreeParameter, coordinate: float) -> float:
    """How far a parameter lies from what is stated of it, in standard deviations."""
    expected, slope = parameter.surprise
    return abs(expected + slope * coordinate)


def _are_exchanged(away: Mapping[str, tuple[FreeParameter, float]]) -> bool:
    """Whether two figures are of one kind, one of either shaft, and each is as the other one is stated."""
    if len({re.sub("|".join(SHAFTS), "", name) for name in away}) > 1:
        return False
    values = [float(parameter.value(torch.tensor(at, dtype=torch.float64))) for parameter, at in away.values()]
    others = [parameter for parameter, _ in away.values()][::-1]
    return all(
        _surprise(other, other.coordinate(value)) <= CONTRADICTS for other, value in zip(others, values, strict=True)
    )


def noise_above(stated: NoiseLevel, left: float, channel: Channel) -> str | None:
    """A sentence where a noise that the file states is far more than a model leaves; None where it is not.

    Args:
        stated: The noise as it was known beforehand.
        left: Root mean square of what is left of the fitted records, in the unit that they are kept in.
        channel: The first channel of the response, with its declared unit.
    """
    if stated.method != DECLARED or stated.value <= ABOVE * left:
        return None
    unit, factor = channel.declared_unit, channel.declared_factor
    return (
        f"noise is stated as {stated.value / factor:.3g} {unit}, and the simulation follows the records within "
        f"{left / factor:.3g} {unit}, noise and all: correct it, for beside so much of it nothing that is missing shows"
    )
