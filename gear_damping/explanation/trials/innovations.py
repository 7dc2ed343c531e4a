"""The random load's part of residuals: how the free motion about the fitted one goes on, record by record."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from gear_damping.explanation.model.hypothesis import Outcome, natural_frequency_hz
from gear_damping.explanation.model.linear import linear_of
from gear_damping.explanation.statistics.load_error import KnownError, Linear, LoadError, load_error, moved_by
from gear_damping.explanation.statistics.load_noise import (
    MEMORY,
    Array,
    LoadNoise,
    Recurrence,
    drive_correlation,
    load_noise,
    recurrence,
)
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.segments import part
from gear_damping.physics.systems.swinging import BASE, FORCE

SEGMENT = 3.0  # natural periods that the free motion is followed over: it must not have died away
FEWEST = 6  # samples of a segment, which two states of its own are fitted to


@dataclass(frozen=True)
class RandomLoad:
    """What is known of how a random load moves a record.

    Args:
        motion: How its free motion goes on; None where that is not known.
        error: What is known beforehand of the error of its load; None where that has none.
    """

    motion: Recurrence | None
    error: KnownError | None

    def part(self, residual: Array) -> LoadNoise | LoadError:
        """The random load's part of a residual (time,): a white one of any size, or the known error, if likelier."""
        found: list[LoadNoise | LoadError] = []
        if self.motion is not None:
            found.append(load_noise(residual[: len(self.motion.first) + MEMORY], self.motion))
        if self.error is not None:
            found.append(load_error(residual[: len(self.error.stamps)], self.error))
        return min(found, key=lambda part: part.deviance)


def random_loads(outcome: Outcome) -> list[RandomLoad] | None:
    """How a random load moves the first channel of each record of the problem; None where that is not known."""
    records = outcome.problem.records
    motions, errors = recurrences(outcome), [known_error(record, outcome) for record in records]
    if motions is None:
        return None if any(error is None for error in errors) else [RandomLoad(None, error) for error in errors]
    return [RandomLoad(*pair) for pair in zip(motions, errors, strict=True)]


def load_errors(outcome: Outcome, records: Sequence[FitRecord]) -> dict[str, float]:
    """Variance, unweighted, that the known error of a load adds to the first channel of records that have one."""
    found = {record.name: known_error(replace(record, weight=1.0), outcome) for record in records}
    return {name: float(error.motion[0]) for name, error in found.items() if error is not None}


def known_error(record: FitRecord, outcome: Outcome) -> KnownError | None:
    """The error of the loads of an oscillator's record as its weighed residual sees it; None where there is none.

    None, too, where several channels respond or the motion of the base with them, or where more than a displacement
    and its velocity goes on.
    """
    problem, values = outcome.problem, {**outcome.flat_given(), **outcome.values}
    if not record.input_errors or not _is_one_motion(problem) or record.observed.absolute:  # with the base in it
        return None
    mass, damping, stiffness = linear_of(outcome)
    if stiffness <= 0 or damping <= 0:  # nothing holds its motion, which grows
        return None
    factors = {FORCE: values.get(outcome.hypothesis.system.gains.get(FORCE), 1.0), BASE: -mass}
    if not {*record.input_errors} <= {*factors}:
        return None
    errors = [factors[name] ** 2 * error.numpy() for name, error in record.input_errors.items()]
    seen, interval = Linear(mass, damping, stiffness, record.observed.derivatives), 1 / record.sampling_rate
    motion, step = moved_by(record.weight**2 * sum(errors), seen, interval)
    return KnownError(interval * record.instants.numpy(), motion, step, problem.noise**2)


def _is_one_motion(problem: OutputErrorProblem) -> bool:
    """Whether one channel shows a displacement and its velocity and nothing that goes on beside them."""
    return not (problem.extra or problem.response.modes or len(problem.response.channels) > 1)


def recurrences(outcome: Outcome) -> list[Recurrence] | None:
    """How the free motion of the first channel goes on in each record of the problem.

    None where more than displacement and velocity goes on (a further mode, a filter), where samples are not even, or
    where several channels respond, whose random parts hang together.
    """
    problem = outcome.problem
    even = all(record.stamps is None for record in problem.records)
    if not (even and _is_one_motion(problem)):
        return None
    mass, damping, stiffness = linear_of(outcome)
    if stiffness <= 0:
        return None
    columns, found = _free_motion(outcome), []
    for record, shown in zip(problem.records, columns, strict=True):
        order = record.observed.derivatives
        correlation = drive_correlation(mass, damping, stiffness, 1 / record.sampling_rate, order)
        pairs = [recurrence(one.numpy()) for one in shown]
        first, second = (torch.cat([torch.as_tensor(pair[k]) for pair in pairs]).numpy() for k in (0, 1))
        found.append(Recurrence(first, second, correlation))
    return found


def _free_motion(outcome: Outcome) -> list[list[Tensor]]:
    """What the first channel shows of two free motions, (time, 2), of each record segment by segment.

    A segment begins two samples before the last one ends: its first two tell how the third follows.
    """
    problem, hypothesis = outcome.problem, outcome.hypothesis
    shared, states = outcome.fitted.shared, outcome.fitted.states
    period = 1 / natural_frequency_hz(hypothesis.model, outcome.flat_given())
    motion = problem.motion(shared, states)
    segmented: list[FitRecord] = []
    starts, counts = [], []
    for record, path in zip(problem.records, motion, strict=True):
        length = max(FEWEST, round(SEGMENT * period * record.sampling_rate))
        begins = list(range(0, len(record.response) - 2, length - 2))
        segmented += [part(record, slice(at, min(at + length, len(record.response)))) for at in begins]
        starts += [path[:, at] for at in begins]
        counts.append(len(begins))
    given = {**hypothesis.given, **hypothesis.gains}
    short = OutputErrorProblem(hypothesis.model, given, hypothesis.free, segmented, problem.solver, problem.noise)
    initial = torch.zeros(1, len(segmented), len(short.local), dtype=torch.float64)
    initial[0, :, :2] = torch.stack(starts) / short.scales[:, :2]
    settled = short.unknowns.own_of(problem.unknowns, shared).unsqueeze(0)
    found = short.linearise(settled, initial, only=[]).sensitivity[0][..., short.n_shared :]
    cut = iter([one[: len(segment.response), :2] for one, segment in zip(found, segmented, strict=True)])
    return [[next(cut) for _ in range(count)] for count in counts]
