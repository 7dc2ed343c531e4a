"""What makes measured data unreadable (InputError) or suspicious (Finding)."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.clipping import clipped_at
from gear_damping.measurement.encoders import FROM_ENCODERS
from gear_damping.measurement.not_compared import not_compared
from gear_damping.measurement.record import Channel, Finding, Record
from gear_damping.measurement.shaft_check import LARGEST_TRANSMISSION_ERROR, check_shafts
from gear_damping.measurement.stamp_check import stamps_against_values
from gear_damping.measurement.vocabulary import INPUTS

SAMPLES_PER_PERIOD = 100  # of the fastest content; more only slow the work
_CONTENT = 0.999  # share of the energy that counts as content
_DRIFT = 0.1  # of the way that a straight line goes; what may lie about it
_BEND, _BENT_SHARE, _FEWEST_BENDS = 1e-4, 0.6, 10  # of the largest bend; of the samples; in a record
_FEWEST_MARKS, _MOST_MARKED = 3, 0.1  # samples of one value; share of all
_WITH_A_STROKE = 5  # samples between an input's largest value and a leap that it made
STRUCK = ("force", "base_acceleration")  # which one blow may make
_LONE = 5.0  # times as far from the median as any other sample
_SPEEDS = ("velocity", "pinion_speed", "gear_speed")
_APPLIED = (*INPUTS, "pinion_angle", "pinion_speed")  # what drives the system


def refuse_not_finite(values: NDArray[np.float64], key: str, source: str, first: int = 0) -> None:
    """Raise InputError naming the first sample that is NaN or infinite; `first` is the row of sample 0."""
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        longest = max(map(len, np.split(bad, np.flatnonzero(np.diff(bad) > 1) + 1)))
        rule = f"{bad.size} value(s) are not finite, the first at sample {bad[0] + first}"
        rule += f", up to {longest} in a row" if longest > 1 else ""
        raise InputError(Problem(key, rule, remedy="use slices that leave them out", source=source))


def check_record(record: Record) -> tuple[Finding, ...]:
    """Everything suspicious in the values of a record, beside the findings that it has already."""
    found = []
    for channel in record.channels.values():
        marked = _marked(channel)
        found += [marked or _constant(channel) or _clipped(channel) or _straight_lines(channel)]
        found += [] if marked or channel.name in STRUCK else [_spike(channel, _strokes(record))]
    if not any(finding.severity == "data_problem" and finding.channel == "time" for finding in record.findings):
        found.append(stamps_against_values(record))
    found += [_magnitude(record), *check_shafts(record), *not_compared(record), _oversampled(record)]
    return tuple(replace(finding, record=record.name) for finding in found if finding)


def _constant(channel: Channel) -> Finding | None:
    if np.ptp(channel.values) > 0:
        return None
    driven = channel.name in INPUTS or channel.name == "pinion_speed"
    message = f"every sample of {channel.name} is {channel.values[0]:.6g} {channel.unit}"
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
    message = (
        f"{channel.name} is {values[where]:.6g} {channel.unit} at {count} samples, the first at {where}, and nowhere "
        "else near it: a mark for a missing value; put what was measured there, or use slices beside it"
    )
    return Finding("marked_values", message, channel=channel.name, sample=where)


def _strokes(record: Record) -> NDArray[np.int64]:
    """Where an input is largest: a hammer's blow, with which a response may leap."""
    return np.array([np.argmax(np.abs(c.values)) for name, c in record.channels.items() if name in STRUCK], dtype=int)


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
        f"{channel.name} is {channel.values[places[0]]:.4g} {channel.unit} at sample {places[0]}, "
        f"{away[order[lone - 1]] / away[order[lone]]:.3g} times as far from its median as any other sample: a fault of "
        "the transmission or of the file; repair it there, or use slices beside it"
    )
    return Finding("spike", message, channel=channel.name, sample=int(places[0]))


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
        f"{channel.name} runs in straight lines of {factor} samples: it was interpolated from a {factor} times "
        "coarser record, whose noise and bandwidth are lost; give the record as it was measured"
    )
    return Finding("interpolated", message, channel=channel.name)


def _clipped(channel: Channel) -> Finding | None:
    """A response that was cut at an extreme, or a channel at its declared range.

    What drives the system stands at its limit where the drive does: that is what was applied.
    """
    values = channel.values
    cut = None if channel.name in _APPLIED else clipped_at(values)
    if channel.name in _SPEEDS and cut and values[cut[1]][0] == 0:
        cut = None  # a shaft or a drive that stands still
    if cut:
        return _clipping(channel, cut[1], f"exactly at the {cut[0]}")
    if channel.range is not None:
        at = np.abs(values) >= 0.999 * channel.range
        if at.sum() > 1:
            return _clipping(channel, at, f"at the sensor's range of {channel.range:.4g} {channel.unit}")
    return None


def _clipping(channel: Channel, at: NDArray, where: str) -> Finding:
    message = (
        f"{100 * at.mean():.2g} % of {channel.name} stands {where}: clipped; "
        "use a larger range, or slices that leave it out"
    )
    return Finding("clipped", message, channel=channel.name, sample=int(np.argmax(at)))


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


def _oversampled(record: Record) -> Finding | None:
    """A response whose fastest content has more than a hundred samples a period."""
    if not record.uniform:
        return None
    fastest = 0.0
    for channel in record.channels.values():
        if channel.name not in _APPLIED:
            fastest = max(fastest, _fastest_content(channel.values, record.sampling_rate))
    if fastest == 0.0 or record.sampling_rate <= SAMPLES_PER_PERIOD * fastest:
        return None
    message = (
        f"99.9 % of the energy lies below {fastest:.3g} Hz, so that {record.sampling_rate:.4g} Hz "
        "is far more than is needed; decimate to save time"
    )
    return Finding("oversampled", message, severity="note")


def _fastest_content(values: NDArray[np.float64], rate: float) -> float:
    """Hz below which 99.9 % of the energy about the mean lies; 0 for a constant."""
    if np.ptp(values) == 0:
        return 0.0
    power = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(values.size))) ** 2
    return float(np.searchsorted(np.cumsum(power), _CONTENT * power.sum())) * rate / values.size
