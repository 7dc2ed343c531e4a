"""Shaft angles from encoders and tachos, and the transmission error from two encoders."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.column_kinds import rises
from gear_damping.measurement.declaration import EncoderPlan
from gear_damping.measurement.record import Finding
from gear_damping.measurement.recordings import past_overflow
from gear_damping.measurement.timebase import TimeBase, cubic_spline, monotone_spline
from gear_damping.units import is_of_kind, parse_unit, to_si

TURN = 2 * np.pi  # rad in one turn of a shaft
BEYOND = 2.5  # steps of pulses that a record may go on past them: a pulse lost at its end, and its stamps are rounded
FEWEST_PULSES = 2  # in a record: one alone tells no speed
WITHIN_A_TURN = 1.01  # that an angle which begins again may span: a scale is a little off, and an end is rounded
COUNTERS = (16, 24, 32)  # bits of the registers that run over in counter cards
FROM_ENCODERS = "transmission_error: r_b1 theta_1 - r_b2 theta_2 from the encoders, without its mean"  # a note
MOST_CHANGES = 4  # of a count that has two values: a shaft that stands about the edge of one goes to and fro, seldom
SQUARE = 0.1  # of a pulse's height: from one level to the other within a sample, so that the edge is known to that
SPREAD = 5.0  # median steps between samples of a level that its noise reaches, nearly five standard deviations
_CURVED, _ENDS = 4, 6  # pulses that a changing speed is told by, and those at an end by which it goes on
_STEADIEST = 6  # degrees of polynomials that are tried through the edges of square pulses
_CUBIC, _FEWEST_PIECES, _EDGES_EACH = 3, 4, 16  # degree of splines behind them, their first pieces, edges a number
_OFF = 3.0  # deviations by which a spline through rounded edges may be off at either side
_WITHIN = 1.03  # samples between the earliest and the latest of edges about it: rounding moves them by one in all
_EVEN, _WHOLE = 0.2, 0.1  # share by which steps beside a lost pulse may differ, and a step from a whole number of them
_ONE_TURN = 1e-3  # share by which the counts of a turn may differ from the unit of a header: digits that were left out
_TURN_TOLERANCE = 0.25  # of a turn; a pulse is known to a sample
ReadColumn = Callable[[str | int, str], NDArray[np.float64]]


@dataclass(frozen=True, eq=False)
class ShaftAngle:
    """Where a shaft stands.

    Args:
        values: (n,) rad at the record's samples.
        timing_error: Standard deviation in s by which all of it may be late, where edges are known to a sample.
        lost: How many pulses are missing between others; their turns are counted.
        lost_after: Time in s of the last pulse before the first that is missing.
        stamped_rate: Stamps a second, in Hz, of a shaft whose pulses are stamped by a clock; 0.0 of any other.
        stamps_end: Time in s of the last of these stamps; 0.0 of any other shaft.
    """

    values: NDArray[np.float64]
    timing_error: float = 0.0
    lost: int = 0
    lost_after: float = 0.0
    stamped_rate: float = 0.0
    stamps_end: float = 0.0


def angle_from_counts(counts: NDArray[np.float64], per_revolution: float, direction: int = 1) -> NDArray[np.float64]:
    """(n,) rad from counts per sample; a counter may begin again after each revolution, or at the end of its range."""
    period = _begins_again_after(counts, per_revolution)
    whole = counts if period is None else np.unwrap(counts, period=period)
    return direction * TURN * whole / per_revolution


def _begins_again_after(counts: NDArray[np.float64], per_revolution: float) -> float | None:
    """The counts of a turn, or those of a register, whichever its falls are nearer to; None where it goes on.

    Where an angle is rounded, the end of a turn is written beside the zero of the next.
    """
    steps, span = np.abs(np.diff(counts)), float(np.ptp(counts))
    fitting = [2.0**bits for bits in COUNTERS if span < 2**bits]
    fitting += [per_revolution] if span <= WITHIN_A_TURN * per_revolution else []
    fitting = [period for period in fitting if np.any(steps > period / 2)]
    if not fitting:
        return None
    fall = float(np.median(steps[steps > min(fitting) / 2]) + np.median(steps))
    return min(fitting, key=lambda period: abs(period - fall))


def angle_from_pulses(
    pulses: NDArray[np.float64],
    time: NDArray[np.float64],
    per_revolution: float,
    direction: int,
    key: str,
    source: str,
) -> NDArray[np.float64]:
    """(n,) rad at `time` from the times of equally spaced pulses, monotone between them.

    Args:
        pulses: (m,) the times in s; the first is angle zero.
        time: (n,) the record's times in s.
        per_revolution: Pulses in one turn.
        direction: 1 or -1.
        key: What the pulses are called in messages.
        source: The file that they come from.

    Raises:
        InputError: fewer than two pulses, pulses that go back in time, or a record that begins
            or ends more than two pulses outside them.
    """
    if pulses.size < 2:
        rule = f"{pulses.size} pulse(s) found, at least 2 are needed"
        raise InputError(Problem(key, rule, remedy="check the threshold and the column", source=source))
    steps = np.diff(pulses)
    if np.any(steps <= 0):
        where = int(np.flatnonzero(steps <= 0)[0]) + 1
        rule = f"pulse {where} does not come after the one before"
        raise InputError(Problem(key, rule, remedy="sort the pulses, remove repeated ones", source=source))
    before, after = pulses[0] - time[0], time[-1] - pulses[-1]
    if before > BEYOND * steps[0] or after > BEYOND * steps[-1]:
        rule = f"pulses from {pulses[0]:.6g} to {pulses[-1]:.6g} s do not cover the record"
        rule += f" ({time[0]:.6g} to {time[-1]:.6g} s)"
        raise InputError(Problem(key, rule, remedy="shorten the record with slice", source=source))
    if np.sum((pulses >= time[0]) & (pulses <= time[-1])) < FEWEST_PULSES:
        rule = f"pulses from {pulses[0]:.6g} to {pulses[-1]:.6g} s, and fewer than {FEWEST_PULSES} of them in the"
        rule += f" record ({time[0]:.6g} to {time[-1]:.6g} s)"
        raise InputError(Problem(key, rule, remedy="check the unit of the pulses and the clock", source=source))
    angle = TURN * pulse_numbers(pulses) / per_revolution
    return direction * _extended(pulses, angle, time)


def pulse_numbers(pulses: NDArray[np.float64]) -> NDArray[np.int64]:
    """(m,) which pulse each is, from the times in s (m,): between even steps one of twice the length has lost a pulse.

    So has a wheel with a gap for its mark, every turn.
    """
    steps = np.diff(pulses)
    if steps.size < _CURVED:
        return np.arange(pulses.size)
    before, after = np.r_[steps[1], steps[:-1]], np.r_[steps[1:], steps[-2]]
    before[0], after[-1] = steps[2], steps[-3]
    usual = (before + after) / 2
    passed = np.round(steps / usual)
    is_lost = (
        (passed > 1) & (np.abs(steps / usual - passed) < _WHOLE * passed) & (np.abs(before - after) < _EVEN * usual)
    )
    return np.r_[0, np.cumsum(np.where(is_lost, passed, 1))].astype(np.int64)


def _extended(pulses: NDArray, angle: NDArray, time: NDArray) -> NDArray[np.float64]:
    """Interpolated between the pulses, and beyond the first and last as the pulses next to these go on.

    The spline of a shaft that speeds up is true to it; where it would turn back between uneven pulses, a monotone one
    is taken instead.
    """
    within = np.clip(time, pulses[0], pulses[-1])
    inner = cubic_spline(pulses, angle)(within) if pulses.size >= _CURVED else monotone_spline(pulses, angle)(within)
    if np.any(np.diff(inner) < 0):
        inner = monotone_spline(pulses, angle)(within)
    first = _going_on(pulses[:_ENDS], angle[:_ENDS], pulses[0])
    last = _going_on(pulses[-_ENDS:], angle[-_ENDS:], pulses[-1])
    return inner + first(np.minimum(time - pulses[0], 0)) + last(np.maximum(time - pulses[-1], 0))


def _going_on(pulses: NDArray, angle: NDArray, end: float) -> Callable[[NDArray], NDArray]:
    """The angle turned since an end, by the time since it: a parabola through pulses, or the line of too few."""
    found = np.polynomial.Polynomial.fit(pulses - end, angle, 2 if pulses.size >= _CURVED else 1)
    return lambda since: found(since) - found(0.0)


def rising_edges(signal: NDArray[np.float64], time: NDArray[np.float64], threshold: float) -> NDArray[np.float64]:
    """(m,) the times in s at which a pulse train rises through `threshold`, between samples too."""
    last = rises(signal >= threshold)
    share = (threshold - signal[last]) / (signal[last + 1] - signal[last])
    return time[last] + share * (time[last + 1] - time[last])


def edges_of_square_pulses(
    signal: NDArray[np.float64], time: NDArray[np.float64], threshold: float
) -> tuple[NDArray[np.float64], float]:
    """(m,) the times in s of rising edges, not rounded to samples, and by how much they may be late (one deviation).

    Square pulses tell an edge to a sample, which fifty teeth and their harmonics make a good part of a period. Where
    some even turning leaves no more than that rounding, the edges lie on the smoothest one that does. Noise of the two
    levels tells nothing of where between them an edge lies.
    """
    last, sample = rises(signal >= threshold), float(np.median(np.diff(time)))
    if not last.size or not _are_square(signal, last, threshold):
        return rising_edges(signal, time, threshold), 0.0
    edges = (time[last] + time[last + 1]) / 2  # of two noisy levels what lies between them is the noise
    count = pulse_numbers(edges)
    for one in _steady_turnings(edges, count):
        smooth = edges + (count - one.turned(edges)) / one.slope(edges)
        late = sample * (one.numbers / edges.size / 12) ** 0.5
        if np.ptp(edges - smooth) <= _WITHIN * sample + 2 * one.off * late:
            return smooth, late
    return edges, 0.0


@dataclass(frozen=True)
class _Turning:
    """A turning through edges: pulses by the time, their slope, how many numbers it has, its deviations at an edge."""

    turned: Callable
    slope: Callable
    numbers: int
    off: float = 0.0


def _steady_turnings(edges: NDArray[np.float64], count: NDArray[np.int64]) -> Iterator[_Turning]:
    """Ever less even turnings through edges (n,): of a shaft that speeds up evenly, and of a run-up by hand."""
    for degree in range(1, min(_STEADIEST, edges.size - 3) + 1):
        line = np.polynomial.Polynomial.fit(edges, count, degree)
        yield _Turning(line, line.deriv(), degree + 1)
    from scipy.interpolate import make_lsq_spline  # here, since it takes long to import and few files need it

    pieces = _FEWEST_PIECES
    while (pieces + _CUBIC) * _EDGES_EACH <= edges.size:
        inner = np.linspace(edges[0], edges[-1], pieces + 1)
        knots = np.r_[[edges[0]] * _CUBIC, inner, [edges[-1]] * _CUBIC]
        spline = make_lsq_spline(edges, count, knots, _CUBIC)
        yield _Turning(spline, spline.derivative(), pieces + _CUBIC, _OFF)
        pieces *= 2


def _are_square(signal: NDArray[np.float64], last: NDArray[np.int64], threshold: float) -> bool:
    """Whether pulses go from one level to the other within a sample, after samples `last`, but for noise of theirs."""
    high = signal >= threshold
    levels = [float(np.median(signal[one])) for one in (~high, high)]
    noise = [SPREAD * float(np.median(np.abs(np.diff(signal[one])))) for one in (~high, high)]
    margin = SQUARE * (levels[1] - levels[0])
    before, after = signal[last] - levels[0], levels[1] - signal[last + 1]
    return bool(np.all(before < margin + noise[0]) and np.all(after < margin + noise[1]))


def transmission_error(
    pinion: NDArray[np.float64], gear: NDArray[np.float64], radius_pinion: float, radius_gear: float
) -> NDArray[np.float64]:
    """(n,) m: x = r_b1 theta_1 - r_b2 theta_2 along the line of action, without its arbitrary mean."""
    error = radius_pinion * pinion - radius_gear * gear
    return error - error.mean()


def mean_rotation(
    pinion: NDArray[np.float64],
    error: NDArray[np.float64],
    radii: tuple[float, float],
    inertias: tuple[float, float],
) -> NDArray[np.float64]:
    """(n,) rad: the pinion's angle without its share of the transmission error (n,), theta_1 - r_b1 m x / I_1.

    Gear models with one degree of freedom, this package's among them, count the mesh phase along the mean rotation;
    the angle as measured would add the vibration to it once more, some 0.1 % of the response.
    """
    arms = inertias[0] * radii[1] ** 2 + inertias[1] * radii[0] ** 2
    return pinion - radii[0] * inertias[1] / arms * error


def shaft_angle(plan: EncoderPlan, base: TimeBase, rows: ReadColumn, whole: ReadColumn, file: str) -> ShaftAngle:
    """The angle at the record's samples as they are stamped in the file.

    Args:
        plan: The declared encoder or tacho.
        base: The record's time base.
        rows: Reads the record's rows of a column.
        whole: Reads a whole column, such as the times of pulses.
        file: The file, for messages.

    Raises:
        InputError: a column, unit or pulse train that cannot be used.
    """
    time = base.time if base.stamps is None else base.stamps
    if plan.name != "tacho" and not plan.timestamps:
        counts = rows(plan.column, f"{plan.key}.column")
        _refuse_levels(counts, plan, file)
        angle = angle_from_counts(counts, plan.per_revolution, plan.direction)
        zero, late = (0.0, 0.0) if plan.index is None else _at_index_pulse(plan, angle, time, rows, file)
        return ShaftAngle(angle - zero, late)
    key = f"{plan.key}.{'timestamps' if plan.timestamps else 'column'}"
    if plan.timestamps:
        pulses, late = pulse_times(plan, whole, file), 0.0
    else:
        signal = rows(plan.column, key)
        pulses, late = edges_of_square_pulses(signal, time, _threshold(plan, signal, file))
    angle = angle_from_pulses(pulses, time, plan.per_revolution, plan.direction, key, file)
    zero = 0.0 if plan.index is None else _at_index_stamp(plan, angle, time, whole, file)
    gaps = np.diff(pulse_numbers(pulses)) - 1
    rate, end = (1 / float(np.median(np.diff(pulses))), float(pulses[-1])) if plan.timestamps else (0.0, 0.0)
    return ShaftAngle(angle - zero, late, int(gaps.sum()), float(pulses[int((gaps > 0).argmax())]), rate, end)


def pulse_times(plan: EncoderPlan, whole: ReadColumn, file: str) -> NDArray[np.float64]:
    """Times of the pulses of an encoder in s, past the end of the register of their clock.

    Raises:
        InputError: no such column, or no unit of time.
    """
    seconds = to_si(1.0, plan.unit, "s", f"{plan.key}.unit", file)
    return past_overflow(whole(plan.column, f"{plan.key}.timestamps")) * seconds


def other_turn(plan: EncoderPlan, header: str | None) -> Finding | None:
    """A header that says an angle, of which a turn has another number than is declared: `[deg]` and 3600 counts.

    Args:
        plan: The declared encoder.
        header: The unit that the file gives for its column, or None.
    """
    if plan.name == "tacho" or plan.timestamps or header is None or not is_of_kind(header, "rad"):
        return None
    turn = TURN / to_si(1.0, header, "rad")
    if abs(plan.per_revolution / turn - 1) < _ONE_TURN:
        return None
    message = (
        f"the header of column '{plan.column}' says '{header}', of which a turn has {turn:.7g}, and "
        f"counts_per_revolution: {plan.per_revolution:g} was used; correct the one that is wrong, in a copy of the "
        "file where it is the header"
    )
    return Finding("unit_conflict", message, channel=plan.name)


def _refuse_levels(counts: NDArray, plan: EncoderPlan, file: str) -> None:
    """Refuse the two levels of a pulse train where counts are declared."""
    held = np.unique(counts)
    if held.size == 2 and np.count_nonzero(np.diff(counts)) > MOST_CHANGES:
        rule = f"goes to and fro between {held[0]:g} and {held[1]:g}: the levels of pulses, and no counts"
        remedy = "write the times of its rising edges into a column, and give that as timestamps, or count the edges"
        raise InputError(Problem(f"{plan.key}.column", rule, plan.column, remedy, file))


def _threshold(plan: EncoderPlan, signal: NDArray, file: str) -> float:
    """The declared threshold in the column's unit, else half way between the extremes."""
    if plan.threshold is None:
        return float(signal.min() + signal.max()) / 2
    key = f"{plan.key}.threshold"
    declared = to_si(plan.threshold.value, plan.threshold.unit, plan.unit, key, file)
    level, low, high = declared / parse_unit(plan.unit, f"{plan.key}.unit", file).factor, signal.min(), signal.max()
    if not low < level < high:
        of_scale = ", shares of full scale" if file.lower().endswith(".wav") else ""
        rule = f"lies outside the column's values, {low:.4g} to {high:.4g}{of_scale}"
        raise InputError(Problem(key, rule, f"{level:g}", "state it in these, or leave it out: half way", file))
    return level


