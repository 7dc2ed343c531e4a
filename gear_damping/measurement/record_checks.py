"""What is suspicious in a record as a whole, beyond the values of one channel.

Samples were taken at their uneven stamps. A stamp that is off its place by e moves a sample by e times the slope of the
signal, s' e, if the sample was taken there; if the sampling was even and only the stamps are late, the values know
nothing of e. The share b of s' e in the values (1 where the stamps are right, 0 where they are not) is fitted by least
squares over the frequencies, each weighted with the inverse of its power, so that the quiet ones, where s' e shows,
decide.

What was recorded beside a response and is not compared with a simulation is said, so that nobody waits for it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.checks import APPLIED, STRUCK, TURNING, check_channel
from gear_damping.measurement.encoders import FROM_ENCODERS
from gear_damping.measurement.irregular_stamps import written_on_change
from gear_damping.measurement.lost_samples import lost_samples
from gear_damping.measurement.record import Channel, Finding, Record
from gear_damping.measurement.shaft_checks import LARGEST_TRANSMISSION_ERROR, check_shafts
from gear_damping.measurement.staircase import leaps_from_rests
from gear_damping.measurement.vocabulary import INPUTS

WHOLE_SPEEDS = ("pinion_speed", "gear_speed")  # hold the rotation, beside which what is fitted is little
NEVER_STRAIGHT = ("displacement", "transmission_error", "acceleration")  # a speed may rise evenly
STRAIGHT, FEWEST_OF_A_LINE = 1e-6, 16  # of its range; samples: fewer steps of a converter may lie on a line
MOST_NOISE = 30.0  # times what a channel holds: no guess of a noise is so far off, and a wrong unit is 1000 times
OVERSAMPLED = "oversampled"
_STALE = 0.5  # of the samples that repeat the one before, from which most of what is read was measured earlier
SAMPLES_PER_PERIOD = 100  # of the fastest content; more only slow the work
_ENOUGH = 40  # of them: harmonics that tell a law by little energy have four of them up to the tenth
_CONTENT = 0.999  # share of the energy that counts as content
_FEWEST_SWINGS = 8  # through its mean: what creeps back to zero passes that once
_SWINGS_BEYOND = 0.5  # of a swing's deviation: what passes to both sides so far, and more than its middle moves
_CLEAR_OF_NOISE = 3.0  # times that of the noise, which swings at every sample
_DRIFT = 0.1  # of the way that a straight line goes; what may lie about it
_LOCAL = 9  # samples about which a stamp's place is judged; slower wandering of a clock is left alone
_MATTERS = 1e-4  # share of the signal's variance that s' e must have to matter
_ONE_COUNT, _COUNTED = 0.01, 0.95  # of a step: the same count; share of the steps that are one
_OTHER_RATE = 0.02  # of a usual step, by which that of the samples about it leaps where a logger changes its rate
_FEWEST = 64  # samples, below which nothing is decided
_NEIGHBOURS = 33  # frequencies that give the level about a line
_SLOPE_ERROR = 0.1  # of the power of s' e; nothing is weighted higher than this error of the slope allows
_FLOOR, _OVER = 0.1, 4.0  # quantile of the power that is noise; times this, what a line must be above
_DECIDED = 0.35  # share below which the stamps are wrong
_ERRORS = 4.0  # standard errors that the share must be nearer to none by
FEW_BEYOND = 10  # samples that an input may lack at an end: the state at the start stands in for so few
MESH_RESPONSES = ("transmission_error", "gear_speed")  # that make a record one of a simulation, not of a casing


def stamps_against_values(record: Record) -> Finding | None:
    """The data problem of a record with uneven stamps whose values were sampled evenly; None for any other."""
    if record.uniform or record.time.size < _FEWEST or written_on_change(record.time):
        return None
    for channel in record.channels.values():
        if _is_counted(channel.values):
            continue
        for part in _stretches(record.time):
            share, error = share_at_stamps(channel.values[part], record.time[part])
            if abs(share) + _ERRORS * error >= _DECIDED:  # also far below 0: values that wait for an event
                continue
            message = (
                f"the values of {channel.name} were sampled evenly and the stamps were not ({100 * share:.2g} % of the "
                f"jitter of the stamps shows in the values, +-{100 * error:.2g} %): a computer wrote them late; "
                "give sampling_rate instead of the time column"
            )
            return Finding("uneven_stamps", message, channel=channel.name)
    return None


def _stretches(stamps: NDArray[np.float64]) -> list[slice]:
    """The long stretches of one rate that most of (n,) stamps lie in; all of them where such are few.

    Where a logger changes its rate, no even sampling could have made the values, and the bend of its stamps is none of
    their jitter.
    """
    from scipy.ndimage import median_filter

    usual = np.log(median_filter(np.diff(stamps), _LOCAL, mode="nearest"))
    edges = [0, *(np.flatnonzero(np.abs(np.diff(usual)) > _OTHER_RATE) + 1).tolist(), stamps.size - 1]
    parts = [slice(first, end + 1) for first, end in pairwise(edges) if end - first >= _FEWEST]
    held = sum(part.stop - part.start for part in parts)
    return parts if 2 * held > stamps.size else [slice(0, stamps.size)]


def _is_counted(values: NDArray[np.float64]) -> bool:
    """Whether a sample was taken at every count of an encoder, up or down, whose stamps say all there is."""
    steps = np.abs(np.diff(values))
    return bool(np.mean(np.abs(steps - np.median(steps)) <= _ONE_COUNT * np.median(steps)) > _COUNTED)


def share_at_stamps(values: NDArray[np.float64], stamps: NDArray[np.float64]) -> tuple[float, float]:
    """The share of the stamps' jitter that values show, and its standard error (infinite where none can matter).

    Args:
        values: (n,) samples.
        stamps: (n,) their stamps in s.
    """
    from scipy.ndimage import median_filter, uniform_filter1d  # here, since few records need what takes long to import

    place = stamps / np.median(np.diff(stamps)) - np.arange(stamps.size)
    place -= uniform_filter1d(place, _LOCAL, mode="nearest")
    index = np.arange(values.size)
    slope, start = np.polyfit(index, values, 1)
    straight = start + slope * index
    moved = (slope + np.gradient(_quiet(values - straight))) * place
    if np.var(moved) <= _MATTERS * np.var(values):
        return 1.0, np.inf
    taper = np.hanning(values.size)
    seen, due = np.fft.rfft((values - straight) * taper), np.fft.rfft((moved - moved.mean()) * taper)
    power = np.abs(seen) ** 2
    due_power = np.abs(due) ** 2
    level = power + median_filter(power, _NEIGHBOURS, mode="nearest") + _SLOPE_ERROR * (due_power + due_power.mean())
    total = float(np.sum(due_power / level))
    share = float(np.sum((due.conj() * seen).real / level)) / total
    variance = np.sum(due_power * np.abs(seen - share * due) ** 2 / level**2)
    return share, float(np.sqrt(variance)) / total


def _quiet(values: NDArray) -> NDArray:
    """Values about their straight line without most of their noise, which would hide the slope (Wiener's filter)."""
    from scipy.ndimage import median_filter

    spectrum = np.fft.rfft(values)
    power = np.abs(spectrum) ** 2
    noise = float(np.quantile(median_filter(power, _NEIGHBOURS, mode="nearest"), _FLOOR)) / np.log(2)
    return np.fft.irfft(spectrum * np.maximum(0.0, 1 - _OVER * noise / np.maximum(power, 1e-300)), values.size)


def not_compared(record: Record) -> Iterator[Finding]:
    """A note for every channel that the explanation leaves aside."""
    if not any(name in record.channels for name in MESH_RESPONSES):
        return
    if record.on_casing:
        message = (
            "the path from the mesh to a casing is unknown, so that this accelerometer is not compared with the "
            "simulation; for its orders and its signs of damage, declare it in a file without the other responses"
        )
        yield Finding("not_compared", message, channel="acceleration", severity="note")
    if {"pinion_speed", "pinion_angle"} <= {*record.channels} and "transmission_error" in record.channels:
        message = (
            "the angle is the measured one, and beside a transmission error the pinion's speed is no response: "
            "it is checked against the angle and used for nothing else"
        )
        yield Finding("not_compared", message, channel="pinion_speed", severity="note")


def check_record(record: Record) -> tuple[Finding, ...]:
    """Everything suspicious in the values of a record, beside the findings that it has already."""
    found = []
    struck = [channel for name, channel in record.channels.items() if name in STRUCK]
    strokes = np.array([np.argmax(np.abs(channel.values)) for channel in struck], dtype=int)
    for channel in record.channels.values():
        found += check_channel(channel, strokes)
    if not any(finding.severity == "data_problem" and finding.channel == "time" for finding in record.findings):
        found.append(stamps_against_values(record))
    disagree = any(finding.kind == "tooth_ratio" for finding in record.findings)
    straight = [] if disagree else [_straight(channel) for channel in record.channels.values()]  # nor a lag, nor a pace
    found += [*map(_drowned, record.channels.values()), *map(_stale, record.channels.values()), *straight]
    found += [lost_samples(channel, record.time) for channel in record.channels.values()]
    found += [_magnitude(record), _rests_elsewhere(record)]
    found += [] if disagree or any(straight) else [_oversampled(record)]
    found += [*check_shafts(record), *not_compared(record)]
    found += [*_beyond_the_band(record), *_inputs_beyond(record)]
    return tuple(replace(finding, record=record.name) for finding in found if finding)


def _drowned(channel: Channel) -> Finding | None:
    """A stated noise that is more than all that its channel holds."""
    held = float(np.std(channel.values))
    if channel.noise is None or channel.noise <= MOST_NOISE * held:
        return None
    one = channel.declared_factor
    message = (
        f"its stated noise, {channel.noise / one:.4g} {channel.declared_unit}, is more than all that it shows, "
        f"{held / one:.4g} {channel.declared_unit} (root mean square about its mean); check its unit"
    )
    return Finding("noise_above_signal", message, channel=channel.name)


def _stale(channel: Channel) -> Finding | None:
    """The note of a response that was read more often than it was measured, as off a camera's pictures."""
    repeated = float(np.mean(np.diff(channel.values) == 0)) if channel.values.size > 1 else 0.0
    if channel.name in APPLIED or repeated < _STALE or not leaps_from_rests(channel.values):
        return None
    message = (
        f"{100 * repeated:.2g} % of the samples of {channel.name} repeat the one before, and then it leaps: it was "
        "read more often than measured, and what is late looks like noise; keep the rows alone at which it changes"
    )
    return Finding("stale_values", message, channel=channel.name, severity="note")


def _straight(channel: Channel) -> Finding | None:
    """A response that is a straight line to the last digit, as a column of times or a counter is."""
    if channel.name not in NEVER_STRAIGHT or len(channel.values) < FEWEST_OF_A_LINE or not np.ptp(channel.values):
        return None
    place = np.linspace(-1, 1, len(channel.values))
    left = channel.values - np.polyval(np.polyfit(place, channel.values, 1), place)
    if np.max(np.abs(left)) > STRAIGHT * np.ptp(channel.values):
        return None
    message = f"the {channel.name.replace('_', ' ')} is a straight line, as a clock or a counter: name another column"
    return Finding("straight_line", message, channel=channel.name)


def _magnitude(record: Record) -> Finding | None:
    """A transmission error that no gear pair has: by its unit, or because it runs away."""
    channel = record.channels.get("transmission_error")
    if channel is None or any(finding.kind == "tooth_ratio" for finding in record.findings):
        return None
    values = channel.values - (np.median(channel.values) if channel.datum == "arbitrary" else 0.0)
    where = int(np.argmax(np.abs(values)))
    largest = abs(float(values[where]))
    if largest <= LARGEST_TRANSMISSION_ERROR:
        return None
    place = np.linspace(-1, 1, values.size)
    slope = float(np.polyfit(place, values, 1)[0])
    rest = values - slope * place
    if np.max(np.abs(rest - np.median(rest))) <= min(LARGEST_TRANSMISSION_ERROR, _DRIFT * 2 * abs(slope)):
        message = (
            f"the transmission error runs away by {2 * abs(slope):.3g} m over the record; "
            "check the tooth counts and the counts per revolution that it was made with"
        )
        return Finding("drifting_error", message, channel=channel.name)
    check = f"check its unit '{channel.declared_unit}' (mm or um read as m?)"
    if FROM_ENCODERS in record.notes:
        check = "check the tooth counts and the counts per revolution, and whether counts were lost"
    message = f"the transmission error reaches {largest:.3g} m, and gear pairs stay below 1 mm; {check}"
    return Finding("implausible_magnitude", message, channel=channel.name, sample=where)


def _rests_elsewhere(record: Record) -> Finding | None:
    """A motion with a zero of its own that swings about another place, where nothing that is declared holds it.

    A note: of two wells with the zero between them it may be so.
    """
    place = record.channels.get("displacement")
    if place is None or place.datum != "absolute" or {*INPUTS} & {*record.channels, *record.conditions}:
        return None
    late = place.values[place.values.size // 2 :]
    rest, at = float(np.mean(late)), np.arange(late.size)
    creep = np.polynomial.Polynomial.fit(at, late, 2)(at)
    swing, noise = np.std(late - creep), np.std(np.diff(late, 2)) / 6**0.5  # white noise has 6 times its variance there
    ways = np.sign(late - creep)[np.abs(late - creep) > _SWINGS_BEYOND * swing]
    swings = np.count_nonzero(np.diff(ways))
    is_steady = swing > max(_SWINGS_BEYOND * np.ptp(creep), _CLEAR_OF_NOISE * noise)
    if swings < _FEWEST_SWINGS or not is_steady or late.min() <= 0 <= late.max():
        return None
    message = (
        f"displacement swings about {rest / place.declared_factor:.3g} {place.declared_unit} and no longer crosses its "
        "zero: write datum: arbitrary where that means nothing"
    )
    return Finding("rests_elsewhere", message, channel="displacement", severity="note")


def _oversampled(record: Record) -> Finding | None:
    """A record whose fastest content has more than a hundred samples a period.

    Loads count: a slide that drifts slowly answers to them with little of its energy. By themselves they do not tell:
    where only the whole speed of a shaft answers, its vibration is faster than they are.
    """
    judged = [channel for channel in record.channels.values() if channel.name not in (*TURNING, *WHOLE_SPEEDS)]
    if not record.uniform or all(channel.name in INPUTS for channel in judged):
        return None
    fastest = max(_fastest_content(channel.values, record.sampling_rate) for channel in judged)
    if fastest == 0.0 or record.sampling_rate <= SAMPLES_PER_PERIOD * fastest:
        return None
    message = (
        f"99.9 % of the energy lies below {fastest:.3g} Hz, so that {record.sampling_rate:g} Hz "
        f"is far more than is needed; resample: {{value: {float(f'{_ENOUGH * fastest:.2g}'):g}, unit: Hz}} saves time"
    )
    return Finding(OVERSAMPLED, message, severity="note")


def oversampled_alike(records: Sequence[Record]) -> tuple[Record, ...]:
    """The records, oversampled where all of their rate are: who follows the note for some of them has two rates."""
    said = {record.name for record in records for finding in record.findings if finding.kind == OVERSAMPLED}
    needed = {record.sampling_rate for record in records if record.name not in said}
    return tuple(_without(OVERSAMPLED, record) if record.sampling_rate in needed else record for record in records)


def _without(kind: str, record: Record) -> Record:
    return replace(record, findings=tuple(finding for finding in record.findings if finding.kind != kind))


def _beyond_the_band(record: Record) -> Iterator[Finding]:
    """Low-passes that leave all of a record as it is, as one whose unit is wrong does."""
    for channel in record.channels.values():
        if channel.lowpass is not None and channel.lowpass >= record.sampling_rate:
            message = (
                f"its lowpass of {channel.lowpass:.6g} Hz lies beyond the band of a record of "
                f"{record.sampling_rate:.6g} Hz and filters nothing in it; check its unit, or leave it out"
            )
            yield Finding("filter_beyond_band", message, channel=channel.name, severity="note")


def _inputs_beyond(record: Record) -> Iterator[Finding]:
    """Inputs that a delay moves out of the record: what they were there is not known, and stays at its last value."""
    for channel in record.channels.values():
        beyond = round(abs(channel.delay) * record.sampling_rate)
        if channel.name not in INPUTS or beyond <= FEW_BEYOND:
            continue
        end = "last" if channel.delay > 0 else "first"
        message = (
            f"{channel.name} is moved by {channel.delay:.4g} s and does not reach the {end} {beyond} samples of the "
            f"record, where it is taken to keep its {end} value; where that is wrong, move the column by {beyond} rows "
            "in the file in the place of delay, and leave out the rows that lack it"
        )
        yield Finding("input_beyond_record", message, channel=channel.name, severity="note")


def _fastest_content(values: NDArray[np.float64], rate: float) -> float:
    """Hz below which 99.9 % of the energy about the mean lies; 0 for a constant."""
    if np.ptp(values) == 0:
        return 0.0
    power = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(values.size))) ** 2
    return float(np.searchsorted(np.cumsum(power), _CONTENT * power.sum())) * rate / values.size
