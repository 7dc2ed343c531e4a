"""Gaps in the stamps of a record, and whether its values bear them out.

Samples that a logger lost are no fault of those that it kept: where their stamps stand, they are fitted at their
stamps. That asks two things of a gap. It must be whole steps of the clock, which a clock that jumps seldom makes; and
what was lost must follow from its neighbours, so that the motion within the gap is known, and inputs can be put across
it. How well it follows is tried where nothing was lost: a hole as long is filled by a cubic spline through the samples
beside it. Where more than a few were lost, the holes must be of a sample or two each, as rows that somebody took out,
and the values must have moved over them as long as the stamps say.

A clock that jumps by part of a step and a recorder that paused look alike in the stamps; the values tell them apart.
Where every step is another one, a program asked for the samples one by one and wrote down when: a long step is one
that came late, at its stamp, and the same two things are asked of it as of a gap; where there are gaps enough for the
values to tell, they may say that of a pause, and not that of a jump.
"""

from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from gear_damping.measurement.irregular_stamps import CLOCK_JUMPS, LOST, scatter
from gear_damping.measurement.record import Finding, Record
from gear_damping.measurement.timebase import counted

_GAP, _BESIDE, _FEWEST_GAPS = 1.5, 4, 5  # usual steps in a gap; samples at either side; gaps that a share is had from
_NEARER = 0.65  # of the way from a clock's jump to a pause
_ERRORS = 4.0  # standard errors that it must be beyond that by
_FOLLOWS = 0.1  # of a channel's standard deviation: what a spline may miss of what was lost
_NO_WORSE = 1.5  # times what it misses of a single sample: what is missed is noise then, and would be without a gap
_MOST_LOST = 0.02  # of the samples; beyond, another clock is as likely where the values do not tell
_MOST_SINGLE, _SINGLE = 0.1, 2  # of the samples in single holes, that a record may lack; samples in such a hole
_TWICE = 2.0  # standard errors that a share over single holes must be beyond that of a clock's jump by, which is 0
_SHORT = 2.5  # usual steps that a shift may last for the values not to have to tell: a lost sample, and jitter
_FEW_LONG = 0.01  # of the steps may be long where the values do not tell why
_LONGER = 0.05  # of a step, by which one must last longer to tell anything: rounding makes some longer by less
_FEWEST_HOLES = 20  # that can be tried in a record
_SUM = 16  # steps over which stamps wander, or do not: a few beside a record, and many beside one
_POLLED = 0.05  # of a step, by which steps scatter: the clock of a recorder keeps to a thousandth


def borne_out(record: Record) -> Record:
    """The record, whose gaps are notes where its values bear them out, with samples at their stamps."""
    findings = _pauses(_polled(_losses(record)))
    if findings == record.findings:
        return record
    mean = (len(record.time) - 1) / float(record.time[-1] - record.time[0])  # a grid of as many samples covers them all
    return replace(record, findings=findings, sampling_rate=mean)


def _losses(record: Record) -> Record:
    lost = [finding for finding in record.findings if finding.kind == LOST]
    if not lost:
        return record
    missing = np.diff(counted(record.time)) - 1
    if missing.sum() > _MOST_LOST * len(record.time) and not _are_single(record, missing):
        return record
    if not _all_follow(record, int(missing.max())):
        return record
    said = "which follow from their neighbours: samples are taken at their stamps"
    return replace(record, findings=tuple(
        replace(f, message=f"{f.message.partition(';')[0]}, {said}", severity="note") if f in lost else f
        for f in record.findings
    ))  # fmt: skip


def _are_single(record: Record, missing: NDArray[np.float64]) -> bool:
    """Whether holes are of a sample or two, a tenth of all at most, and values moved over them as long as stamps say.

    Args:
        record: With its stamps.
        missing: (n - 1,) samples that every step lacks.
    """
    if missing.max() > _SINGLE or missing.sum() > _MOST_SINGLE * len(record.time):
        return False
    shares = [share_over_gaps(channel.values, record.time) for channel in record.channels.values()]
    return any(abs(share - 1) + _TWICE * error < 1 for share, error in shares)


