"""Measured records as a fit sees them: their response channels, how each shows the motion, and what is known beside."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import inf, isinf, log

import numpy as np
import torch
from torch import Tensor

from gear_damping.identification.output_error.running_integral import integrated

DIFFERENCE = 1e-6  # step of the sensitivities, in units of each parameter's scale
SEPARATOR = "@"  # between a parameter and the record whose own it is, `mesh_phase@run_1`


@dataclass(frozen=True)
class FreeParameter:
    """A parameter to fit.

    Args:
        name: Flat name in the model, with an index for one element of a list (`profile_error.phases[1]`).
        start: First guess, SI or the rig's own unit.
        scale: What counts as a step of order one; for a logarithmic one the start itself does.
        logarithmic: Whether its logarithm is fitted, which keeps its sign.
        lower: Smallest value.
        upper: Largest value.
        deviation: Standard deviation of what is expected of it beforehand, about `expected`; relative for a
            logarithmic one. It counts like one sample of what is left, or of the noise where that is more, among those
            that say something of their own.
        expected: Mean of that expectation; a logarithmic one expects its start where absent, another one 0.
        per_record: Whether every record has a value of its own, as of an angle at its start.
        places: Angles all around at which such an angle is tried where nothing is known of it; as usual where 0.
    """

    name: str
    start: float
    scale: float = 1.0
    logarithmic: bool = False
    lower: float = -inf
    upper: float = inf
    deviation: float = inf
    expected: float | None = None
    per_record: bool = False
    places: int = 0

    def value(self, z: Tensor) -> Tensor:
        """The parameter from its fitted coordinate."""
        found = self.start * torch.exp(z) if self.logarithmic else self.start + self.scale * z
        return found.clamp(self.lower, self.upper)

    @property
    def declared_name(self) -> str:
        """The name under which a parameter of single records or a place of a list is declared."""
        return self.name.partition(SEPARATOR)[0].partition("[")[0]

    def coordinate(self, value: float) -> float:
        """The fitted coordinate of a value within the bounds."""
        return min(max(self._coordinate(value), self.range[0]), self.range[1])

    @property
    def range(self) -> tuple[float, float]:
        """Coordinates between which the fit moves: at either end a step of the sensitivities still counts."""
        ends = (self._coordinate(self.lower), self._coordinate(self.upper))
        return min(ends), max(ends) - 2 * DIFFERENCE

    @property
    def surprise(self) -> tuple[float, float]:
        """What is expected as a residual: its value at coordinate 0 and its slope, in standard deviations."""
        if isinf(self.deviation):
            return 0.0, 0.0
        if self.logarithmic:
            return log(self.start / (self.expected or self.start)) / self.deviation, 1 / self.deviation
        return (self.start - (self.expected or 0.0)) / self.deviation, self.scale / self.deviation

    def _coordinate(self, bound: float) -> float:
        if isinf(bound):
            return bound
        if not self.logarithmic:
            return (bound - self.start) / self.scale
        return log(bound / self.start) if bound / self.start > 0 else -inf


@dataclass(frozen=True)
class Filter:
    """A Butterworth filter in a sensor, as declared: corner in Hz, poles, and whether it lets high or low through."""

    corner: float
    order: int
    high: bool = False


@dataclass(frozen=True)
class SlowChange:
    """A change of a channel that no vibration makes, as a sum of Legendre polynomials.

    Args:
        terms: How many beyond the zero itself.
        span: Length in s over which they are orthogonal.
        deviation: What is expected of each, a standard deviation in the unit of the channel.
    """

    terms: int
    span: float
    deviation: float

    def shapes(self, time: Tensor) -> Tensor:
        """The polynomials at instants of a record (..., time) in s, (terms, ..., time)."""
        place = torch.as_tensor(2 * time / self.span - 1)
        return torch.stack([torch.special.legendre_polynomial_p(place, k + 1) for k in range(self.terms)])


@dataclass(frozen=True)
class Observed:
    """How a response channel shows the motion.

    Args:
        name: The channel: `displacement`, `velocity`, `acceleration`, `transmission_error`, `pinion_speed`,
            `gear_speed`.
        offset: Whether its zero is unknown, so that every record has an offset of its own.
        scale: Factor on its values where several channels are fitted together: the first one's noise over its own.
        filters: What the sensor lets through.
        delay: How late the channel is, in s.
        shaft: Of a gear pair's acceleration, the shaft that the sensor sits on.
        radius: Where on that shaft, in m.
        absolute: Of an acceleration on a moving base, whether that of the base is in it.
        gain_uncertainty: Relative standard deviation of its gain; 0 where it is known.
        slow: How its zero changes slowly, in every record on its own; None where it stays.
        drifts: Whether it runs on where nothing acts: the displacement of a rig without a spring.
    """

    name: str = "displacement"
    offset: bool = False
    scale: float = 1.0
    filters: tuple[Filter, ...] = ()
    delay: float = 0.0
    shaft: str | None = None
    radius: float | None = None
    absolute: bool = False
    gain_uncertainty: float = 0.0
    slow: "SlowChange | None" = None
    drifts: bool = False

    @property
    def is_tangential(self) -> bool:
        """Whether it is the acceleration across the radius of a shaft."""
        return self.derivatives == 2 and self.shaft is not None

    @property
    def derivatives(self) -> int:
        """How many times the motion is differentiated."""
        return {"displacement": 0, "transmission_error": 0, "acceleration": 2}.get(self.name, 1)


@dataclass(frozen=True)
class FitRecord:
    """A measured record as the fit sees it.

    Args:
        name: What it is called.
        response: Samples of its first response channel, (time,), float64.
        sampling_rate: Hz.
        inputs: Measured input series, (time,) at even instants from the record's beginning on, by the name that the
            simulator gives them.
        conditions: Parameters that are known for this record alone, by flat name.
        weight: Factor on its residuals, one over the noise level where records differ in it.
        observed: What the first response channel shows.
        others: Further response channels with their samples, (time,) each.
        own: Parameters that the record has of its own, beside its start and its offsets.
        group: The record that a segment was cut from; its own name where absent.
        begins: Time in s from the beginning of that record.
        stamps: Instants of the samples in sampling intervals, (time,), where they are not evenly spaced.
        held: Inputs that stay at a sample's value until the next one.
        input_errors: Autocovariance (time,) of what inputs are known wrong by, where they were measured with noise.
        pieces: First and last sample of each segment that it is predicted in, each from a state of its own; () where it
            is predicted from its start.
    """

    name: str
    response: Tensor
    sampling_rate: float
    inputs: Mapping[str, Tensor] = field(default_factory=dict)
    conditions: Mapping[str, float] = field(default_factory=dict)
    weight: float = 1.0
    observed: Observed = Observed()
    others: tuple[tuple[Observed, Tensor], ...] = ()
    own: tuple[FreeParameter, ...] = ()
    group: str = ""
    begins: float = 0.0
    stamps: Tensor | None = None
    held: tuple[str, ...] = ()
    input_errors: Mapping[str, Tensor] = field(default_factory=dict)
    pieces: tuple[tuple[int, int], ...] = ()

    @property
    def record(self) -> str:
        """The record that it is, or was cut from."""
        return self.group or self.name

    @property
    def channels(self) -> tuple[Observed, ...]:
        """Every response channel, the first one first."""
        return (self.observed, *(channel for channel, _ in self.others))

    @property
    def instants(self) -> Tensor:
        """Of the samples in sampling intervals, (time,)."""
        return torch.arange(len(self.response), dtype=torch.float64) if self.stamps is None else self.stamps

    def at_samples(self, name: str) -> Tensor:
        """An input at the instants of the samples, (time,)."""
        series = self.inputs[name]
        if self.stamps is None:
            return series
        return torch.as_tensor(np.interp(self.stamps.numpy(), np.arange(len(series)), series.numpy()))

    @property
    def stacked(self) -> Tensor:
        """Samples of all response channels one after another, in the unit of the first, (channels * time,)."""
        if not self.others:
            return self.response
        return torch.cat([self.response, *(channel.scale * values for channel, values in self.others)])

    @property
    def duration(self) -> float:
        """Length in s."""
        return len(self.response) / self.sampling_rate

    @cached_property
    def shown_motion(self) -> Tensor:
        """What its first channel shows, (time,), of a rate or an acceleration the displacement about its mean."""
        return integrated(self.response.to(torch.float64), self.sampling_rate, self.observed.derivatives)
