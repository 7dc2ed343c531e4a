"""Evaluates terms at random instants, without a simulator: SI in, SI out."""

from __future__ import annotations

from dataclasses import dataclass, field

import torch
from torch import Tensor

from gear_damping.physics.catalogue import builtin_effects
from gear_damping.physics.equation import EquationOfMotion
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.model import Model
from gear_damping.physics.scales import Scales
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.known import SYSTEMS, systems_of
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.physics.terms import Effect, ExtraStates, MeshStiffness, Sensor, Switch
from gear_damping.units import parse_unit

BATCH = 24
EFFECTS = builtin_effects()
# effects whose default sizes fit the gear pair, in sizes that fit an oscillator of unit stiffness
FOR_OSCILLATOR = {"hysteretic_damping.yield_deflection": 0.05, "cubic_stiffness.coefficient": 0.4}


class PlainGearPair(GearPair):
    """The gear pair with SI as its natural units."""

    def scales(self, derived: dict) -> Scales:
        one = torch.ones_like(derived["equivalent_mass"])
        return Scales(one, one, one)


class PlainOscillator(Oscillator):
    """The oscillator with SI as its natural units."""

    def scales(self, derived: dict) -> Scales:
        one = torch.ones_like(derived["equivalent_mass"])
        return Scales(one, one, one)


PLAIN = {"gear_pair": PlainGearPair, "oscillator": PlainOscillator}


def variants() -> list[tuple[str, dict]]:
    """Every effect with its default options, and with each other choice of one option."""
    found = []
    for name, cls in EFFECTS.items():
        found.append((name, {}))
        for option in cls.options:
            choices = [c for c in option.choices if c != option.default]
            choices = choices if len(choices) < 5 else [1, choices[-1]]
            found += [(name, {option.name: choice}) for choice in choices]
    return [v for v in found if not (v[0] == "pitch_error" and v[1])]  # its gear has 40 values: tested apart


def label(variant: tuple[str, dict]) -> str:
    return variant[0] + "".join(f"-{k}={v}" for k, v in variant[1].items())


def random_states(scale: float, seed: int, batch: int = BATCH) -> tuple[Tensor, Tensor]:
    """Displacements about 1 and velocities about 0, times `scale`."""
    source = torch.Generator().manual_seed(seed)
    x = scale * (1 + 0.5 * torch.randn(batch, generator=source, dtype=torch.float64))
    v = scale * torch.randn(batch, generator=source, dtype=torch.float64)
    return x, v


@dataclass
class Bench:
    """One model with one effect in question, a batch of parameters, and instants to look at.

    Args:
        name: The effect in question.
        options: Its options.
        given: Values by flat name that differ from the defaults.
        others: Further effects.
        plain: Whether SI takes the place of natural units.
    """

    name: str
    options: dict = field(default_factory=dict)
    given: dict = field(default_factory=dict)
    others: tuple[str, ...] = ()
    plain: bool = False
    system_options: dict = field(default_factory=dict)
    batch: int = BATCH

    def __post_init__(self) -> None:
        cls = EFFECTS[self.name]
        self.effect: Effect = cls(**self.options)
        self.kind = "gear_pair" if "gear_pair" in systems_of(cls) else "oscillator"
        names = [*cls.requires, *self.others]
        if self.kind == "gear_pair" and not issubclass(cls, MeshStiffness):
            names.append("fourier_mesh_stiffness")
        systems = PLAIN if self.plain else SYSTEMS
        self.model = Model(systems[self.kind](**self.system_options), [self.effect, *(EFFECTS[n]() for n in names)])
        fitting = {} if self.kind == "gear_pair" else FOR_OSCILLATOR
        fitting = {k: v for k, v in fitting.items() if k in self.model.parameters()}
        self.values = self.model.values(self.batch, **(fitting | self.given))
        self.use(self.values)
        self.equation = EquationOfMotion(self.model)

    def use(self, values: dict[str, Tensor]) -> None:
        """Take other values."""
        self.values, self.prepared = values, self.model.prepare(values)

    @property
    def own(self) -> dict[str, Tensor]:
        """The effect's parameters in SI by own name."""
        return {p.name: self.values[f"{self.name}.{p.name}"] for p in self.effect.parameters}

    @property
    def p(self) -> dict[str, Tensor]:
        """What the effect prepared, natural units."""
        return self.prepared.terms[self.name]

    def unit(self, unit: str) -> Tensor:
        """The natural unit of a quantity, in SI."""
        return self.prepared.scales.unit_of(parse_unit(unit).dimension)

    def kinematics(self, time: Tensor, state: tuple[Tensor, ...], inputs: dict | None = None) -> Kinematics:
        """Kinematics on the active branch, from SI: time, displacement, velocity and the states of effects."""
        units = ["m", "m/s"]
        for effect in self.model.effects:
            if isinstance(effect, ExtraStates):
                units += effect.states.values()
        scaled = tuple(s / self.unit(u) for s, u in zip(state, units, strict=True))
        at = self.equation.kinematics(time / self.unit("s"), scaled, inputs or {}, self.prepared.base)
        if any(isinstance(e, Switch) for e in self.model.effects):
            found = self.equation.switches(at, self.prepared.terms)
            at.active_branch = {k: (v >= 0).to(v) for k, v in found.items()}
        return at

    def rest_of_state(self) -> tuple[Tensor, ...]:
        """The states of effects at the start, in SI."""
        found = []
        for effect in self.model.effects:
            if isinstance(effect, ExtraStates):
                start = effect.initial(self.prepared.terms[effect.name], self.prepared.base)
                found += [start[k] * self.unit(u) for k, u in effect.states.items()]
        return tuple(found)

    def evaluated(self, seed: int = 0, time: Tensor | None = None) -> Kinematics:
        """A moment of random states with every field filled in."""
        at = self.kinematics(self.times() if time is None else time, (*self.random(seed), *self.rest_of_state()))
        self.equation.rates(at, self.prepared.base, self.prepared.terms)
        return at

    def times(self) -> Tensor:
        """Times spread over some turns, none of them on an edge, in s."""
        return torch.linspace(1.1e-5, 0.0307, self.batch, dtype=torch.float64)

    def random(self, seed: int = 0) -> tuple[Tensor, Tensor]:
        """Random displacement and velocity in SI, in contact and out of it."""
        x, v = random_states(1.0, seed, self.batch)
        if self.kind == "oscillator":
            return x, v
        x = torch.where(torch.arange(self.batch) % 3 == 0, x * 16e-6 - 6e-5, x * 16e-6)
        return torch.where(torch.arange(self.batch) % 4 == 1, x - 1.2e-4, x), 0.5 * v

    def acceleration(self, at: Kinematics) -> Tensor:
        """The acceleration in SI."""
        return self.equation.rates(at, self.prepared.base, self.prepared.terms)[1] * self.unit("m/s^2")


def is_sensor(name: str) -> bool:
    return issubclass(EFFECTS[name], Sensor)
