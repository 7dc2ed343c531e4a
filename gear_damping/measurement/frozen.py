"""Stretches over which a channel keeps its last value although the motion went on.

A tracker that loses its mark, a logger whose link breaks and a converter that hangs write the last value again, and
leap to where the motion has got to once they are back. Where values are fine enough that they hardly ever repeat, five
of the same in a row are no chance; and a motion that really stood, as friction may hold it, begins again with small
steps.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.record import Channel, Finding
from gear_damping.measurement.vocabulary import INPUTS

_REPEATS = 5  # of a value in a row, from which it is held: at a share of zeros as below, one chance in 3e11 a sample
_HELD = 5e-3  # share of the other steps that are zero, from which values are coarse and repeat by themselves
_BESIDE = 50  # steps on either side that say how fast the motion was
MOSTLY = 0.5  # share of the stretches that leap, where a motion was lost; else values are renewed slowly throughout
_EIGHTH = 8  # part of what moves, before it is kept, that says how much is moving yet
_STILL = 0.05  # of the whole range: what a motion that has died away still moves over
_LEAP = 0.5  # times what it moves over as many usual steps: less is how a motion begins again


def frozen(channel: Channel) -> Finding | None:
    """A finding where a response keeps its value and leaps out of it, or keeps its last one; its first is a rest."""
    if channel.name in INPUTS:
        return None
    stretches = _stretches(channel.values)
    if not stretches:
        return _stopped(channel)
    count, (first, last) = sum(last - first for first, last in stretches), stretches[0]
    message = (
        f"{channel.name} keeps its value over {len(stretches)} stretch(es) of {_REPEATS} or more samples and leaps out "
        f"of them, the first at samples {first} to {last}, {count} samples in all: a tracker, a link or a converter "
        "lost the motion there; use slices or windows between them"
    )
    return Finding("frozen", message, channel=channel.name, sample=first)


def _stopped(channel: Channel) -> Finding | None:
    """A finding where a response keeps one value to the end that the motion before did not come to rest at."""
    values = channel.values
    steps = np.diff(values)
    moving = np.flatnonzero(steps)
    first = int(moving[-1]) + 1 if moving.size else 0  # the sample from which on nothing moves
    before = np.abs(steps[max(first - 1 - _BESIDE, 0) : first - 1])
    kept = values.size - first
    if kept < _REPEATS or not np.any(before) or np.mean(steps[:first] == 0) > _HELD:
        return None
    if abs(steps[first - 1]) < _LEAP * float(np.median(before[before > 0])):
        return None  # slower and slower, as friction brings a motion to rest
    if np.ptp(values[first - first // _EIGHTH : first + 1]) < _STILL * np.ptp(values):
        return None  # it had died away, and friction may hold it wherever it was
    message = (
        f"{channel.name} keeps one value over its last {kept} samples, at which the motion before did not come to "
        f"rest: a buffer was filled up, or the sensor was lost; end the record with slice: [0, {first}] or a window"
    )
    return Finding("frozen", message, channel=channel.name, sample=first)


def stays(at: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """First and last place of each run of places where something holds."""
    edges = np.flatnonzero(np.diff(np.r_[0, at.astype(int), 0]))
    yield from zip(edges[::2].tolist(), (edges[1::2] - 1).tolist(), strict=True)


def _stretches(values: NDArray[np.float64]) -> list[tuple[int, int]]:
    """First and last sample of each; none where values repeat elsewhere too."""
    steps = np.diff(values)
    runs = [(first, last + 1) for first, last in stays(steps == 0) if last + 1 - first >= _REPEATS]
    elsewhere = np.count_nonzero(steps == 0) - sum(b - a for a, b in runs)
    if not runs or elsewhere > _HELD * steps.size:
        return []
    inside = [(a, b) for a, b in runs if a > 0 and b < steps.size]
    leapt = [(a, b) for a, b in inside if _leaps(steps, a, b)]
    return leapt if MOSTLY * len(inside) < len(leapt) else []


def _leaps(steps: NDArray[np.float64], first: int, last: int) -> bool:
    """Whether the step behind a stretch is as long as what the motion beside it had done meanwhile."""
    beside = np.concatenate([steps[max(first - _BESIDE, 0) : first], steps[last + 1 : last + 1 + _BESIDE]])
    usual = float(np.median(np.abs(beside[beside != 0]))) if np.any(beside) else 0.0
    return bool(0 < _LEAP * (last - first) * usual < abs(steps[last]))
