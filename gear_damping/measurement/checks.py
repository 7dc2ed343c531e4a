"""What makes the values of a channel unreadable (InputError) or suspicious (Finding).

A flat top of a response is clipping, or where the motion itself stood. A plateau at an extreme is clipping where the
samples about it say that the signal would have gone on. An analog signal never returns to the very same extreme, and a
noisy or fast one is spread over the levels below it, so that two visits are proof. An encoder or a coarse converter
holds values elsewhere too, and stands longest where the motion turns; there, a parabola through the samples before the
plateau and one through those behind it must both lead beyond it by more than a step and a half of the values. A
parabola that turns within a step is a turning point, however long friction held it there.
"""

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.cut_flanks import is_cut
from gear_damping.measurement.frozen import frozen, stays
from gear_damping.measurement.out_of_range import CONTINUOUS, out_of_range
from gear_damping.measurement.overflow import overflowed
from gear_damping.measurement.record import Channel, Finding
from gear_damping.measurement.resolution import step_of
from gear_damping.measurement.staircase import runs_of
from gear_damping.measurement.vocabulary import INPUTS
from gear_damping.units import behind

_SAMPLES, _SHARE, _RATIO = 5, 1e-3, 6  # at the extreme: at least, of all samples, times those at the level beside it
_HELD = 5e-3  # share of steps that are zero elsewhere, from which a signal holds its values
_MOSTLY_HELD, _NINE_OF_TEN = 0.5, 0.9  # share of steps that are zero, from which every value stays; of its stays
_RESTLESS = 0.2  # share of moves against the one before, from which noise or a fast signal crosses many levels
_LEAST, _MOST = 8, 200  # samples that a parabola is laid through
_NEAR, _LEAST_NEAR = 4, 32  # part of them next to a plateau, and samples of it at least
_TRAVEL = 16.0  # steps of its values that the signal must have moved through over these samples
_HOLDS = 0.1  # share of them that repeat the one before, from which the values are coarse
_JUMP = 5.0  # steps of the signal; an extreme reached by a larger one was jumped to
_NEAR_RANGE = 0.9  # of it, from which a value that stands at its extreme was cut there: ranges are nominal
_AT_RANGE = 0.999  # of a sensor's range, from which a value is at its end
_BEYOND_RANGE = 1.1  # of it: converters go on for some per cent beyond what they are called by
_BEYOND = 0.5  # share of the samples at the extreme that must stand in plateaus that were cut
_BEND, _BENT_SHARE, _FEWEST_BENDS = 1e-4, 0.6, 10  # of the largest bend; of the samples; in a record
_FEWEST_MARKS, _MOST_MARKED = 3, 0.1  # samples of one value; share of all
_WITH_A_STROKE = 5  # samples between an input's largest value and a leap that it made
STRUCK = ("force", "base_acceleration")  # which one blow may make
_LONE = 5.0  # times as far from the median as any other sample
_ABOUT = 5  # samples whose median a single wrong one leaves as it is
_STRETCH = 101  # samples by whose steps it is seen how wrong it is
_STRAY = 12.0  # usual steps away; the largest of a sine of 4 samples a period is 1.4, of a million of noise 7
_ALONE = 3.0  # times what its two neighbours differ by
_LEAST_STRAY = 0.1  # of the deviation of all values, below which one tells nothing
_MOST_STRAYS = 0.01  # of the samples; more are no single ones
_LISTED = 5  # of them in a message
_SPEEDS = ("velocity", "pinion_speed", "gear_speed")
TURNING = ("pinion_angle", "pinion_speed")  # that a shaft turns
APPLIED = (*INPUTS, *TURNING)  # what drives the system


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
    plateaus = list(stays(at))
    lengths = [last + 1 - first for first, last in plateaus]
    moves = np.sign(steps[steps != 0])
    restless = np.sum(moves[1:] != moves[:-1]) > _RESTLESS * moves.size
    usual = _usual_stay(outward[~at]) if held >= _MOSTLY_HELD else 1.0
    if sum(length > usual for length in lengths) > 1 and (restless or (held < _HELD and np.median(lengths) < _LEAST)):
        return True
    step = max(step_of(outward), _held_step(outward, at)) if held >= _HELD else step_of(outward)
    cut = [length for length, plateau in zip(lengths, plateaus, strict=True) if _cut(outward, *plateau, step)]
    if sum(cut) > _BEYOND * int(at.sum()):
        return True
    bent = [length for length, plateau in zip(lengths, plateaus, strict=True) if _is_bent(outward, *plateau, step)]
    return sum(bent) > _BEYOND * at.sum()


def _usual_stay(values: NDArray) -> float:
    """Samples for which a value stays that a logger reads more often than it is measured: nine of ten at most."""
    return float(np.quantile(runs_of(values), _NINE_OF_TEN))


