"""The strongest line in residuals: a steady force at any order of the pinion, or at any frequency of an oscillator.

A belt or a bearing turns at orders that belong to neither shaft, the mains and other machines at a frequency of their
own. Their phase is another one in every record.
"""

from dataclasses import dataclass, replace
from math import pi

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.shaft import shaft_of
from gear_damping.explanation.model.hypothesis import Outcome, natural_frequency_hz
from gear_damping.explanation.model.linear import linear_of
from gear_damping.explanation.statistics.projector import Projector
from gear_damping.explanation.trials.motion import motions
from gear_damping.explanation.trials.score import projected
from gear_damping.identification.output_error.normal_equations import project_out

Array = NDArray[np.float64]
FINE = 4  # places over the width of a line, one turn or cycle in the longest record
LOW = 12  # turns or cycles in a record, up to which every place is tried
EXACT = 1e-3  # of that width, to which the place is found: a wave of 40 dB is then taken out to its noise
PEAKS = 8  # of the periodogram, that are tried beyond
HIGHEST = 4.0  # natural frequencies up to which peaks are looked for
FEWEST_TURNS = 1.0  # of a line in a record of a gear pair: less is a drift,
FEWEST_CYCLES = 2.0  # and in an oscillator's, whose motion dies away
OWN = 1.5  # widths about the natural frequency of an oscillator, which are its own motion where this bends,
HARMONICS = 5  # and about so many multiples of it, which a law that is not linear makes


@dataclass(frozen=True)
class Line:
    """A line.

    Args:
        place: Order of the pinion's shaft, or frequency in Hz: what it keeps in all records.
        unit: Which of the two.
        hertz: Its frequency in the first record.
        is_force: Whether it changes the deflection of a gear pair in proportion, as a force does.
        share: Of the residuals, their model's parameters projected out, that it takes.
        columns: What it would do to every record, (records, samples, 2).
    """

    place: float
    unit: str
    hertz: float
    is_force: bool
    share: float
    columns: Tensor

    @property
    def name(self) -> str:
        """What it is called."""
        kind = "a force" if self.is_force else "a line"
        if self.unit == "Hz":
            return f"{kind} at {self.place:.4g} Hz"
        return f"{kind} at order {self.place:.3g} of the pinion's shaft ({self.hertz:.3g} Hz)"

    @property
    def degrees(self) -> int:
        """Numbers that it takes: two of every record, and its place."""
        return 2 * len(self.columns) + 1

    def taken_out_of(self, signal: Tensor) -> Tensor:
        """A signal of all records, (samples,), beside it."""
        rows = signal.reshape(len(self.columns), -1, 1)
        return project_out(rows, torch.linalg.qr(self.columns).Q).reshape(-1)


def strongest_line(outcome: Outcome, evidence: Evidence) -> Line | None:
    """The line that takes most of what a model leaves, its own parameters projected out.

    None in segments, of which none holds a line of its own, and in records that are too short for one.
    """
    if evidence.segments:
        return None
    project, residual = projected(outcome)
    residual = project(residual)
    clocks = [clock for clock in _clocks(outcome, evidence) if clock.span > 0]
    if not clocks or float(residual.square().sum()) <= 0:
        return None
    found = [_strongest(clock, residual, project, outcome) for clock in clocks]
    return max((line for line in found if line), key=lambda line: line.share, default=None)


@dataclass(frozen=True)
class _Clock:
    """What a line goes with.

    Args:
        unit: Of its place.
        angles: By record, in rad at place 1, (time,).
        fewest: Turns or cycles of a line in the longest record.
        own: Place of the motion itself; None where a steady mesh drives it.
        carried: By record, what the wave changes in proportion, (time,); None where it is seen as it is.
    """

    unit: str
    angles: list[Array]
    fewest: float
    own: float | None = None
    carried: list[Array] | None = None

    @property
    def span(self) -> float:
        """Of the longest record, rad."""
        return max(float(angle[-1] - angle[0]) for angle in self.angles)


