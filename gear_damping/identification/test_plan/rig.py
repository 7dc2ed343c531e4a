"""The rig that tests are planned for: its model with values, and the damping that one wants to know."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import torch
from torch import Tensor

from gear_damping.errors import InputError, Problem
from gear_damping.physics.model import Model
from gear_damping.physics.terms import DampingLaw
from gear_damping.simulation.runs import reference_velocity
from gear_damping.simulation.solver_settings import Solver


@dataclass(frozen=True)
class Rig:
    """A model with its values, and how it is simulated.

    Args:
        model: Base system and effects.
        given: Values that differ from the model's own, SI by flat name.
        law: The damping law whose ratio one wants to know; the one that there is where None.
        solver: Settings of the solver.
    """

    model: Model
    given: Mapping[str, float | tuple[float, ...]]
    law: str | None = None
    solver: Solver = field(default_factory=Solver)

    @cached_property
    def values(self) -> dict[str, Tensor]:
        """Every parameter, (1,) or (n, 1), SI by flat name."""
        return self.model.values(1, **self.given)

    @cached_property
    def damping(self) -> DampingLaw:
        """The law.

        Raises:
            InputError: there is none, or not one.
        """
        laws = {law.name: law for law in self.model.damping_laws}
        if self.law in laws:
            return laws[self.law]
        key, on = "simulator.damping_law", ", ".join(laws) or "none"
        if self.law is not None:
            raise InputError(Problem(key, "is no damping law of the model", self.law, f"on are: {on}"))
        if len(laws) != 1:
            rule = f"a plan is one for one damping law, and the model has {len(laws)}"
            raise InputError(Problem(key, rule, None, f"name the law that it is for; on are: {on}"))
        return next(iter(laws.values()))

    @property
    def coefficient(self) -> str:
        """Flat name of the coefficient of the law."""
        return f"{self.damping.name}.{self.damping.parameters[0].name}"

    @property
    def exponent(self) -> str | None:
        """Flat name of its exponent, where it has one."""
        name = f"{self.damping.name}.exponent"
        return name if name in self.values else None

    @cached_property
    def velocity(self) -> Tensor:
        """The velocity amplitude that the damping ratio is stated at, m/s, (1,): that of the configured rig."""
        return reference_velocity(self.model.prepare(self.values).derived)

    def ratio_percent(self, values: Mapping[str, Tensor]) -> Tensor:
        """Equivalent damping ratio of the law at `velocity`, % of critical, (batch,)."""
        derived = self.model.prepare(values).derived
        own = {p.name: values[f"{self.damping.name}.{p.name}"] for p in self.damping.parameters}
        velocity = self.velocity.expand_as(derived["equivalent_mass"])
        return 100 * self.damping.damping_ratio(own, derived["equivalent_mass"], derived["mean_stiffness"], velocity)

    def members(self, count: int, **changed: Tensor) -> dict[str, Tensor]:
        """Values of several members, with some of them changed, (count,) or (n, count)."""
        return {name: value.expand(*value.shape[:-1], count).clone() for name, value in self.values.items()} | changed


def settings_of(speeds: tuple[float, ...], torques: tuple[float, ...], amplitudes: tuple[float, ...]) -> list[dict]:
    """Every combination, as values by the name of the parameter; those that are not varied are left out."""
    axes = {"pinion_speed": speeds, "pinion_torque": torques, "initial_displacement": amplitudes}
    found: list[dict[str, float]] = [{}]
    for name, values in axes.items():
        if values:
            found = [{**one, name: value} for one in found for value in values]
    return found


def members_at(rig: Rig, settings: list[dict]) -> dict[str, Tensor]:
    """Values of one member for each setting."""
    names = settings[0]
    changed = {name: torch.tensor([one[name] for one in settings], dtype=torch.float64) for name in names}
    return rig.members(len(settings), **changed)