def _polled(record: Record) -> Record:
    """The record, with a note where a program asked for its samples, came late now and then, and little was missed."""
    late = [
        finding for finding in record.findings if finding.kind in (LOST, CLOCK_JUMPS) and finding.severity != "note"
    ]
    steps = np.diff(record.time)
    usual = float(np.median(steps))
    if not late or scatter(steps) < _POLLED * usual or not _wander(np.minimum(steps, _GAP * usual)):
        return record
    shares = [share_over_gaps(channel.values, record.time) for channel in record.channels.values()]
    told = [one for one in shares if one[1] < np.inf]  # by gaps enough
    if told and not (all(_may_be(1.0, one) for one in told) and any(not _may_be(0.0, one) for one in told)):
        return record
    missing = max(1, round(float(steps.max()) / usual) - 1)
    if not _all_follow(record, missing):
        return record
    message = (
        f"time steps from {steps.min():.4g} to {steps.max():.4g} s about a median of {usual:.4g} s, as of a program "
        "that asks for its samples and comes late now and then: samples are taken at their stamps"
    )
    note = Finding("uneven_stamps", message, channel="time", severity="note")
    return replace(record, findings=(*(f for f in record.findings if f not in late), note))


def _may_be(share: float, found: tuple[float, float]) -> bool:
    """Whether a share that was found, with its standard error, may be this one: 1 of a pause, 0 of a clock's jump."""
    return abs(found[0] - share) <= _ERRORS * found[1]


def _wander(steps: NDArray[np.float64]) -> bool:
    """Whether stamps wander away from an even grid, as those of steps that follow one another do.

    Over m steps the variance is m times that of one then, and once that of one where each stamp jitters about its own
    place on the grid: what is nearer to which.
    """
    over = np.cumsum(np.r_[0.0, steps])
    return steps.size > 2 * _SUM and float(np.var(over[_SUM:] - over[:-_SUM])) > _SUM**0.5 * float(np.var(steps))


def _all_follow(record: Record, lost: int) -> bool:
    """Whether every channel tells what was in a hole of `lost` samples."""
    return all(follows_from_neighbours(channel.values, lost) for channel in record.channels.values())


def follows_from_neighbours(values: NDArray[np.float64], lost: int) -> bool:
    """Whether a cubic spline through the samples beside a hole of `lost` samples tells what was there.

    Args:
        values: (n,) samples.
        lost: At least one.
    """
    if len(values) < 2 * _BESIDE + lost + _FEWEST_HOLES:
        return False
    spread = float(np.std(values))
    return spread == 0 or _missed(values, lost) <= max(_FOLLOWS * spread, _NO_WORSE * _missed(values, 1))


def _missed(values: NDArray[np.float64], lost: int) -> float:
    """Root mean square error in the middle of holes of so many samples, where nothing was lost."""
    beside = np.r_[0:_BESIDE, _BESIDE + lost : 2 * _BESIDE + lost]
    middle = _BESIDE + lost // 2
    weights = CubicSpline(beside, np.eye(2 * _BESIDE))(middle)
    windows = sliding_window_view(values, 2 * _BESIDE + lost)
    return float(np.sqrt(np.mean((windows[:, beside] @ weights - windows[:, middle]) ** 2)))