def _is_bent(outward: NDArray, first: int, last: int, step: float) -> bool:
    """Whether the motion beside a plateau bends beyond it; none at the beginning, where a drive may move what rests."""
    return first >= _LEAST and is_cut(outward, first, last, step)


def _held_step(outward: NDArray, at: NDArray) -> float:
    """What lies between the levels that are held: the step of coarse values that were interpolated afterwards."""
    held = np.unique(outward[1:][(np.diff(outward) == 0) & ~at[1:]])
    return float(np.quantile(np.diff(held), 0.25)) if held.size > 1 else 0.0


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
    """Whether samples before a plateau at `top` lead more than a step and a half beyond it within half its length.

    So do those next to it alone: what comes to rest there, as a drive that sticks, slows down at last.
    """
    reach = _reach(side, length // 2)
    near = _reach(side, reach // _NEAR)
    return all(_goes_beyond(side[-count:], top, length, step) for count in {reach, max(near, _LEAST_NEAR)})


def _goes_beyond(side: NDArray, top: float, length: int, step: float) -> bool:
    """The same of all these samples, by the parabola through them."""
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


def refuse_not_finite(values: NDArray[np.float64], key: str, source: str, first: int = 0) -> None:
    """Raise InputError naming the first sample that is NaN or infinite; `first` is the row of sample 0."""
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        longest = max(map(len, np.split(bad, np.flatnonzero(np.diff(bad) > 1) + 1)))
        rule = f"{bad.size} value(s) are not finite, the first at sample {bad[0] + first}"
        rule += f", up to {longest} in a row" if longest > 1 else ""
        remedy = "use slices that leave them out"
        remedy = remedy if bad.size < values.size else f"{remedy}, name another column, or leave it out"
        raise InputError(Problem(key, rule, remedy=remedy, source=source))


def check_channel(channel: Channel, strokes: NDArray[np.int64]) -> list[Finding | None]:
    """What is suspicious in the values of a channel.

    Args:
        channel: The channel.
        strokes: Samples at which an input is largest: a hammer's blow, with which a response may leap.
    """
    marked = _marked(channel)
    found = [
        marked or _constant(channel) or _clipped(channel) or out_of_range(channel) or _straight_lines(channel),
        frozen(channel),
        overflowed(channel),
    ]
    if marked or channel.name in STRUCK:
        return found
    spike = _spike(channel, strokes)
    return [*found, spike or _strays(channel)]


def _constant(channel: Channel) -> Finding | None:
    if np.ptp(channel.values) > 0:
        return None
    driven = channel.name in INPUTS or channel.name == "pinion_speed"
    message = f"every sample of {channel.name} is {channel.values[0]:.6g}{behind(channel.unit)}"
    message += "" if driven else "; check the cable and the column"
    severity = "note" if driven else "data_problem"
    return Finding("constant_channel", message, channel=channel.name, severity=severity)


def _marked(channel: Channel) -> Finding | None:
    """A value far from all others that comes back exactly: what a logger writes where it has none (-9999)."""
    values, away = channel.values, np.abs(channel.values - np.median(channel.values))
    at = values == values[np.argmax(away)]
    count = int(at.sum())
    if not _FEWEST_MARKS <= count < _MOST_MARKED * at.size or away.max() < _LONE * away[~at].max():
        return None
    where = int(np.argmax(at))
    if channel.name in INPUTS and values[where] == 0 and _is_one_end(at):  # not switched on yet, or off again
        return None
    message = (
        f"{channel.name} is {values[where]:.6g}{behind(channel.unit)} at {count} samples, the first at {where}, and "
        "nowhere else near it: a mark for a missing value; put what was measured there, or use slices beside it"
    )
    return Finding("marked_values", message, channel=channel.name, sample=where)


def _is_one_end(at: NDArray[np.bool_]) -> bool:
    """Whether some samples are all those of the beginning, or all those of the end."""
    return bool((at[0] or at[-1]) and np.count_nonzero(np.diff(at)) == 1)


def _spike(channel: Channel, strokes: NDArray[np.int64]) -> Finding | None:
    """One sample, or two, that lie many times as far from the rest as any other: no motion does that by itself."""
    away = np.abs(channel.values - np.median(channel.values))
    most = np.argpartition(away, -3)[-3:] if away.size > 3 else np.arange(away.size)
    order = most[np.argsort(away[most])[::-1]]
    lone = next((k for k in (1, 2) if away.size > 10 * k and away[order[k - 1]] > _LONE * away[order[k]] > 0), 0)
    if not lone:
        return None
    places = np.sort(order[:lone])
    if strokes.size and np.min(np.abs(places[:, None] - strokes)) <= _WITH_A_STROKE:
        return None
    message = (
        f"{channel.name} is {channel.values[places[0]]:.4g}{behind(channel.unit)} at sample {places[0]}, "
        f"{away[order[lone - 1]] / away[order[lone]]:.3g} times as far from its median as any other sample: a fault of "
        "the transmission or of the file; repair it there, or use slices beside it"
    )
    return Finding("spike", message, channel=channel.name, sample=int(places[0]))


def _strays(channel: Channel) -> Finding | None:
    """Single samples, here and there, that lie far beside those before and behind them: no mass moves so.

    A shock bends a place and breaks a rate, so that of rates those alone count that drop, all to one value nearer 0.
    """
    from scipy.ndimage import median_filter  # here, since it takes long to import

    values = channel.values
    half = _STRETCH // 2
    if values.size < 2 * _STRETCH:
        return None
    steps = np.abs(np.diff(values, prepend=values[0]))
    usual = np.maximum(median_filter(steps, _STRETCH, mode="nearest"), step_of(values))
    away = np.abs(values - median_filter(values, _ABOUT, mode="nearest"))
    at = np.flatnonzero((away > _STRAY * usual) & (away > _LEAST_STRAY * np.std(values)))
    at = at[(at >= half) & (at < values.size - half)]
    at = at[away[at] > _ALONE * np.abs(values[at + 1] - values[at - 1])]  # a motion may begin with a leap, and goes on
    around = values[at[:, None] + [-2, -1, 1, 2]].T
    at = at[(values[at] < around.min(0)) | (values[at] > around.max(0))]  # none that flickers between two levels
    if not 0 < at.size <= _MOST_STRAYS * values.size:
        return None
    falls = np.all(np.abs(values[at]) < np.abs(values[at - 1])) and not np.ptp(values[at])
    if channel.name not in CONTINUOUS and (not falls or (at.size == 1 and values[at[0]])):
        return None
    places = ", ".join(map(str, at[:_LISTED])) + (" and others" if at.size > _LISTED else "")
    message = (
        f"{at.size} single sample(s) of {channel.name} lie far beside their neighbours, at {places} (the first "
        f"{values[at[0]]:.4g}{behind(channel.unit)}): faults of the sensor or of the transmission; they count as they "
        "are. Where stamps of time stand beside them, take their rows out of a copy of the file: the gaps are bridged"
    )
    return Finding("stray_samples", message, channel=channel.name, sample=int(at[0]), severity="note")


def _straight_lines(channel: Channel) -> Finding | None:
    """Samples that lie on straight lines between every so many of them: a file that was interpolated."""
    if channel.name in INPUTS:
        return None  # a steady torque or an even rotation is a straight line
    bends = np.abs(np.diff(channel.values, 2))
    bent = np.flatnonzero(bends > _BEND * bends.max())
    if len(bent) < _FEWEST_BENDS or len(bent) > _BENT_SHARE * len(bends):
        return None
    factor = int(np.gcd.reduce(np.diff(bent)))
    if factor < 2:
        return None
    message = (
        f"{channel.name} runs in straight lines of {factor} samples: it was interpolated from a record {factor} times "
        "coarser, whose noise and bandwidth are lost; give the record as it was measured"
    )
    return Finding("interpolated", message, channel=channel.name)


def _clipped(channel: Channel) -> Finding | None:
    """A response that was cut at an extreme, or a channel at its declared range.

    What drives the system stands at its limit where the drive does: that is what was applied.
    """
    values = channel.values
    cut = None if channel.name in APPLIED else clipped_at(values)
    if channel.name in _SPEEDS and cut and values[cut[1]][0] == 0:
        cut = None  # a shaft or a drive that stands still
    seen = np.abs(values - channel.mean_added)  # by the sensor
    if channel.range is not None and seen.max() < _NEAR_RANGE * channel.range:
        cut = None  # the sensor could have gone on
    if cut:
        return _clipping(channel, cut[1], f"exactly at the {cut[0]}")
    if channel.range is not None:
        at = seen >= _AT_RANGE * channel.range
        if seen.max() > _BEYOND_RANGE * channel.range:
            return _beyond_range(channel, seen)
        if at.sum() > 1:
            return _clipping(channel, at, f"at the sensor's range of {channel.range:.4g}{behind(channel.unit)}")
    return None


def _beyond_range(channel: Channel, seen: NDArray) -> Finding:
    """No sensor tells more than its range: the range is another, or the scale of the values is."""
    most = int(np.argmax(seen))
    reached, declared = (
        f"{size / channel.declared_factor:.4g} {channel.declared_unit}" for size in (seen[most], channel.range)
    )
    message = (
        f"{channel.name} reaches {reached}, beyond its declared range of {declared}: state the range of the sensor, or "
        "the unit or gain of the channel"
    )
    return Finding("clipped", message, channel=channel.name, sample=most)


def _clipping(channel: Channel, at: NDArray, where: str) -> Finding:
    rest = "" if channel.range else "; where it came to rest there, declare the range of the sensor"
    message = (
        f"{100 * at.mean():.2g} % of {channel.name} stands {where}: clipped; "
        f"use a larger range, or slices that leave it out{rest}"
    )
    return Finding("clipped", message, channel=channel.name, sample=int(np.argmax(at)))
