"""What a simulation gives back."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import torch
from torch import Tensor

from gear_damping.physics.model import Model
from gear_damping.physics.ratio_by_law import ratio_by_law, stated_ratio
from gear_damping.physics.terms import ExtraStates, Recording, Sensor
from gear_damping.simulation.series import ANGLE, ANGLE_RATE

FINE, DIVERGED = 0, 1  # what became of a run
ACCELERATION = "acceleration"  # its name among the states


@dataclass(frozen=True)
class Runs:
    """Simulated runs of one model, SI, float64.

    Args:
        model: The model they came from.
        values: Its parameters by flat name, (batch,) or (n, batch).
        derived: Derived quantities of the system, each (batch,).
        sampling_rate: Output samples per second.
        states: `displacement`, `velocity` and the states of effects by flat name, (batch, time); with them
            `acceleration` where it was asked for.
        inputs: Series that were given to the simulation, (batch, time).
        status: 0 for a fine run, 1 for one that diverged, (batch,).
        reference_velocity: Velocity amplitude that equivalent damping ratios belong to, m/s, (batch,).
        n_diverged: How many runs diverged, kept here or already left out.
        held: Names of the inputs that stay at a sample's value until the next one.
    """

    model: Model
    values: dict[str, Tensor]
    derived: dict[str, Tensor]
    sampling_rate: float
    states: dict[str, Tensor]
    inputs: dict[str, Tensor]
    status: Tensor
    reference_velocity: Tensor
    n_diverged: int = field(default=0)
    held: frozenset[str] = frozenset()

    @property
    def good(self) -> Tensor:
        """True for runs that did not diverge, (batch,)."""
        return self.status == FINE

    @property
    def time(self) -> Tensor:
        """Time of the samples in s, (time,)."""
        count = self.states["displacement"].shape[-1]
        return torch.arange(count, dtype=torch.float64) / self.sampling_rate

    @property
    def response(self) -> Tensor:
        """The system's response before any sensor, (batch, time)."""
        return self.states["displacement"]

    @cached_property
    def damping_ratio_by_law(self) -> dict[str, Tensor]:
        """What each damping law adds to `damping_ratio_percent`, in %, (batch,), by its name."""
        stiffness, prepared = self.derived["mean_stiffness"], self.model.prepare(self.values)
        return self._percent(ratio_by_law(self.model, self.values, prepared, stiffness, self.reference_velocity))

    @property
    def laws_without_ratio(self) -> list[str]:
        """The damping laws of which some run has no ratio: no stiffness, or too many steps of a cycle."""
        return [name for name, ratio in self.damping_ratio_by_law.items() if not bool(ratio.isfinite().all())]

    @property
    def damping_ratio_percent(self) -> Tensor:
        """Equivalent damping ratio of every damping law together at the reference velocity, in %, (batch,).

        Dry friction, hysteresis and what grows with the deflection count with what a harmonic motion of that velocity
        loses to them, as in `identify`. It is nan where the model has no damping law, where there is no linear
        stiffness, and where a law has no such ratio.
        """
        return self._summed(self.damping_ratio_by_law)

    @property
    def stated_ratio_percent(self) -> Tensor:
        """Equivalent damping ratio of the laws that can be given by one (`Model.damping_laws`), in %, (batch,).

        It is what networks learn and what `damping_ratio` means where it is free: the share of the coefficient. It is
        nan where no effect of the model states one, and where there is no linear stiffness.
        """
        of_the_rig = self.derived["equivalent_mass"], self.derived["mean_stiffness"], self.reference_velocity
        ratios = {law.name: stated_ratio(law, self.values, *of_the_rig) for law in self.model.damping_laws}
        return self._summed(self._percent(ratios))

    def _percent(self, ratios: Mapping[str, Tensor]) -> dict[str, Tensor]:
        """In %; nan where there is no stiffness, of which a damping could be critical."""
        stiffness = self.derived["mean_stiffness"]
        return {name: torch.where(stiffness > 0, 100 * ratio, torch.nan) for name, ratio in ratios.items()}

    def _summed(self, by_law: Mapping[str, Tensor]) -> Tensor:
        """All of them together, (batch,); nan of none."""
        empty = torch.full_like(self.derived["mean_stiffness"], 0.0 if by_law else torch.nan)
        return sum(by_law.values(), empty)

    def channel(self, name: str) -> Tensor:
        """A series by name, (batch, time); the response also by the name that files give it."""
        if name == self.model.system.response:
            return self.response
        found = self.states | self.inputs
        if name in found:
            return found[name]
        angles = self.angles
        if name not in angles:
            raise KeyError(f"no channel '{name}'; there are {', '.join(sorted(found | angles))}")
        return angles[name]

    @cached_property
    def angles(self) -> dict[str, Tensor]:
        """`pinion_angle`, `gear_angle` and `mesh_angle` in rad, (batch, time); none without a shaft."""
        prepared = self.model.prepare(self.values)
        base = {name: value.unsqueeze(1) for name, value in prepared.base.items()}
        time = self.time / prepared.scales.time.unsqueeze(1)
        displacement = self.states["displacement"] / prepared.scales.length.unsqueeze(1)
        given = self.inputs.get(ANGLE)
        turning = {} if given is None else {ANGLE: given, ANGLE_RATE: given * 0}
        turns = self.model.system.rotations(time, turning, base, displacement)
        return {f"{name}_angle": turn.angle.expand(time.shape) for name, turn in turns.items()}

    def record(self, generator: torch.Generator, skip: tuple[str, ...] = ()) -> Tensor:
        """The response as the model's sensors record it, (batch, time).

        Args:
            generator: Source of the sensors' noise.
            skip: Names of sensors to leave out.
        """
        return self.measured(self.model.system.response, generator, skip)

    def measured(self, channel: str, generator: torch.Generator, skip: tuple[str, ...] = ()) -> Tensor:
        """Any channel behind the sensors that act on it, (batch, time)."""
        return self._through(self._sensors((channel,), skip), self.channel(channel), generator)

    def behind_sensors(
        self,
        signal: Tensor,
        generator: torch.Generator,
        skip: tuple[str, ...] = (),
        begins: Tensor | None = None,
        seen: Collection[str] = (),
    ) -> Tensor:
        """A response, whatever quantity it is, behind the sensors that act on it, (batch, time).

        Args:
            signal: The response, (batch, time).
            generator: Source of the sensors' noise.
            skip: Names of sensors to leave out.
            begins: Time in s from the start of the record to the first sample, (batch,).
            seen: Channels whose sensors act on it; those of the response where none is named.
        """
        sensors = self._sensors(seen or (self.model.system.response,), skip)
        return self._through(sensors, signal, generator, begins)

    def _through(
        self, sensors: list[Sensor], signal: Tensor, generator: torch.Generator, begins: Tensor | None = None
    ) -> Tensor:
        if not sensors:
            return signal
        about = Recording(
            self.sampling_rate,
            generator,
            self.derived,
            self.angles.get("pinion_angle"),
            self.angles.get("gear_angle"),
            begins,
        )
        for sensor in sensors:
            own = {p.name: self.values[f"{sensor.name}.{p.name}"] for p in sensor.parameters}
            signal = sensor.measure(signal, own, about)
        return signal

    def _sensors(self, channels: Collection[str], skip: tuple[str, ...]) -> list[Sensor]:
        sensors = [e for e in self.model.effects if isinstance(e, Sensor) and e.name not in skip]
        response = self.model.system.response
        return sorted((s for s in sensors if (s.acts_on or response) in channels), key=lambda s: s.position)

    def keep(self, mask: Tensor) -> "Runs":
        """The runs where `mask` (batch,) is true, or those whose numbers it holds."""

        def some(values: dict[str, Tensor], last: bool) -> dict[str, Tensor]:
            return {k: v[..., mask] if last else v[mask] for k, v in values.items()}

        return replace(
            self,
            values=some(self.values, True),
            derived=some(self.derived, True),
            states=some(self.states, False),
            inputs=some(self.inputs, False),
            status=self.status[mask],
            reference_velocity=self.reference_velocity[mask],
        )


def state_units(model: Model) -> dict[str, str]:
    """The SI unit of every state of the integration by its name in `Runs.states`."""
    return {"displacement": "m", "velocity": "m/s"} | effect_state_units(model)


def effect_state_units(model: Model) -> dict[str, str]:
    """The SI unit of every state that an effect brings."""
    extended = [effect for effect in model.effects if isinstance(effect, ExtraStates)]
    return {f"{effect.name}.{state}": unit for effect in extended for state, unit in effect.states.items()}


def reference_velocity(derived: dict[str, Tensor]) -> Tensor:
    """The velocity amplitude omega_n F0 / k0 that equivalent damping ratios belong to, m/s, (batch,).

    An oscillator has no mean load: its reference amplitude takes the place of F0 / k0. Without a spring the inverse
    of its characteristic time takes the place of omega_n.
    """
    frequency = derived["natural_frequency"]
    if "amplitude" in derived:
        stated = derived["characteristic_time"]
        rate = 1 / torch.where(stated > 0, stated, torch.ones_like(stated))
        return derived["amplitude"] * torch.where(frequency > 0, frequency, rate)
    return frequency * (derived["mean_load"] / derived["mean_stiffness"]).abs()
