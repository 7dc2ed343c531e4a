"""What makes measured data unreadable (InputError) or suspicious (Finding)."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.record import Channel, Finding, Record
from gear_damping.measurement.vocabulary import INPUTS

LARGEST_TRANSMISSION_ERROR = 1e-3  # m; a gear pair deflects by micrometres
SPEED_TOLERANCE = 0.02
SAMPLES_PER_PERIOD = 100  # of the fastest content; more only slow the work
_CONTENT = 0.999  # share of the energy that counts as content
_CLIPPED_SAMPLES, _CLIPPED_SHARE, _CLIPPED_RATIO = 5, 1e-3, 6
_BEND, _BENT_SHARE, _FEWEST_BENDS = 1e-4, 0.6, 10  # of the largest bend; of the samples; in a record
_ANGLE_CHANNELS = ("pinion_angle",)


def refuse_not_finite(values: NDArray[np.float64], key: str, source: str, first: int = 0) -> None:
    """Raise InputError naming the first sample that is NaN or infinite; `first` is the row of sample 0."""
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        longest = max(map(len, np.split(bad, np.flatnonzero(np.diff(bad) > 1) + 1)))
        rule = f"{bad.size} value(s) are not finite, the first at sample {bad[0] + first}"
        rule += f", up to {longest} in a row" if longest > 1 else ""
        raise InputError(Problem(key, rule, remedy="use slices that leave them out", source=source))


def check_record(record: Record) -> tuple[Finding, ...]:
    """Everything suspicious in the values of a record, beside what its time stamps showed."""
    found = []
    for channel in record.channels.values():
        found += [_constant(channel) or _clipped(channel) or _straight_lines(channel)]
    if "transmission_error" in record.channels:
        found.append(_magnitude(record.channels["transmission_error"]))
    found += [_turning(record), _speed(record), _oversampled(record)]
    return tuple(replace(finding, record=record.name) for finding in found if finding)


def _constant(channel: Channel) -> Finding | None:
    if np.ptp(channel.values) > 0:
        return None
    driven = channel.name in INPUTS or channel.name == "pinion_speed"
    message = f"every sample of {channel.name} is {channel.values[0]:.6g} {channel.unit}"
    message += "" if driven else "; check the cable and the column"
    severity = "note" if driven else "data_problem"
    return Finding("constant_channel", message, channel=channel.name, severity=severity)


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
    """Many samples exactly at an extreme with few at the level beside it, or at the declared range."""
    values = channel.values
    for name, at in (("minimum", values == values.min()), ("maximum", values == values.max())):
        if _stands_at_extreme(values, at, channel.name in INPUTS):
            return _clipping(channel, at, f"exactly at the {name}")
    if channel.range is not None:
        at = np.abs(values) >= 0.999 * channel.range
        if at.sum() > 1:
            return _clipping(channel, at, f"at the sensor's range of {channel.range:.4g} {channel.unit}")
    return None


def _stands_at_extreme(values: NDArray, at: NDArray, driven: bool) -> bool:
    """A ramp that is held at its end stands there once; a clipped input returns to the limit."""
    count = int(at.sum())
    if count < max(_CLIPPED_SAMPLES, _CLIPPED_SHARE * values.size) or count == values.size:
        return False
    extreme = values[at][0]
    beside = np.min(np.abs(values[~at] - extreme))
    neighbours = int(np.sum(np.abs(np.abs(values - extreme) - beside) <= 1e-9 * beside))
    stays = at[1:] & at[:-1]
    visits = int(np.sum(stays[1:] & ~stays[:-1])) + int(stays[0])
    return count > _CLIPPED_RATIO * neighbours and visits >= (2 if driven else 1)


def _clipping(channel: Channel, at: NDArray, where: str) -> Finding:
    message = (
        f"{100 * at.mean():.2g} % of {channel.name} stands {where}: clipped; "
        "use a larger range, or slices that leave it out"
    )
    return Finding("clipped", message, channel=channel.name, sample=int(np.argmax(at)))


def _magnitude(channel: Channel) -> Finding | None:
    values = channel.values - (np.median(channel.values) if channel.datum == "arbitrary" else 0.0)
    where = int(np.argmax(np.abs(values)))
    largest = abs(float(values[where]))
    if largest <= LARGEST_TRANSMISSION_ERROR:
        return None
    message = (
        f"the transmission error reaches {largest:.3g} m, and gear pairs stay below 1 mm; "
        f"check its unit '{channel.declared_unit}' (mm or um read as m?)"
    )
    return Finding("implausible_magnitude", message, channel=channel.name, sample=where)


def _turning(record: Record) -> Finding | None:
    """A shaft angle advances one way, apart from its encoder's noise."""
    angle = record.channels.get("pinion_angle")
    if angle is None or np.ptp(angle.values) == 0:
        return None
    coarse = np.diff(angle.values[:: max(1, angle.values.size // 50)])
    share = max(np.mean(coarse > 0), np.mean(coarse < 0))
    if share >= 0.9:
        return None
    message = "pinion_angle does not advance like that of a turning shaft; was another column taken for it?"
    return Finding("angle_not_turning", message, channel="pinion_angle")


def _speed(record: Record) -> Finding | None:
    """The stated or measured speed against the rate of the angle."""
    angle, condition = record.channels.get("pinion_angle"), record.conditions.get("pinion_speed")
    measured = record.channels.get("pinion_speed")
    stated = condition.value if condition else float(np.mean(measured.values)) if measured else None
    if angle is None or not stated:
        return None
    rate = float(np.polyfit(record.time - record.time[0], angle.values, 1)[0])
    if abs(rate / stated - 1) <= SPEED_TOLERANCE:
        return None
    message = (
        f"the pinion angle turns at {rate * 30 / np.pi:.5g} rpm and the stated speed is "
        f"{stated * 30 / np.pi:.5g} rpm; check unit, direction and counts per revolution"
    )
    return Finding("speed_mismatch", message, channel="pinion_angle")


def _oversampled(record: Record) -> Finding | None:
    """A response whose fastest content has more than a hundred samples a period."""
    if not record.uniform:
        return None
    fastest = 0.0
    for channel in record.channels.values():
        if channel.name not in (*INPUTS, *_ANGLE_CHANNELS, "pinion_speed"):
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
