"""What a file of this room declares: a network that reads windows of a record and says a damping ratio."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from gear_damping.identification.features import FrontEnd
from gear_damping.identification.networks import DampingNetwork


@dataclass(frozen=True)
class Setting:
    """A number by which an estimator is built: its key under `model`.

    Args:
        name: The key.
        default: Its value where none is given; a whole number asks for whole numbers.
        meaning: For the reader.
        lower: Smallest value.
        upper: Largest value.
    """

    name: str
    default: float | int
    meaning: str
    lower: float
    upper: float

    @property
    def is_whole(self) -> bool:
        """Whether it is a whole number."""
        return isinstance(self.default, int)


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

    def __init__(self, given: Mapping[str, float | int]) -> None:
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
            if not known[name].lower <= value <= known[name].upper:
                ends = f"{known[name].lower:g} and {known[name].upper:g}"
                raise ValueError(f"{self.name}: {name} must lie within {ends}, got {value!r}")

    @abstractmethod
    def front_end(self, sampling_rate: float, wavelet: Mapping[str, Any]) -> FrontEnd:
        """From windows (batch, window) to features (batch, window, feature).

        Args:
            sampling_rate: Hz.
            wavelet: Settings of `features.make_wavelet`, for those that transform.
        """

    @abstractmethod
    def network(self, n_features: int) -> DampingNetwork:
        """From features to damping ratios."""
