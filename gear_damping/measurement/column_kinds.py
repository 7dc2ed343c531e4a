"""What a column looks like: constant, an angle that turns, a counter, a pulse train, or a plain signal."""

import re

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.angular_error import turn_in

TIME, CONSTANT, EMPTY, UNREADABLE, TURNING, COUNTER, PULSES, SIGNAL, ROW_NUMBER, ELSEWHERE, EDGES = (
    "time stamps", "constant", "empty", "not readable", "turning angle", "counter", "pulses", "signal", "row number",
    "another record", "times of pulses",
)  # fmt: skip
ANGLE = re.compile(r"angle|winkel|[aáâ]ngulo|angolo|theta|phi|phase|encoder|azimuth|rotation|revol|position", re.I)
MOTION = re.compile(r"accel|veloc|displac|force|torque", re.I)  # what bears such a name is no pulse train
_LEVELS, _AT_LEVEL, _FEWEST_PULSES = 0.15, 0.95, 4  # of the range; of the samples; rises
_OFTEN, _HALF_WAY = 0.2, 0.5  # of the samples, at the rarer level; of those between the levels, that turn back
_ALIKE = 0.25  # of an interval between pulses, how far the next may differ; at random a quarter of the pairs keep it
_FEWEST_JUMPS, _ONE_WAY, _COARSE = 2, 0.9, 50  # wraps; of the steps; steps that a direction is seen by
_BEYOND = 1.5  # times the way gone that an angle's range may be: a swing goes to and fro within it
_TURNS = {"rad": 2 * np.pi, "deg": 360.0, "rev": 1.0}  # one turn in each unit that an angle is written in
_FEWEST_PLACES = 8  # of a turn, assumed: what has fewer values is switched, and no angle
_NUMBERED = {"sample", "frame", "index", "idx", "row", "seq", "sequence", "packet"}  # what is numbered, and no shaft
_NUMBER_OF = {"no", "nr", "num", "number", "id"}  # words behind these
_WORDS = re.compile(r"[\W_]+|(?<=[a-z])(?=[A-Z])")  # what is between those of a name
_FEWEST_EDGES = 16  # values that rise, of another number than the samples: fewer may be a list of settings
_EVENLY = 1e-6  # of a step: as the rounding of an axis, and less than the pulses of any shaft differ
_NEAR_TURN = 0.03  # of a turn: a ramp that ends so near to it wraps there


def kind_of(values: NDArray[np.float64], name: str, unit: str | None) -> tuple[str, str]:
    """The kind of a column, and what it was seen by.

    Args:
        values: (n,) finite samples.
        name: Its name.
        unit: Its unit where the file says it.
    """
    if not values.size:
        return EMPTY, "no finite value"
    if np.ptp(values) == 0:
        return CONSTANT, f"every sample is {values[0]:.6g}"
    if unit is None and not ANGLE.search(name) and counts_rows(values):
        return ROW_NUMBER, f"counts the rows from {values[0]:.0f} on"
    if _numbers_samples(values, name):
        return ROW_NUMBER, f"numbers the samples, in steps of {np.median(np.diff(values)):.0f}"
    for kind in (_pulses, _wrapping, _advancing):
        found = kind(values, name, unit)
        if found is not None:
            return found
    return SIGNAL, ""


def may_be_edges(values: NDArray[np.float64]) -> bool:
    """Whether (n,) values, of which there are not as many as samples, rise at each, as the times of a shaft's pulses.

    What goes on by one step is an axis, or numbers something.
    """
    steps = np.diff(values)
    rises_at_each = values.size >= _FEWEST_EDGES and bool(np.all(steps > 0))
    return rises_at_each and bool(np.ptp(steps) > _EVENLY * np.median(steps))


def counts_rows(values: NDArray[np.float64]) -> bool:
    """Whether (n,) values are whole numbers that go on by 1 from row to row."""
    return values.size > 1 and values[0] == round(values[0]) and bool(np.all(np.diff(values) == 1))


def _numbers_samples(values: NDArray[np.float64], name: str) -> bool:
    """Whether (n,) values are whole numbers that rise, mostly by one step, under the name of frames or samples.

    What stands in brackets behind such a name, `loggingSample(N)`, is its symbol.
    """
    words = [word.lower() for word in _WORDS.split(re.sub(r"[(\[].*$", "", name)) if word]
    while len(words) > 1 and words[-1] in _NUMBER_OF:
        words.pop()
    if not words or not {words[-1], words[-1].removesuffix("s")} & _NUMBERED or values.size < _FEWEST_PLACES:
        return False
    steps = np.diff(values)
    is_rising = bool(np.all(values == np.round(values)) and steps.min() > 0)
    return is_rising and bool(np.mean(steps == np.median(steps)) > _ONE_WAY)