def _at_index_pulse(
    plan: EncoderPlan, angle: NDArray, time: NDArray, rows: ReadColumn, file: str
) -> tuple[float, float]:
    """The angle at the first index pulse, which is the shaft's zero, and by how much it may be late, in s.

    A pulse began between the sample that shows it first and the one before. Every turn says so anew, and the zero lies
    where all of them allow it: a good part of a sample for one turn, a tenth of that for ten.
    """
    signal = rows(plan.index, f"{plan.key}.index")
    high = signal > (signal.min() + signal.max()) / 2
    before = rises(high)  # of one that has begun before the record, nothing says when
    first = np.r_[np.flatnonzero(high[:1]), before + 1]
    if not first.size:
        raise InputError(Problem(f"{plan.key}.index", "holds no pulse", plan.index, "leave it out", file))
    _refuse_turns(plan, angle[first], file)
    if not before.size:
        return float(angle[first[0]]), 0.0
    turns = TURN * np.round((angle[before + 1] - angle[first[0]]) / TURN)
    ends = np.sort([angle[before] - turns, angle[before + 1] - turns], axis=0)
    least, most = float(ends[0].max()), float(ends[1].min())
    rate = abs(float(angle[-1] - angle[0])) / float(time[-1] - time[0])
    width = most - least if most > least else float(np.median(ends[1] - ends[0]))  # jitter: no angle fits all
    centre = (least + most) / 2 if most > least else float(ends.mean())
    return centre, width / 12**0.5 / max(rate, 1e-300)


def _refuse_turns(plan: EncoderPlan, at: NDArray, file: str) -> None:
    """Index pulses come once a turn, or the counts per revolution are not those of this encoder."""
    turns = float(np.median(np.abs(np.diff(at)))) / TURN if at.size > 1 else 1.0
    if abs(turns - 1) > _TURN_TOLERANCE:
        rule = f"its pulses are {turns:.3g} turns of {plan.per_revolution:g} counts apart"
        raise InputError(Problem(f"{plan.key}.index", rule, plan.index, "check counts_per_revolution", file))


def _at_index_stamp(plan: EncoderPlan, angle: NDArray, time: NDArray, whole: ReadColumn, file: str) -> float:
    """The same from the times of the index pulses."""
    key = f"{plan.key}.index"
    stamps = whole(plan.index, key) * to_si(1.0, plan.unit, "s", f"{plan.key}.unit", file)
    seconds = stamps[0]
    if not time[0] <= seconds <= time[-1]:
        rule = "the first index pulse lies outside the record"
        raise InputError(Problem(key, rule, plan.index, "shorten the record, or leave it out", file))
    _refuse_turns(plan, np.interp(stamps[stamps <= time[-1]], time, angle), file)
    return float(np.interp(seconds, time, angle))
