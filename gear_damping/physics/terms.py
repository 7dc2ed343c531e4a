"""The slots of the equation of motion, and what every effect declares.

    m x'' + contact * F_d(delta') + N = F(t),   delta = x - e,   N = k * deflection + F_el

An effect is one final class in one file of `effects/` that fills one of these slots (or several).
Its declaration feeds the simulator, the configuration, the catalogue of causes, the documentation
and the parametrised tests.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause
from gear_damping.physics.damping_ratio import MEANT
from gear_damping.physics.declared import Declared
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.scales import Scales
from gear_damping.physics.systems.traits import Trait

Values = Mapping[str, Tensor]


class Effect(Declared, ABC):
    """What every effect declares; `name` is its configuration key, cause name and file name.

    Printed, it is its equation.
    """

    equation: ClassVar[str]
    reference: ClassVar[str]
    needs: ClassVar[tuple[Trait, ...]] = ()  # traits of a system that it goes with
    dissipative: ClassVar[bool] = False
    requires: ClassVar[tuple[str, ...]] = ()  # names of effects that must be there too
    cause: ClassVar[Cause | None] = None  # what `task=explain` tries and says of it; None: it is no candidate
    mean_free: ClassVar[tuple[str, ...]] = ()  # lists of which only the differences act: their mean is taken as 0
    radian: ClassVar[str] = ""  # parameter that is one radian in the unit of the response, where that is an angle
    told_alone: ClassVar[str] = (
        ""  # of what differs between records: the parameter of a system that is its size in each
    )
    refinement: ClassVar[float] = 1.0  # of the steps, where the force bends too sharply for them; measured

    def __str__(self) -> str:
        return f"{self.name}: {self.equation}"

    def to_natural(self, values: Values, scales: Scales) -> dict[str, Tensor]:
        """The parameters in natural units, from SI; shapes (batch,) or (n, batch)."""
        units = {p.name: p.dimension for p in self.parameters}
        return {name: value / scales.unit_of(units[name]) for name, value in values.items()}

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """What the term needs at every instant, worked out once from its natural parameters.

        Args:
            values: The effect's parameters in natural units.
            base: The system's derived quantities in natural units (see `System.derived`).
        """
        return dict(values)


class MeshStiffness(Effect):
    """The slot of k(t); a gear pair has exactly one. It has a parameter called `contact_ratio`."""

    needs: ClassVar[tuple[Trait, ...]] = (Trait.TEETH,)

    @abstractmethod
    def mean(self, values: Values) -> Tensor:
        """Mean stiffness over a mesh period, in the units of `values`; shape (batch,)."""

    @abstractmethod
    def stiffness(self, at: Kinematics, p: Values) -> Tensor:
        """K at this instant."""


class StiffnessFactor(Effect):
    """A factor on the stiffness."""

    @abstractmethod
    def factor(self, at: Kinematics, p: Values) -> Tensor:
        """The factor at this instant, 1 where the effect does nothing."""


class TransmissionErrorSource(Effect):
    """A geometric error e that the flanks impose: delta = x - e."""

    @abstractmethod
    def error(self, at: Kinematics, p: Values) -> tuple[Tensor, Tensor]:
        """E and its rate at this instant."""


class Switch(Effect):
    """An effect whose branch depends on the sign of smooth functions.

    The solver holds the branch within a step and splits the step where a function changes sign.
    """

    @abstractmethod
    def switches(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """The switching functions by name; names start with the effect's own."""


class Contact(Switch):
    """The slot that turns delta into the deflection of the flanks; absent, contact never ends."""

    @abstractmethod
    def deflect(self, at: Kinematics, p: Values) -> tuple[Tensor, Tensor]:
        """The deflection, and 1 where the flanks touch, else 0."""

    @abstractmethod
    def clearances(self, at: Kinematics, p: Values) -> tuple[Tensor, Tensor]:
        """Distances of the flanks on the drive side and on the coast side, 0 where they touch."""


class ElasticForce(Effect):
    """A restoring force beside k * deflection."""

    @abstractmethod
    def elastic_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant, positive where it opposes a positive deflection."""


class DampingForce(Effect):
    """A force that opposes the rate of deflection; it acts only where the flanks touch."""

    acts_in_gap: ClassVar[bool] = False  # whether it acts where they do not touch as well

    @abstractmethod
    def damping_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant, positive where it opposes a positive rate."""


class Load(Effect):
    """A force added to the load F(t)."""

    @abstractmethod
    def load_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant, positive where it presses the drive flanks together."""

    @property
    def is_unbalanced(self) -> bool:
        """Whether it comes of a torque on the pinion that the gear's does not follow even where it is `balanced`.

        Then both shafts speed up with it, as with every load where the gear's torque is `held`.
        """
        return False


class LoadFactor(Effect):
    """A factor on the load of the torques; drawn loads come on top."""

    @abstractmethod
    def load_factor(self, at: Kinematics, p: Values) -> Tensor:
        """The factor at this instant, 1 where the effect does nothing."""


class LoadPath(Effect):
    """What stands between the torques and the mesh."""

    @abstractmethod
    def transmitted_load(self, at: Kinematics, p: Values) -> Tensor:
        """The load that reaches the mesh, from `at.drive_load`, the load of the torques."""

    @property
    def turned_shaft(self) -> str:
        """The shaft of a gear pair that it turns with another torque than the stated one."""
        return "pinion"


class BearingForce(Effect):
    """A force on a gear in its bearing, along the line of action."""

    @abstractmethod
    def bearing_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant, positive where it pushes as the mesh force does."""


