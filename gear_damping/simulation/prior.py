"""The prior of runs: what varies from run to run, and where the runs start."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import torch
from torch import Tensor

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.physics.equation import EquationOfMotion
from gear_damping.physics.model import Model, Prepared
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import ExtraStates
from gear_damping.simulation.runs import reference_velocity

Values = dict[str, Tensor]
DAMPING_RATIO = "damping_ratio_percent"


@dataclass(frozen=True)
class Uniform:
    """A uniform distribution; `relative` ones multiply the nominal value."""

    low: float
    high: float
    relative: bool = False

    def draw(self, nominal: Tensor, generator: torch.Generator) -> Tensor:
        """One value for each run, in the shape of `nominal`."""
        share = torch.rand(nominal.shape[-1], generator=generator, dtype=torch.float64)
        found = self.low + (self.high - self.low) * share
        return nominal * found if self.relative else found.expand(nominal.shape)


@dataclass(frozen=True)
class Prior:
    """What varies between runs.

    Args:
        name: Its name.
        distributions: Distribution of each varying parameter by flat name (SI), and of `damping_ratio_percent`.
        start: `static`: near the static equilibrium; `rest`: at zero, a step of the whole load.
        perturbation: Standard deviation of a `static` start, relative to the static deflection and
            to the reference velocity.
    """

    name: str
    distributions: Mapping[str, Uniform] = field(default_factory=dict)
    start: Literal["static", "rest"] = "static"
    perturbation: float = 0.1


@dataclass(frozen=True)
class Label:
    """What networks learn: the equivalent damping ratio.

    Args:
        damping_law: The damping effect that carries it; None: as given.
        damping_ratio_percent: Of every run in %; None: drawn from the prior.
    """

    damping_law: str | None = None
    damping_ratio_percent: float | None = None


def draw_values(
    model: Model,
    given: Mapping[str, float],
    prior: Prior,
    n_runs: int,
    generator: torch.Generator,
    label: Label = Label(),
) -> tuple[Values, Tensor]:
    """Parameters of every run (SI, by flat name) and the nominal reference velocity (m/s, (batch,)).

    Args:
        model: Base system and effects.
        given: Nominal values that differ from the defaults, SI by flat name.
        prior: What varies.
        n_runs: How many runs.
        generator: Source of randomness.
        label: Which law carries which damping ratio.

    Raises:
        InputError: a distribution or the damping law names something that the model does not have, or no
            coefficient of the law has a damping ratio.
    """
    values = model.values(n_runs, **given)
    _check(model, prior, label.damping_law, values)
    velocity = reference_velocity(model.prepare(values).derived)
    for name in sorted(prior.distributions):
        if name != DAMPING_RATIO:
            values[name] = prior.distributions[name].draw(values[name], generator).clone()
    drawn = prior.distributions.get(DAMPING_RATIO, Uniform(0, 0)).draw(velocity, generator)
    if label.damping_ratio_percent is not None:
        drawn = torch.full_like(velocity, label.damping_ratio_percent)
    is_known = DAMPING_RATIO in prior.distributions or label.damping_ratio_percent is not None
    if label.damping_law is not None and is_known:
        values |= coefficients_for(model, values, label.damping_law, drawn / 100, velocity)
    if prior.start == "static":
        _start_static(model, given, values, prior.perturbation, velocity, generator)
    return values, velocity


def _check(model: Model, prior: Prior, damping_law: str | None, values: Values) -> None:
    problems = [
        Problem(f"family.spreads.{name}", "the model has no such parameter", remedy=nearest(name, list(values)))
        for name in prior.distributions
        if name != DAMPING_RATIO and name not in values
    ]
    laws = [effect.name for effect in model.damping_laws]
    if damping_law is not None and damping_law not in laws:
        rule = "must be a damping effect that is switched on"
        remedy = f"on are: {', '.join(laws)}" if laws else "switch one on, for example simulator.viscous_damping={}"
        problems.append(Problem("simulator.damping_law", rule, damping_law, remedy))
    if problems:
        raise InputError(problems)


def coefficients_for(model: Model, values: Values, law: str, ratio: Tensor, velocity: Tensor) -> Values:
    """The parameters of a damping law, by flat name, that have an equivalent damping ratio.

    Args:
        model: Base system and effects.
        values: Parameters of every run, SI by flat name.
        law: The damping effect.
        ratio: Damping ratio of each run, (batch,).
        velocity: The velocity amplitude that it is stated at, m/s, (batch,).

    Raises:
        InputError: no coefficient has the ratio: there is no linear stiffness, or the amplitude is 0.
    """
    effect = next(effect for effect in model.effects if effect.name == law)
    derived = model.prepare(values).derived
    own = {p.name: values[f"{law}.{p.name}"] for p in effect.parameters}
    mass, stiffness = derived["equivalent_mass"], derived["mean_stiffness"]
    found = effect.coefficient_for(ratio, own, mass, stiffness, velocity)
    reached = effect.damping_ratio({**own, **found}, mass, stiffness, velocity)
    if not bool((reached.isfinite() & ((reached > 0) | (ratio == 0))).all()):
        raise InputError(_without_ratio(model, law, bool((stiffness > 0).all())))
    return {f"{law}.{name}": value for name, value in found.items()}


def _without_ratio(model: Model, law: str, stiff: bool) -> Problem:
    """Why a damping law cannot carry a damping ratio."""
    load = "pinion_torque" if model.system.has(Trait.TORQUE) else "amplitude"
    cause = load if stiff else model.system.spring or "stiffness"
    rule = f"carries no damping ratio: simulator.{cause} is 0 and the ratio is stated at "
    rule += "the velocity amplitude that follows from it" if stiff else "the frequency that follows from it"
    own = f"set the parameters of {law} themselves: simulator.damping_law=null family.spreads.{DAMPING_RATIO}=null"
    return Problem("simulator.damping_law", rule, law, f"give simulator.{cause}, or {own}")


def _start_static(
    model: Model,
    given: Mapping[str, float],
    values: Values,
    perturbation: float,
    velocity: Tensor,
    generator: torch.Generator,
) -> None:
    """Start where the mean load holds the flanks, plus what they impose, plus a random share."""
    prepared = model.prepare(values)
    static = prepared.derived["mean_load"] / prepared.derived["mean_stiffness"]
    error, error_rate = _imposed(model, prepared)
    shares = perturbation * torch.randn(2, len(static), generator=generator, dtype=torch.float64)
    starts = {
        "initial_displacement": static * (1 + shares[0]) + error * prepared.scales.length,
        "initial_velocity": velocity * shares[1] + error_rate * prepared.scales.velocity,
    }
    values |= {name: value for name, value in starts.items() if name not in given}


def _imposed(model: Model, prepared: Prepared) -> tuple[Tensor, Tensor]:
    """What the flanks and the states of effects impose at the start, and its rate, natural units."""
    zero = torch.zeros_like(prepared.base["equivalent_mass"])
    equation = EquationOfMotion(model)
    at = equation.kinematics(zero, (zero, zero, *extra_states(model, prepared).values()), {}, prepared.base)
    return equation.imposed_error(at, prepared.terms)


def extra_states(model: Model, prepared: Prepared) -> dict[str, Tensor]:
    """The states of effects at the start in natural units, by flat name in the order of the equation."""
    with_states = [effect for effect in model.effects if isinstance(effect, ExtraStates)]
    found = {e.name: e.initial(prepared.terms[e.name], prepared.base) for e in with_states}
    return {f"{e.name}.{state}": found[e.name][state] for e in with_states for state in e.states}