def turn_of(values: NDArray[np.float64]) -> float | None:
    """The height that an angle falls back by at each turn, None where the column is no sawtooth."""
    steps, span = np.diff(values), float(np.ptp(values))
    back = np.abs(steps) > span / 2
    if not _FEWEST_JUMPS <= back.sum() <= steps.size / 4 or np.unique(values).size < _FEWEST_PLACES:
        return None
    jumps, forth = steps[back], steps[~back]
    direction = -np.sign(jumps[0])
    if np.any(np.sign(jumps) == direction) or np.mean(forth * direction >= 0) < _ONE_WAY:
        return None
    return float(np.median(np.abs(jumps)) + np.median(np.abs(forth)))


def unit_of_turn(turn: float) -> str | None:
    """The unit in which a turn has a height, None where it is none of a plain angle."""
    return next((unit for unit, one in _TURNS.items() if abs(turn / one - 1) < _NEAR_TURN), None)


def counts_of_turn(values: NDArray[np.float64]) -> int | None:
    """The counts of a turn of a counter that begins again with each; None of anything else, an angle in a unit too."""
    turn = turn_of(values)
    if turn is None or unit_of_turn(turn) or not np.all(values == np.round(values)):
        return None
    return round(turn)


def rises(high: NDArray[np.bool_]) -> NDArray[np.intp]:
    """(m,) the last samples before (n,) a series becomes high."""
    return np.flatnonzero(high[1:] & ~high[:-1])


def _pulses(values: NDArray, name: str, unit: str | None) -> tuple[str, str] | None:
    low, span = float(values.min()), float(np.ptp(values))
    high = values > low + span / 2
    at = np.minimum(np.abs(values - low), np.abs(values - low - span)) < _LEVELS * span
    begun = rises(high).size
    if MOTION.search(name):
        return None
    if begun < _FEWEST_PULSES or np.mean(at) < _AT_LEVEL or _switches_partly(high, at) or _flickers(high):
        return None
    if _rests_between(values[~at]):
        return None
    return PULSES, f"two levels, {low:.4g} and {low + span:.4g}, with {begun} rises"


def _switches_partly(high: NDArray[np.bool_], at: NDArray[np.bool_]) -> bool:
    """Whether a series often turns back half way between its levels, as a switched current; pulses reach the other one.

    Args:
        high: (n,) Whether a sample lies in the upper half of the range.
        at: (n,) Whether it lies at one of the two levels.
    """
    before, between, after = at[:-2], ~at[1:-1], at[2:]
    back = between & before & after & (high[:-2] == high[2:])
    rarer = min(np.mean(high), 1 - np.mean(high))
    return bool(rarer > _OFTEN and back.sum() >= max(_FEWEST_PULSES, _HALF_WAY * between.sum()))


def _rests_between(values: NDArray[np.float64]) -> bool:
    """Whether (n,) samples that lie at neither level are mostly of one value, as a drive's that is off at times."""
    _, often = np.unique(values, return_counts=True)
    return values.size >= _FEWEST_PULSES and bool(often.max() > _HALF_WAY * values.size)


def _flickers(high: NDArray[np.bool_]) -> bool:
    """Whether a series goes to and fro at random, as a still sensor about the edge of a count; a shaft hardly changes
    its speed from one pulse to the next.

    Args:
        high: (n,) Whether a sample lies in the upper half of the range.
    """
    apart = np.diff(rises(high))
    if apart.size <= _FEWEST_PULSES:
        return False
    alike = np.abs(np.diff(apart)) <= np.maximum(1, _ALIKE * apart[:-1])
    return bool(np.mean(alike) < _HALF_WAY)


def _wrapping(values: NDArray, name: str, unit: str | None) -> tuple[str, str] | None:
    turn = turn_of(values)
    if turn is None:
        return None
    unit = unit_of_turn(turn)
    jumps = int(np.sum(np.abs(np.diff(values)) > np.ptp(values) / 2))
    return TURNING, f"a sawtooth that falls back by {turn:.5g} {unit or ''}".rstrip() + f", {jumps} times"


def _advancing(values: NDArray, name: str, unit: str | None) -> tuple[str, str] | None:
    """A counter, or an angle that goes on for a turn and more; one way, apart from its noise."""
    coarse = np.diff(values[:: max(1, values.size // _COARSE)])
    if max(np.mean(coarse > 0), np.mean(coarse < 0)) < _ONE_WAY or coarse.size < _FEWEST_PULSES:
        return None
    gone = float(abs(values[-1] - values[0]))
    if np.ptp(values) > _BEYOND * gone:
        return None  # a swing whose period the coarse steps have
    turn = turn_in(unit)
    if turn is None and np.all(values == np.round(values)) and gone >= _COARSE:
        return COUNTER, f"whole numbers that advance by {gone:.0f}"
    if gone > (turn or _TURNS["rad"]) and (turn is not None or (unit is None and ANGLE.search(name))):
        turns = f", by {gone / turn:.4g} turns" if turn else ""
        return TURNING, f"advances one way{turns}"
    return None