class DampingLaw(DampingForce):
    """A damping force whose size can be stated as an equivalent damping ratio."""

    meant = MEANT

    @abstractmethod
    def damping_ratio(self, values: Values, mass: Tensor, stiffness: Tensor, velocity: Tensor) -> Tensor:
        """The equivalent damping ratio at a velocity amplitude (m/s), all in SI; shape (batch,)."""

    @abstractmethod
    def coefficient_for(
        self, damping_ratio: Tensor, values: Values, mass: Tensor, stiffness: Tensor, velocity: Tensor
    ) -> dict[str, Tensor]:
        """The parameters, by own name in SI, that have this equivalent damping ratio."""


class MeshForceFactor(Effect):
    """A factor on the whole force between the flanks, N plus damping."""

    @abstractmethod
    def force_factor(self, at: Kinematics, p: Values) -> Tensor:
        """The factor at this instant, 1 where the effect does nothing."""

    def common_share(self, at: Kinematics, p: Values) -> tuple[Tensor, Tensor] | None:
        """The force that speeds both shafts up together, per force between the flanks; None where there is none.

        Of whole series, as sensors on a shaft see them: the relative motion feels nothing of it. (time, batch), and its
        mean over a pitch, (batch,), which a brake that holds the speed balances.
        """
        return None


class ExtraStates(Effect):
    """An effect with states of its own; combine it with the slots through which they act."""

    states: ClassVar[dict[str, str]]  # name -> SI unit; `at.extra` has them as `effect.state`

    def decay_time(self, values: Mapping[str, float]) -> float:
        """Seconds in which its free motion falls to 1/e, by own parameters; 0 where it does not swing by itself."""
        return 0.0

    def exchange_time(self, values: Mapping[str, float], natural_frequency_hz: float) -> float:
        """Seconds after which it has given back what it took from the first mode; infinite where it hardly does."""
        return inf

    def initial(self, p: Values, base: Values) -> dict[str, Tensor]:
        """The states at the start in natural units, by own name; at rest unless said otherwise."""
        zero = torch.zeros_like(base["equivalent_mass"])
        return dict.fromkeys(self.states, zero)

    @abstractmethod
    def state_rates(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """Rates of the states, by own name; `at.mesh_force` and `at.load` are known by then."""


class SystemChange(Effect):
    """A change of the quantities that the system derives from its parameters."""

    @abstractmethod
    def change(self, values: Values, derived: dict[str, Tensor]) -> dict[str, Tensor]:
        """The derived quantities with the change made, all in SI."""


class ContactChange(Effect):
    """A change of the zone of double contact with the mean load."""

    @abstractmethod
    def contact(self, values: Values, contact_ratio: Tensor, derived: Values) -> tuple[Tensor, Tensor]:
        """The contact ratio, and the mesh angle (rad) by which double contact begins early.

        `values` and `derived` are in SI; shapes (batch,).
        """


class HeldLoad(Effect):
    """A random load, drawn once per run and held over each output sample."""

    @abstractmethod
    def draw(self, values: Values, mean_load: Tensor, samples: int, generator: torch.Generator) -> Tensor:
        """The load in the unit of `mean_load`; shape (batch, samples)."""


@dataclass(frozen=True)
class Recording:
    """What a sensor may know beside the signal.

    Args:
        sampling_rate: Samples per second.
        generator: Source of randomness.
        derived: Derived quantities of the system in SI, each (batch,).
        pinion_angle: True angle of the pinion shaft (batch, time) in rad; None without a shaft.
        gear_angle: True angle of the gear shaft.
        begins: Time in s from the start of the record to the first sample, (batch,); 0 where absent.
    """

    sampling_rate: float
    generator: torch.Generator
    derived: Values
    pinion_angle: Tensor | None = None
    gear_angle: Tensor | None = None
    begins: Tensor | None = None

    def times(self, signal: Tensor) -> Tensor:
        """Seconds since the record began, of which a signal (batch, time) may be a segment; (1 or batch, time)."""
        time = torch.arange(signal.shape[-1], dtype=signal.dtype, device=signal.device) / self.sampling_rate
        return time.unsqueeze(0) if self.begins is None else time + self.begins.unsqueeze(1)


TANGENTIAL = "tangential_acceleration"  # the channel of what acts on accelerometers that sit on a shaft


class Sensor(Effect):
    """What stands between the motion and its record; applied to SI signals after the integration."""

    position: ClassVar[int] = 0  # in the chain from the motion (low) to the file (high)
    channel: ClassVar[str | None] = None  # None: the response; else the channel it acts on

    @property
    def acts_on(self) -> str | None:
        """The channel it acts on; None for the response."""
        return self.channel

    @abstractmethod
    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The recorded signal from the true one; shape (batch, time), SI; `values` in SI."""

    @property
    def start_modes(self) -> int:
        """How many states of its own the sensor has at the start of a record."""
        return 0

    def left_of_start(self, values: Values, time: Tensor) -> Tensor:
        """What each of them leaves in the record where it is 1, (modes, batch, time) at times (time,) in s."""
        return time.new_zeros(0, 1, len(time))

    def undo(self, signal: Tensor, values: Values) -> Tensor:
        """The true signal from a recorded one that drives a simulation; unchanged where nothing is known."""
        return signal
