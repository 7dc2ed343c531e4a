"""What a simulation in Python is given beside its model, checked at the door: series, and values in a call."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import fields, replace
from typing import Any

import torch
from numpy.typing import ArrayLike

from gear_damping.config.decided import unseen_sensors
from gear_damping.errors import InputError, Problem, with_article
from gear_damping.interface.arguments import SEED, names, numbers
from gear_damping.interface.model import refuse_decided, refuse_unsaid
from gear_damping.physics.model import Model
from gear_damping.schema.values import Problems
from gear_damping.simulation.driven import Driven
from gear_damping.simulation.prior import DAMPING_RATIO
from gear_damping.simulation.sampling import whole_number_problems
from gear_damping.simulation.solver_settings import Solver

ANGLE = "pinion_angle"  # the series that says how the shafts turn
TURNED = ("pinion_speed", "pinion_acceleration", "pinion_jerk", ANGLE)  # values that say it where there is none
RATIOS = ("damping_ratio", DAMPING_RATIO)


def driven_by(inputs: Any) -> Driven:
    """What drives the runs, its series as tensors (batch, time).

    Raises:
        InputError: series without their names, what holds none of them, or a seed that is none.
    """
    if inputs is None or isinstance(inputs, Mapping):
        inputs = Driven(inputs or {})
    series = inputs.series if isinstance(inputs, Driven) else None
    if not isinstance(series, Mapping):
        given = inputs if series is None else series
        rule = f"must say which series is which, and is {with_article(type(given).__name__)}"
        raise InputError(Problem("inputs", rule, remedy="write {'force': ARRAY}"))
    problems, held = (
        Problems(whole_number_problems("inputs.seed", inputs.seed, SEED)),
        names("inputs.held", inputs.held),
    )
    there = f"name some of {', '.join(series)}" if series else "leave it out"
    problems += [Problem("inputs.held", "there is no such series", one, there) for one in held if one not in series]
    problems.raise_any()
    return replace(inputs, series={name: _rows(name, value) for name, value in series.items()}, held=held)


def _rows(name: str, series: ArrayLike) -> torch.Tensor:
    return torch.atleast_2d(numbers(f"inputs.{name}", series))


def refuse_idle(model: Model, given: Mapping[str, Any], series: Collection[str]) -> None:
    """Refuse what a call gives without effect, what belongs to another argument, and a torque that nobody says.

    Args:
        model: What is simulated.
        given: Values in the place of the model's, by flat name.
        series: Names of the series that drive it.

    Raises:
        InputError: with all of it.
    """
    problems = Problems(_of_another_argument(model, given))
    problems += [Problem(name, rule, remedy=remedy) for name, rule, remedy in unseen_sensors(model)]
    with problems.collecting():
        refuse_decided(model, given, series)
    with problems.collecting():
        refuse_unsaid(model, {*model.given, *given, *series})
    problems += _of_series(model, given, series)
    problems.raise_any()


def _of_series(model: Model, given: Mapping[str, Any], series: Collection[str]) -> Iterator[Problem]:
    """Values whose place a series takes, and scales of one that is not there."""
    for name in TURNED if ANGLE in series else ():
        if name in given:
            rule = f"has no effect beside the series inputs['{ANGLE}'], which says how the pinion turns"
            yield Problem(name, rule, given[name], "leave one of them out")
    for channel, gain in model.system.gains.items():
        if gain in given and channel not in series and channel not in model.parameters():
            rule = f"has no effect without a series of {channel}, which it scales"
            yield Problem(gain, rule, given[gain], f"leave it out, or add inputs={{'{channel}': ARRAY}}")


def _of_another_argument(model: Model, given: Mapping[str, Any]) -> Iterator[Problem]:
    """Names that no model has and that are said elsewhere."""
    of_inputs, of_solver = ({one.name for one in fields(kind)} for kind in (Driven, Solver))
    for name in given.keys() - model.parameters().keys():
        rule, remedy = "no such parameter of the model", ""
        if name in RATIOS:
            rule = "no such parameter: a ratio is what the coefficient of a damping law comes to"
            own = model.damping_coefficient
            remedy = f"give the coefficient, **{{'{own or 'viscous_damping.damping_coefficient'}': VALUE}}"
        elif name in of_inputs:
            remedy = f"it stands in inputs=gd.Driven(…, {name}=…)"
        elif name in of_solver:
            remedy = f"it stands in solver=gd.Solver({name}=…)"
        elif name in model.system.inputs:
            remedy = f"a series stands in inputs={{'{name}': ARRAY}}"
        if remedy:
            yield Problem(name, rule, remedy=remedy)