def _pauses(record: Record) -> tuple[Finding, ...]:
    """The findings of a record, where its clock jumps and its values moved as long only with a note of it.

    Over a pause of the recorder a value moves by its slope times the pause, over a jump of its clock by that of one
    step. The slope is that of lines through a few samples on either side. What no channel tells of shifts by a step and
    a half at most is a note too: half a step away is what jitter may be, and one more a lost sample.
    """
    jumps = [finding for finding in record.findings if finding.kind == CLOCK_JUMPS]
    shares = [share_over_gaps(c.values, record.time) for c in record.channels.values() if jumps]
    said = ""
    if any(_is_beyond(share, error) and _is_beyond(2 - share, error) for share, error in shares):
        said = "the recorder paused, and the values moved as long: samples are taken at their stamps"
    elif jumps and _are_short(record.time) and all(share + _ERRORS * error > _NEARER for share, error in shares):
        said = (
            "a few are long, and the values do not tell whether the recorder paused or its clock jumped: samples are "
            "taken at their stamps; where the clock jumped, give sampling_rate instead of the time column"
        )
    if not said:
        return record.findings
    note = {"kind": "uneven_stamps", "severity": "note"}
    return tuple(
        replace(f, message=f"{f.message.partition(': ')[0]}: {said}", **note) if f in jumps else f
        for f in record.findings
    )


def _is_beyond(share: float, error: float) -> bool:
    """Whether a share is clearly nearer to that of a pause than to that of a jump of the clock."""
    return share - _ERRORS * error > _NEARER


def _are_short(stamps: NDArray[np.float64]) -> bool:
    """Whether no step is as long as a lost sample makes two and a half, and few are long."""
    steps = np.diff(stamps)
    usual = float(np.median(steps))
    return bool(steps.max() < _SHORT * usual) and np.mean(steps > _GAP * usual) <= _FEW_LONG


def share_over_gaps(values: NDArray[np.float64], stamps: NDArray[np.float64]) -> tuple[float, float]:
    """The share over which values moved of what gaps last beyond a usual step, and its standard error.

    It is 1 where the recorder paused, and 0 where its clock jumped. The error is infinite of few gaps.

    Args:
        values: (n,) samples.
        stamps: (n,) their stamps in s.
    """
    steps = np.diff(stamps)
    usual, gaps = float(np.median(steps)), _lasting(steps)
    apart = np.diff(np.r_[-_BESIDE, gaps, stamps.size - 1 + _BESIDE]) >= _BESIDE  # no other gap within either side
    gaps = gaps[apart[:-1] & apart[1:] & (gaps >= _BESIDE - 1) & (gaps + _BESIDE < stamps.size)]
    if gaps.size < _FEWEST_GAPS:
        return 1.0, np.inf
    rows = np.array([_moved_beyond(values, stamps, k, usual) for k in gaps])
    due, seen, unsure = rows.T
    known = float(due @ due - unsure @ unsure)  # slopes of noise alone would make every share small
    if known <= 0:
        return 1.0, np.inf
    share = 1 - float(due @ seen) / known
    return share, float(np.sqrt(np.sum((due * (seen - (1 - share) * due)) ** 2))) / known


def _moved_beyond(values: NDArray, stamps: NDArray, k: int, usual: float) -> tuple[float, float, float]:
    """How much values moved less over the gap behind sample k than their slope says.

    First what a jump of the clock makes of it, then what is seen, then the standard error of the former: by a parabola
    through the samples on both sides, with a step between these.
    """
    around = slice(k + 1 - _BESIDE, k + 1 + _BESIDE)
    time = stamps[around] - (stamps[k] + stamps[k + 1]) / 2
    terms = np.column_stack([time**2, time, np.ones_like(time), time > 0])
    found = np.linalg.lstsq(terms, values[around], rcond=None)[0]
    left = values[around] - terms @ found
    variance = float(left @ left) / (len(time) - terms.shape[1]) * np.linalg.inv(terms.T @ terms)[1, 1]
    longer = stamps[k + 1] - stamps[k] - usual
    return longer * found[1], -found[3], longer * float(np.sqrt(variance))


def _lasting(steps: NDArray[np.float64]) -> NDArray[np.int_]:
    """The places of steps that are longer than usual, and that the next ones do not make good."""
    usual = float(np.median(steps))
    longer = max(_LONGER * usual, _ERRORS * scatter(steps))
    next_ones = np.r_[steps[1:], usual] - usual
    return np.flatnonzero((steps - usual > longer) & (steps - usual + next_ones > longer))
