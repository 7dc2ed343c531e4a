"""What a file of this room declares: an estimator of damping, by itself from a record or as a network of windows."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from gear_damping.identification.damping_estimate import DampingEstimate
from gear_damping.identification.features import FrontEnd
from gear_damping.identification.free_vibration import FreeVibration, Turning, free_vibration
from gear_damping.identification.networks import DampingNetwork, GaussianNetwork
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.systems.base import System
from gear_damping.setting import Setting
from gear_damping.signals.wavelets.base import ContinuousWavelet


class Estimator(ABC):
    """An estimator of damping, by name.

    Class attributes: `name`, its key; `reference`, where it is from; `settings`, the numbers by which it is built.
    """

    name: ClassVar[str]
    reference: ClassVar[str]
    settings: ClassVar[tuple[Setting, ...]] = ()

    def __init__(self, given: Mapping[str, float | int | bool]) -> None:
        """Hold the settings.

        Raises:
            ValueError: one is unknown, or out of range.
        """
        known = {setting.name: setting for setting in self.settings}
        unknown = sorted(set(given) - set(known))
        if unknown:
            raise ValueError(f"{self.name} has no setting {unknown}; it has {', '.join(known) or 'none'}")
        self.values = {name: given.get(name, setting.default) for name, setting in known.items()}
        for name, value in self.values.items():
            if problem := known[name].problem(value):
                raise ValueError(f"{self.name}: {problem}")


@dataclass(frozen=True, eq=False)
class Recorded:
    """A record as an estimator meets it.

    Args:
        record: Its responses and inputs.
        system: What it was measured on.
        known: What is stated of the rig.
        turning: Of a gear pair, what turns in it; None where no speed is known.
    """

    record: FitRecord
    system: type[System]
    known: Known
    turning: Turning | None = None

    @cached_property
    def free_vibration(self) -> FreeVibration:
        """What dies away in it by itself.

        Raises:
            UnsuitedRecord: nothing does.
        """
        return free_vibration(self.record, self.turning)


class RecordEstimator(Estimator):
    """An estimator that learns nothing beforehand: a record is all it needs, its settings are all it holds.

    Class attribute: `of_ring_downs`, whether it is for a motion that dies away, and asked where none is named.
    """

    of_ring_downs: ClassVar[bool] = True

    @abstractmethod
    def estimate(self, recorded: Recorded) -> DampingEstimate:
        """The damping of one record, with its 95 % interval.

        Raises:
            UnsuitedRecord: it cannot say anything of this record; the message says why, and what would suit.
        """


class LearnedEstimator(Estimator):
    """A network that learns from simulated runs.

    Class attribute: `transforms`, whether its features are the wavelet transform that was chosen, which a protocol may
    take of whole runs, as the paper does.
    """

    transforms: ClassVar[bool] = False

    @abstractmethod
    def network(self, n_features: int) -> DampingNetwork:
        """From features to damping ratios."""


class RecordNetwork(LearnedEstimator):
    """A network of whole records, which says how sure it is."""

    @abstractmethod
    def front_end(self, sampling_rate: float) -> FrontEnd:
        """From records (batch, time) to features (batch, frame, feature).

        Args:
            sampling_rate: Of the records, samples per second.
        """

    @abstractmethod
    def network(self, n_features: int) -> GaussianNetwork:
        """From features to damping ratios with their deviations."""


class WindowEstimator(LearnedEstimator):
    """A network of windows."""

    @abstractmethod
    def front_end(self, transform: ContinuousWavelet | None) -> FrontEnd:
        """From windows (batch, window) to features (batch, window, feature).

        Args:
            transform: The wavelet transform that was chosen, for those that say that they transform.
        """
