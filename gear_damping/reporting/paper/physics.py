"""What is shown of the response itself: its transform, its ridge lines, the mesh stiffness."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]
LEAST_RIDGE = 0.05  # share of the highest mean magnitude from which a maximum counts as a ridge
HALF_POWER = 0.5**0.5  # of a ridge's magnitude, where its width is read


@dataclass(frozen=True)
class Ridge:
    """A line that the transform shows all along a record.

    Args:
        frequency_hz: Where the mean magnitude is largest.
        low_hz: Where it has fallen to half the power below it, or to the valley before the next line.
        high_hz: The same above.
        share: Its magnitude over that of the highest ridge.
    """

    frequency_hz: float
    low_hz: float
    high_hz: float
    share: float


@dataclass(frozen=True, eq=False)
class Response:
    """A simulated response and its wavelet transform.

    Args:
        time_s: (time,).
        displacement_m: Of the representative damping ratio, (time,).
        frequencies_hz: Of the scales that networks see, (scale,).
        magnitude: Of the coefficients, (scale, time).
        cone: True where the ends of the record are felt, (scale, time).
        fine_hz: Of the scales that ridges are looked for on, (fine,).
        mean_magnitude: Over time outside the cone, one row a damping ratio, (ratio, fine).
        natural_frequency_hz: Of the model.
        mesh_frequency_hz: Of the pinion's teeth.
    """

    time_s: Array
    displacement_m: Array
    frequencies_hz: Array
    magnitude: Array
    cone: Array
    fine_hz: Array
    mean_magnitude: Array
    natural_frequency_hz: float
    mesh_frequency_hz: float

    @property
    def ridges(self) -> list[Ridge]:
        """The maxima of the magnitude, averaged over time and damping ratios, lowest frequency first."""
        size = np.nan_to_num(self.mean_magnitude.mean(axis=0))
        inner = np.arange(1, len(size) - 1)
        peaks = inner[(size[inner] > size[inner - 1]) & (size[inner] >= size[inner + 1])]
        return [self._ridge(size, peak) for peak in peaks if size[peak] >= LEAST_RIDGE * size.max()]

    def _ridge(self, size: Array, peak: int) -> Ridge:
        low, high = peak, peak
        while low > 0 and HALF_POWER * size[peak] < size[low - 1] <= size[low]:
            low -= 1
        while high < len(size) - 1 and HALF_POWER * size[peak] < size[high + 1] <= size[high]:
            high += 1
        at = self.fine_hz
        return Ridge(float(at[peak]), float(at[low]), float(at[high]), float(size[peak] / size.max()))


@dataclass(frozen=True, eq=False)
class Stiffness:
    """Mesh stiffness (N/m) over time (s), each (time,)."""

    time_s: Array
    stiffness: Array


@dataclass(frozen=True)
class Physics:
    """Everything that needs no network.

    Args:
        responses: `right`, `as_printed`, `eccentricity` and `eccentricity_printed`.
        stiffnesses: By label.
        derived: What follows from table 1, of `right` and `as_printed`: by name with its unit.
    """

    responses: Mapping[str, Response]
    stiffnesses: Mapping[str, Stiffness]
    derived: Mapping[str, Mapping[str, float]]

    def change(self, name: str) -> float:
        """Largest difference of a response from the right one, over the deviation of that."""
        right, other = self.responses["right"].displacement_m, self.responses[name].displacement_m
        return float(np.abs(other - right).max() / right.std())

    def plain(self) -> dict[str, object]:
        """The numbers, for JSON."""
        ridges = {n: [vars(ridge) for ridge in response.ridges] for n, response in self.responses.items()}
        changes = {name: self.change(name) for name in ("eccentricity", "eccentricity_printed")}
        means = {label: float(one.stiffness[:-1].mean()) for label, one in self.stiffnesses.items()}
        return {"derived": self.derived, "ridges": ridges, "change": changes, "mean_stiffness_n_per_m": means}
