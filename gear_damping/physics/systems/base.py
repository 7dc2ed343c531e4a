"""What a base system declares: its parameters, derived quantities, angles and load."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

from torch import Tensor

from gear_damping.physics.damping_ratio import MEANT
from gear_damping.physics.declared import Declared
from gear_damping.physics.kinematics import Kinematics, Rotation
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.scales import Scales
from gear_damping.physics.systems.traits import Trait

Values = Mapping[str, Tensor]


class System(Declared, ABC):
    """A single-degree-of-freedom base; effects are added to it as terms.

    What it declares is all that effects, identification and explanation know of it: they ask for a trait or one of
    the attributes below, never for a name.
    """

    response: ClassVar[str]  # the channel that displacement is recorded in
    inputs: ClassVar[dict[str, str]]  # series that may be given, with their SI units; the one that drives it first
    derived_units: ClassVar[dict[str, str]]
    traits: ClassVar[frozenset[Trait]]
    responses: ClassVar[tuple[str, ...]]  # channels that its motion is fitted to, the one that tells most first
    gains: ClassVar[dict[str, str]] = {}  # inputs whose scale is a parameter, with its name
    spring: ClassVar[str | None] = None  # the parameter that is its constant stiffness; None where it has a mesh
    # sensor effects that its nominal fit allows for by offsets and gains of its own: no candidates
    covered_by_nuisance: ClassVar[frozenset[str]] = frozenset()
    meant = MEANT

    @classmethod
    def has(cls, *traits: Trait) -> bool:
        """Whether it has all of these traits."""
        return cls.traits.issuperset(traits)

    def _told(self, parameter: Parameter) -> Parameter:
        return replace(parameter, unit=self.told_unit(parameter.unit))

    def _key(self, name: str) -> str:
        return name  # beside those of effects

    def unit_of(self, declared: str) -> str:
        """The unit of what is declared in `declared` (SI), as its values are in; "" where nobody knows it."""
        return declared

    def told_unit(self, declared: str) -> str:
        """The unit in which a value of what is declared in `declared` (SI) is told."""
        return self.unit_of(declared) or declared

    @abstractmethod
    def derived(self, values: Values, mean_stiffness: Tensor | None) -> dict[str, Tensor]:
        """Quantities that follow from the parameters, in SI, with the units of `derived_units`."""

    @abstractmethod
    def scales(self, derived: Values) -> Scales:
        """The natural units of each member."""

    @abstractmethod
    def load(self, at: Kinematics, p: Values) -> Tensor:
        """The load F(t) in natural units, from parameters and inputs."""

    def stiffness(self, p: Values) -> Tensor:
        """The constant stiffness of a base without a mesh."""
        raise NotImplementedError(f"{self.name} takes its stiffness from a mesh_stiffness effect")

    def rotations(self, time: Tensor, inputs: Values, p: Values, displacement: Tensor) -> dict[str, Rotation]:
        """Pinion, gear and mesh rotation; empty for a base that does not turn."""
        return {}

    def begun_later(self, values: Values, seconds: Tensor) -> dict[str, Tensor]:
        """Values of a run that begins so many seconds (batch,) after the instant they hold for; those that change."""
        return {}