def _clocks(outcome: Outcome, evidence: Evidence) -> list[_Clock]:
    """The pinion of a gear pair, and the time; a slow force changes its deflection in proportion, mesh and all."""
    rows = outcome.problem.records
    time = [2 * pi * np.arange(len(row.response)) / row.sampling_rate for row in rows]
    shafts = [shaft_of(row, evidence) for row in rows]
    if not all(shafts) or not any(np.ptp(shaft.angle) for shaft in shafts):  # nothing turns: it swings or rings
        natural = natural_frequency_hz(outcome.hypothesis.model, outcome.flat_given())
        return [_Clock("Hz", time, FEWEST_CYCLES, natural)]
    turned = [shaft.angle for shaft in shafts]
    clocks = [_Clock("order", turned, FEWEST_TURNS), _Clock("Hz", time, FEWEST_TURNS)]
    if any(row.observed.derivatives for row in rows):
        return clocks
    deflections = [place / np.abs(place).mean() for place, _ in motions(outcome)]
    return clocks + [replace(clock, carried=deflections) for clock in clocks]


def _strongest(clock: _Clock, residual: Tensor, project: Projector, outcome: Outcome) -> Line | None:
    """The strongest line on one clock."""
    total, width = float(residual.square().sum()), 2 * pi / clock.span

    def taken(place: float) -> float:
        return project.taken_by_own(_columns(place, clock, outcome), residual) / total

    places = [width * k / FINE for k in range(1, FINE * LOW)] + _peaks(residual, clock, outcome)
    places = [place for place in places if place >= clock.fewest * width]
    own = [k * clock.own for k in range(1, HARMONICS + 1)] if clock.own else []
    places = [place for place in places if all(abs(place - one) >= OWN * width for one in own)]
    if not places:
        return None
    near = max(places, key=taken)
    ends = (max(near - width / FINE, clock.fewest * width), near + width / FINE)
    settled = minimize_scalar(lambda at: -taken(at), bounds=ends, method="bounded", options={"xatol": EXACT * width})
    place, angle = max(near, float(settled.x), key=taken), clock.angles[0]
    turns = float(angle[-1] - angle[0]) / (2 * pi)
    hertz = place * turns / (len(angle) - 1) * outcome.problem.records[0].sampling_rate
    return Line(place, clock.unit, hertz, clock.carried is not None, taken(place), _columns(place, clock, outcome))


def _columns(place: float, clock: _Clock, outcome: Outcome) -> Tensor:
    """A wave at one place in the first channel of every record, (records, samples, 2), weighted.

    What a steady force makes of the motion is that too, but for its beginning, which is the initial state's.
    """
    response, angles = outcome.problem.response, clock.angles
    found = torch.zeros(len(angles), len(response.channels), response.length, 2, dtype=torch.float64)
    for row, (record, angle) in enumerate(zip(outcome.problem.records, angles, strict=True)):
        waves = np.stack([np.cos(place * angle), np.sin(place * angle)], 1)
        if clock.carried is not None:
            waves = waves * clock.carried[row][:, None]
        found[row, response.channels.index(record.observed.name), : len(angle)] = torch.as_tensor(waves)
    return found.flatten(1, 2) * response.weights.unsqueeze(-1)


def _peaks(residual: Tensor, clock: _Clock, outcome: Outcome) -> list[float]:
    """Places at which the first channel of the records, read over the angle at even steps, has most power."""
    problem = outcome.problem
    angles, span, length = clock.angles, clock.span, problem.response.length
    rows = residual[: problem.response.weights.numel(), 0].reshape(len(angles), -1, length)
    count = max(len(angle) for angle in angles)
    even, power = np.linspace(0, span, count), np.zeros(count // 2 + 1)
    for row, (record, angle) in enumerate(zip(problem.records, angles, strict=True)):
        own = rows[row, problem.response.channels.index(record.observed.name), : len(angle)].numpy()
        power += np.abs(np.fft.rfft(np.interp(even, angle - angle[0], own, right=0.0))) ** 2
    places = 2 * pi * np.arange(len(power)) / span
    mass, _, stiffness = linear_of(outcome)
    rate = problem.records[0].sampling_rate * span / count  # of the angle, rad/s
    power[(places * rate > HIGHEST * (stiffness / mass) ** 0.5) | (np.arange(len(power)) < LOW)] = 0.0
    return [float(places[k]) for k in np.argsort(power)[::-1][:PEAKS] if power[k] > 0]
