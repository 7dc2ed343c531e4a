"""Whether a flat top of a response is clipping, or where the motion itself stood.

A plateau at an extreme is clipping where the samples about it say that the signal would have gone on. An analog
signal never returns to the very same extreme, and a noisy or fast one is spread over the levels below it, so that
two visits are proof. An encoder or a coarse converter holds values elsewhere too, and stands longest where the motion
turns; there, a parabola through the samples before the plateau and one through those behind it must both lead beyond
it by more than a step and a half of the values. A parabola that turns within a step is a turning point, however long
friction held it there.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.resolution import step_of

_SAMPLES, _SHARE, _RATIO = 5, 1e-3, 6  # at the extreme: at least, of all samples, times those at the level beside it
_HELD = 5e-3  # share of steps that are zero elsewhere, from which a signal holds its values
_RESTLESS = 0.2  # share of moves against the one before, from which noise or a fast signal crosses many levels
_LEAST, _MOST = 8, 200  # samples that a parabola is laid through
_TRAVEL = 16.0  # steps of its values that the signal must have moved through over these samples
_HOLDS = 0.1  # share of them that repeat the one before, from which the values are coarse
_JUMP = 5.0  # steps of the signal; an extreme reached by a larger one was jumped to
_BEYOND = 0.5  # share of the samples at the extreme that must stand in plateaus that were cut


def clipped_at(values: NDArray[np.float64]) -> tuple[str, NDArray[np.bool_]] | None:
    """The extreme that a response was clipped at, `minimum` or `maximum`, and the samples there; None for neither."""
    for name, outward in (("minimum", -values), ("maximum", values)):
        at = outward == outward.max()
        if _stands(outward, at) and _would_go_on(outward, at):
            return name, at
    return None


def _stands(outward: NDArray, at: NDArray) -> bool:
    """Many samples exactly at the extreme, some of them in a row, and few at the level beside it."""
    count = int(at.sum())
    if count < max(_SAMPLES, _SHARE * at.size) or count == at.size or not np.any(at[1:] & at[:-1]):
        return False
    inside = outward[~at]
    return count > _RATIO * int(np.sum(inside >= inside.max() * (1 - 1e-9 * np.sign(inside.max()))))


def _would_go_on(outward: NDArray, at: NDArray) -> bool:
    steps = np.diff(outward)
    elsewhere = ~(at[1:] & at[:-1])
    held = float(np.mean(steps[elsewhere] == 0))
    plateaus = list(_plateaus(at))
    lengths = [last + 1 - first for first, last in plateaus]
    moves = np.sign(steps[steps != 0])
    restless = np.sum(moves[1:] != moves[:-1]) > _RESTLESS * moves.size
    if sum(length > 1 for length in lengths) > 1 and (restless or (held < _HELD and np.median(lengths) < _LEAST)):
        return True
    step = max(step_of(outward), _held_step(outward, at)) if held >= _HELD else step_of(outward)
    cut = [length for length, plateau in zip(lengths, plateaus, strict=True) if _cut(outward, *plateau, step)]
    return sum(cut) > _BEYOND * int(at.sum())


def _held_step(outward: NDArray, at: NDArray) -> float:
    """What lies between the levels that are held: the step of coarse values that were interpolated afterwards."""
    held = np.unique(outward[1:][(np.diff(outward) == 0) & ~at[1:]])
    return float(np.quantile(np.diff(held), 0.25)) if held.size > 1 else 0.0


def _plateaus(at: NDArray) -> Iterator[tuple[int, int]]:
    """First and last sample of each stay."""
    edges = np.flatnonzero(np.diff(np.r_[0, at.astype(int), 0]))
    yield from zip(edges[::2].tolist(), (edges[1::2] - 1).tolist(), strict=True)


def _cut(outward: NDArray, first: int, last: int, step: float) -> bool:
    """Whether both sides of a plateau lead beyond it; at the end of a record the side that there is decides.

    A record may begin at rest, from where a force moves it off at once: that is nothing to judge by.
    """
    length = last + 1 - first
    before, behind = outward[max(0, first - _MOST) : first], outward[last + 1 : last + 1 + _MOST][::-1]
    if before.size < _LEAST:
        return False
    leads = _leads_beyond(before, outward[first], length, step)
    return leads and (behind.size < _LEAST or _leads_beyond(behind, outward[first], length, step))


def _leads_beyond(side: NDArray, top: float, length: int, step: float) -> bool:
    """Whether samples before a plateau at `top` lead more than a step and a half beyond it within half its length."""
    side = side[-_reach(side, length // 2) :]
    moves = np.abs(np.diff(side))
    if top - side[-1] > _JUMP * float(moves.max()) > 0:
        return True
    bend, slope, height = np.polyfit(np.arange(1 - side.size, 1), side, 2)
    if slope <= 0:
        return False
    turn = -slope / (2 * bend) if bend < 0 else np.inf
    ahead = min(turn, (length + 1) / 2)
    return bool(height + slope * ahead + bend * ahead**2 - top > max(1.5 * step, 2 * abs(bend)))


def _reach(side: NDArray, least: int) -> int:
    """How many samples next to a plateau are enough: coarse values that repeat must move through several steps."""
    reach = max(_LEAST, least)
    while reach < side.size:
        moves = np.abs(np.diff(side[-reach:]))
        moving, way = moves[moves > 0], np.ptp(side[-reach:])
        if moving.size and (moving.size >= (1 - _HOLDS) * moves.size or way >= _TRAVEL * np.median(moving)):
            break
        reach += reach // 2
    return min(reach, side.size)
