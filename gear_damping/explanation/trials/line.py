"""The strongest line in residuals: a steady force at any order of the pinion, or at any frequency of an oscillator.

A belt, a bearing, another machine turn at orders that belong to neither shaft. Their phase is another one in every
record.
"""

from dataclasses import dataclass
from math import pi

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.shaft import shaft_of
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.linear import linear_of
from gear_damping.explanation.trials.score import projected
from gear_damping.identification.output_error.normal_equations import without_own
from gear_damping.identification.output_error.records import FitRecord

Array = NDArray[np.float64]
FINE = 4  # places over the width of a line, one turn or cycle in the longest record
LOW = 12  # turns or cycles in a record, up to which every place is tried
EXACT = 1e-3  # of that width, to which the place is found: a wave of 40 dB is then taken out to its noise
PEAKS = 8  # of the periodogram, that are tried beyond
HIGHEST = 4.0  # natural frequencies up to which peaks are looked for
FEWEST_CYCLES = 8.0  # of a line in an oscillator's record: fewer are not told from a bend of its motion


@dataclass(frozen=True)
class Line:
    """A line.

    Args:
        place: Order of the pinion's shaft, or frequency in Hz of an oscillator.
        unit: Which of the two.
        hertz: Its frequency in the first record.
        share: Of the residuals beside their model's parameters, that it takes.
        columns: What it would do to every record, (records, samples, 2).
    """

    place: float
    unit: str
    hertz: float
    share: float
    columns: Tensor

    @property
    def name(self) -> str:
        """What it is called."""
        if self.unit == "Hz":
            return f"a line at {self.place:.4g} Hz"
        return f"a line at order {self.place:.3g} of the pinion's shaft ({self.hertz:.3g} Hz)"

    @property
    def degrees(self) -> int:
        """Numbers that it takes: two of every record, and its place."""
        return 2 * len(self.columns) + 1

    def taken_out_of(self, signal: Tensor) -> Tensor:
        """A signal of all records, (samples,), beside it."""
        rows = signal.reshape(len(self.columns), -1, 1)
        return without_own(rows, torch.linalg.qr(self.columns).Q).reshape(-1)


def strongest_line(outcome: Outcome, evidence: Evidence) -> Line | None:
    """The line that takes most of what a model leaves beside its own parameters.

    None in segments, of which none holds a line of its own, and in records that are too short for one.
    """
    rows = outcome.problem.records
    if evidence.segments:
        return None
    angles = [_angle(row, evidence) for row in rows]
    span = max(float(angle[-1] - angle[0]) for angle in angles)
    project, residual = projected(outcome)
    residual = project(residual)
    total = float(residual.square().sum())
    if span <= 0 or total <= 0:
        return None

    def taken(place: float) -> float:
        left = project.beside_own(_columns(place, angles, outcome))(residual)
        return 1 - float(left.square().sum()) / total

    width = 2 * pi / span
    lowest = width / FINE if evidence.system == "gear_pair" else width * FEWEST_CYCLES
    places = [width * k / FINE for k in range(1, FINE * LOW)] + _peaks(residual, angles, outcome)
    places = [place for place in places if place >= lowest]
    if not places:
        return None
    near = max(places, key=taken)
    ends = (max(near - width / FINE, lowest / 2), near + width / FINE)
    settled = minimize_scalar(lambda at: -taken(at), bounds=ends, method="bounded", options={"xatol": EXACT * width})
    place, first = max(near, float(settled.x), key=taken), rows[0]
    hertz = place * float(angles[0][-1] - angles[0][0]) / (2 * pi) / (len(angles[0]) - 1) * first.sampling_rate
    unit = "order" if shaft_of(first, evidence) else "Hz"
    return Line(place, unit, hertz, taken(place), _columns(place, angles, outcome))


def _angle(record: FitRecord, evidence: Evidence) -> Array:
    """Angle of the pinion in rad, or of a line of 1 Hz."""
    shaft = shaft_of(record, evidence)
    return 2 * pi * np.arange(len(record.response)) / record.sampling_rate if shaft is None else shaft.angle


def _columns(place: float, angles: list[Array], outcome: Outcome) -> Tensor:
    """A wave at one place in the first channel of every record, (records, samples, 2), weighted.

    What a steady force makes of the motion is that too, but for its beginning, which is the initial state's.
    """
    response = outcome.problem.response
    found = torch.zeros(len(angles), len(response.channels), response.length, 2, dtype=torch.float64)
    for row, (record, angle) in enumerate(zip(outcome.problem.records, angles, strict=True)):
        waves = np.stack([np.cos(place * angle), np.sin(place * angle)], 1)
        found[row, response.channels.index(record.observed.name), : len(angle)] = torch.as_tensor(waves)
    return found.flatten(1, 2) * response.weights.unsqueeze(-1)


def _peaks(residual: Tensor, angles: list[Array], outcome: Outcome) -> list[float]:
    """Places at which the first channel of the records, read over the angle at even steps, has most power."""
    problem = outcome.problem
    length, count = problem.response.length, max(len(angle) for angle in angles)
    rows = residual[: problem.response.weights.numel(), 0].reshape(len(angles), -1, length)
    span = max(float(angle[-1] - angle[0]) for angle in angles)
    even, power = np.linspace(0, span, count), np.zeros(count // 2 + 1)
    for row, (record, angle) in enumerate(zip(problem.records, angles, strict=True)):
        own = rows[row, problem.response.channels.index(record.observed.name), : len(angle)].numpy()
        power += np.abs(np.fft.rfft(np.interp(even, angle - angle[0], own, right=0.0))) ** 2
    places = 2 * pi * np.arange(len(power)) / span
    mass, _, stiffness = linear_of(outcome)
    rate = problem.records[0].sampling_rate * span / count  # of the angle, rad/s
    power[(places * rate > HIGHEST * (stiffness / mass) ** 0.5) | (np.arange(len(power)) < LOW)] = 0.0
    return [float(places[k]) for k in np.argsort(power)[::-1][:PEAKS] if power[k] > 0]
