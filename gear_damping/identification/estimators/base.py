"""What a file of this room declares: a network that reads windows of a record and says a damping ratio."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar

from gear_damping.identification.features import FrontEnd
from gear_damping.identification.networks import DampingNetwork
from gear_damping.setting import Setting
from gear_damping.signals.wavelets.base import ContinuousWavelet


class WindowEstimator(ABC):
    """A network of windows, by name.

    Class attributes: `name`, its key in `model.names`; `reference`, where it is from; `settings`, the numbers by which
    it is built; `transforms`, whether its features are a transform, which a protocol may take of whole runs, as the
    paper does.
    """

    name: ClassVar[str]
    reference: ClassVar[str]
    settings: ClassVar[tuple[Setting, ...]] = ()
    transforms: ClassVar[bool] = False

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

    @abstractmethod
    def front_end(self, transform: ContinuousWavelet | None) -> FrontEnd:
        """From windows (batch, window) to features (batch, window, feature).

        Args:
            transform: The wavelet transform that was chosen, for those that say that they transform.
        """

    @abstractmethod
    def network(self, n_features: int) -> DampingNetwork:
        """From features to damping ratios."""
