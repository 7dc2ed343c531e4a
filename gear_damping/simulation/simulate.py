"""Simulate a batch of runs of one model: the front door of this room."""

from collections.abc import Mapping
from dataclasses import replace

import torch
from torch import Tensor

from gear_damping.errors import InputError, Problem, nearest, with_article
from gear_damping.physics.equation import HELD_LOAD
from gear_damping.physics.model import Model, Prepared
from gear_damping.physics.terms import HeldLoad, Sensor
from gear_damping.simulation.driven import Driven
from gear_damping.simulation.integrate import integrate
from gear_damping.simulation.runs import (
    ACCELERATION,
    DIVERGED,
    FINE,
    Runs,
    effect_state_units,
    reference_velocity,
    state_units,
)
from gear_damping.simulation.sampling import check_sampling
from gear_damping.simulation.solver_settings import Solver
from gear_damping.units import parse_unit

FAR = 1e6  # natural lengths; a member that goes farther has diverged


def simulate(
    model: Model,
    values: Mapping[str, Tensor],
    *,
    sampling_rate: float,
    n_samples: int,
    inputs: Mapping[str, Tensor] | Driven | None = None,
    solver: Solver | None = None,
) -> Runs:
    """Simulate every member of a batch, each with its own parameters, inputs and start.

    Args:
        model: Base system and effects.
        values: Parameters in SI by flat name, (batch,) or (n, batch) (see `Model.values`).
        sampling_rate: Output samples per second.
        n_samples: Output samples of each run, the first at time 0.
        inputs: What drives it: measured series by name, or these with what else there is (`Driven`).
        solver: Settings; the defaults when None.

    Raises:
        InputError: an input is unknown to the system or has the wrong shape, or nothing can be sampled so.
    """
    check_sampling(sampling_rate, n_samples)
    driven = inputs if isinstance(inputs, Driven) else Driven(dict(inputs or {}))
    if _is_alone(model, values):
        _check_inputs(model, driven.series, (1, n_samples))  # of one member, as it was asked for
        twins, moved = (
            {name: value.repeat_interleave(2, -1) for name, value in one.items()}
            for one in (values, driven.initial_perturbations)
        )
        beside = replace(driven, initial_perturbations=moved)
        both = simulate(model, twins, sampling_rate=sampling_rate, n_samples=n_samples, inputs=beside, solver=solver)
        alone = both.keep(torch.tensor([True, False]))
        return replace(alone, n_diverged=int((alone.status == DIVERGED).sum()))
    prepared = model.prepare(values)
    batch = prepared.base["equivalent_mass"].shape[0]
    _check_inputs(model, driven.series, (batch, n_samples))
    _check_initial_perturbations(model, driven.initial_perturbations)
    true = true_inputs(model, values, driven.series, batch)
    scale = natural_units(model, prepared)
    natural = replace(
        driven,
        series=true | _held_loads(model, values, prepared, n_samples - 1, driven.seed),
        initial_perturbations={name: value / scale[name] for name, value in driven.initial_perturbations.items()},
    )
    interval = 1 / (sampling_rate * prepared.scales.time)
    names, states, rates = integrate(model, prepared, natural, interval, n_samples, solver or Solver())
    low, high = states.aminmax(dim=-1)  # nan, too, shows in the extremes
    fine = (low.isfinite() & high.isfinite()).all(0) & (low[0] > -FAR) & (high[0] < FAR)
    return Runs(
        model=model,
        values=dict(values),
        derived=prepared.derived,
        sampling_rate=sampling_rate,
        states=_in_si(names, states, scale) | _acceleration_in_si(prepared, rates),
        inputs={name: value.repeat(batch // len(value), 1) for name, value in true.items()},
        status=torch.where(fine, FINE, DIVERGED),
        reference_velocity=reference_velocity(prepared.derived),
        n_diverged=int((~fine).sum()),
        held=frozenset(driven.held),
    )


def _is_alone(model: Model, values: Mapping[str, Tensor]) -> bool:
    """Whether a batch has one member, whose last digits would differ from those in a larger one.

    PyTorch takes another cosine and another power for one number than for several; two members are as cheap as one.
    What is drawn depends on the size of a batch: such a model stays as it is.
    """
    drawn = any(isinstance(effect, HeldLoad) for effect in model.effects)
    return not drawn and all(value.shape[-1] == 1 and not value.requires_grad for value in values.values())


def _check_inputs(model: Model, inputs: Mapping[str, Tensor], shape: tuple[int, int]) -> None:
    known = model.system.inputs
    problems = [
        Problem(
            f"inputs.{name}",
            f"{with_article(model.system.name)} takes no such series",
            remedy=f"it takes {', '.join(known)}",
        )
        for name in inputs.keys() - known.keys()
    ]
    problems += [
        Problem(f"inputs.{name}", f"must have the shape (batch, time) = {shape}", tuple(value.shape))
        for name, value in inputs.items()
        if value.ndim != 2 or value.shape[1] != shape[1] or not len(value) or shape[0] % len(value)
    ]
    problems += [
        Problem(f"inputs.{name}", "holds values that are no finite numbers", remedy="fill or cut these samples")
        for name, value in inputs.items()
        if not bool(value.isfinite().all())
    ]
    if problems:
        raise InputError(problems)


def _check_initial_perturbations(model: Model, initial_perturbations: Mapping[str, Tensor]) -> None:
    known = list(effect_state_units(model))
    problems = [
        Problem(f"initial_perturbations.{name}", "no effect of the model has such a state", remedy=nearest(name, known))
        for name in initial_perturbations
        if name not in known
    ]
    if problems:
        raise InputError(problems)


def true_inputs(
    model: Model, values: Mapping[str, Tensor], inputs: Mapping[str, Tensor], batch: int
) -> dict[str, Tensor]:
    """The series that drive a simulation, from the recorded ones: errors of their sensors are undone."""
    found = dict(inputs)
    for effect in model.effects:
        if isinstance(effect, Sensor) and effect.channel in found:
            own = {p.name: values[f"{effect.name}.{p.name}"] for p in effect.parameters}
            recorded = found[effect.channel]
            found[effect.channel] = effect.undo(recorded.repeat(batch // len(recorded), 1), own)
    return found


def natural_units(model: Model, prepared: Prepared) -> dict[str, Tensor]:
    """Natural unit of every state by its name in `Runs.states`, (batch,)."""
    units = state_units(model)
    return {name: prepared.scales.unit_of(parse_unit(unit).dimension) for name, unit in units.items()}


def _held_loads(
    model: Model, values: Mapping[str, Tensor], prepared: Prepared, intervals: int, seed: int
) -> dict[str, Tensor]:
    generator = torch.Generator().manual_seed(seed)
    total: Tensor | None = None
    for effect in model.effects:
        if isinstance(effect, HeldLoad):
            own = {p.name: values[f"{effect.name}.{p.name}"] for p in effect.parameters}
            drawn = effect.draw(own, prepared.derived["mean_load"], intervals, generator)
            total = drawn if total is None else total + drawn
    return {} if total is None else {HELD_LOAD: total / prepared.scales.force.unsqueeze(1)}


def _in_si(names: list[str], states: Tensor, scale: Mapping[str, Tensor]) -> dict[str, Tensor]:
    # in place: fresh memory for every state costs more than the product
    return {name: state.mul_(scale[name].unsqueeze(1)) for name, state in zip(names, states, strict=True)}


def _acceleration_in_si(prepared: Prepared, rates: Tensor | None) -> dict[str, Tensor]:
    unit = (prepared.scales.velocity / prepared.scales.time).unsqueeze(1)
    return {} if rates is None else {ACCELERATION: rates.mul_(unit)}
