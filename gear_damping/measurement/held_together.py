"""Whether what was measured of one motion holds together: its derivatives, and the torques of shafts that turn evenly.

The unit of one channel, its sign or its scale show where another one measures the same motion: at the line at which the
displacement is strongest, an acceleration is -(2 pi f)^2 times that.
"""

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.angular_error import GEOMETRY, base_radius
from gear_damping.measurement.record import Channel, Finding, Quantity, Record
from gear_damping.measurement.vocabulary import OSCILLATOR_CHANNELS

_SEGMENTS = 8  # half overlapping, over which spectra are averaged
_BESIDE = 2  # lines to either side of the strongest
_FEWEST = 256  # samples, below which a segment of them parts no lines
_COHERENT = 0.9  # of the power that two channels share, from which their ratio is told
_AGREE = 1.5  # times: a sensor's calibration, its mounting and its filters together make less of it
_LOSS = 0.3  # of the torque: what a pair of gears with its bearings and seals never takes
_RATIO = 0.03  # of a shaft's speed by the other one's: a tooth of thirty, and more than a sensor's calibration
_MEANLESS = 0.1  # of the speed that the teeth say: what is left of it where a sensor lost its mean
_PRESSURE_ANGLE = np.deg2rad(20.0)  # rad: the usual one, where none is stated
_STEADY = 0.1  # of the change that torques would make, beside which a speed is steady; of the speed, what is a change


def check_together(record: Record, parameters: Mapping[str, Quantity]) -> Iterator[Finding]:
    """What contradicts itself in a record.

    Args:
        record: The record.
        parameters: What is stated of the rig, in SI.
    """
    known = {name: quantity.value for name, quantity in parameters.items()}
    yield from _motions(record)
    yield from _torques(record, known)
    yield from _shafts(record, known)
    yield from _on_a_shaft(record, known)


def _motions(record: Record) -> Iterator[Finding]:
    """Each rate or acceleration of an oscillator against the channel that was differentiated least."""
    listed = [
        (order, name) for name, order in OSCILLATOR_CHANNELS.items() if name in record.channels and order is not None
    ]
    if len(listed) < 2 or not record.uniform or "base_acceleration" in record.channels:
        return  # relative to a base and against the ground are two motions
    (first, name), *others = sorted(listed)
    for order, other in others:
        ratio = _ratio(record.channels[name], record.channels[other], record.sampling_rate, order - first)
        if ratio is None or (abs(ratio.imag) < ratio.real and 1 / _AGREE <= abs(ratio) <= _AGREE):
            continue
        yield Finding("motions_disagree", f"{other} is {_told(ratio)} what {name} makes of it", channel=other)


def _told(ratio: complex) -> str:
    """A ratio in words, and what to check, before `what … makes of it`."""
    said = f"{abs(ratio):.3g} times"
    if abs(ratio.imag) > abs(ratio.real):
        return f"out of step by {abs(np.angle(ratio, deg=True)):.0f} degrees (check both columns), and {said},"
    return (
        f"{said}, with its sign reversed (check polarity and unit)," if ratio.real < 0 else f"{said} (check both units)"
    )


def _ratio(motion: Channel, derived: Channel, rate: float, order: int, by_derived: bool = False) -> complex | None:
    """The second channel over the derivative of the first at its strongest line; None where they share no line.

    The line is the strongest of the first, or `by_derived` of the second.
    """
    first, second = (np.asarray(channel.values, dtype=np.float64) for channel in (motion, derived))
    if len(first) < _FEWEST or np.ptp(first) == 0 or np.ptp(second) == 0:
        return None
    spectra = [_spectra(values) for values in (first, second)]
    frequency = 2 * np.pi * rate * np.arange(spectra[0].shape[1]) / (2 * (spectra[0].shape[1] - 1))
    line = int(np.argmax(np.mean(np.abs(spectra[int(by_derived)][:, 1:]) ** 2, axis=0))) + 1
    near = slice(max(line - _BESIDE, 1), line + _BESIDE + 1)  # the window has made several of one line
    expected, found = spectra[0][:, near] * (1j * frequency[near]) ** order, spectra[1][:, near]
    power, other = (float(np.sum(np.abs(one) ** 2)) for one in (expected, found))
    cross = complex(np.sum(np.conj(expected) * found))
    return cross / power if abs(cross) ** 2 >= _COHERENT * power * other else None


def _spectra(values: NDArray[np.float64]) -> NDArray[np.complex128]:
    """(segments, frequencies): spectra of windowed segments about their means."""
    length = 2 * (2 * len(values) // (_SEGMENTS + 1) // 2)
    starts = range(0, len(values) - length + 1, length // 2)
    segments = np.stack([values[start : start + length] for start in starts])
    return np.fft.rfft((segments - segments.mean(axis=1, keepdims=True)) * np.hanning(length), axis=1)


def _torques(record: Record, known: Mapping[str, float]) -> Iterator[Finding]:
    """Torques that would have changed a speed that hardly changed; where no inertia is known a note."""
    pinion, gear = (_mean(record, f"{shaft}_torque") for shaft in ("pinion", "gear"))
    speeds = _speeds(record)
    if pinion is None or gear is None or speeds is None or not all(known.get(name) for name in GEOMETRY.values()):
        return
    ratio = known["n_teeth_pinion"] / known["n_teeth_gear"]
    left = pinion - gear * ratio
    if abs(left) <= _LOSS * max(abs(pinion), abs(gear * ratio)):
        return
    said = f"pinion_torque {pinion:.4g} N*m and gear_torque {gear:.4g} N*m do not balance over {1 / ratio:.4g}"
    check = "check their signs (a load is positive on the gear), units and shafts"
    if not all(known.get(f"inertia_{shaft}") for shaft in ("pinion", "gear")):
        if np.ptp(speeds) <= _STEADY * abs(speeds[0]):
            message = f"{said}, and the pinion's speed is steady: {check}, or state gear_torque: balanced"
            yield Finding("torques_disagree", message, channel="gear_torque", severity="note")
        return
    change = left / (known["inertia_pinion"] + known["inertia_gear"] * ratio**2) * record.duration
    if np.ptp(speeds) > _STEADY * abs(change) or abs(change) < _STEADY * abs(speeds[0]):
        return
    rpm = 30 / np.pi
    is_steady = np.ptp(speeds) <= _STEADY * abs(speeds[0])
    ends = f"{speeds[0] * rpm:.5g} rpm", f"{speeds[-1] * rpm:.5g} rpm"
    goes = f"it hardly leaves {ends[0]}" if is_steady else f"it goes from {ends[0]} to {ends[1]}"
    message = f"{said}: they would change the pinion's speed by {change * rpm:.3g} rpm, and {goes}; {check}"
    yield Finding("torques_disagree", message, channel="gear_torque")


def _shafts(record: Record, known: Mapping[str, float]) -> Iterator[Finding]:
    """A gear's speed that is not the pinion's by the teeth, as by a wrong radius of a vibrometer."""
    channel, teeth = record.channels.get("gear_speed"), [known.get(name) for name in GEOMETRY.values()]
    if channel is None or channel.highpass or channel.coupling == "AC" or not all(teeth):
        return
    speeds = _speeds(record)
    if speeds is None:
        return
    expected = abs(float(speeds.mean())) * teeth[0] / teeth[1]
    found = abs(float(channel.values.mean()))
    allowed = max(_RATIO, 3 * channel.uncertainty, float(np.ptp(np.abs(speeds))) / abs(float(speeds.mean()) or 1.0))
    if not expected or found < _MEANLESS * expected or abs(found / expected - 1) <= allowed:
        return
    rpm = 30 / np.pi
    message = (
        f"the gear turns at {found * rpm:.5g} rpm, and {teeth[0]:g}/{teeth[1]:g} teeth make {expected * rpm:.5g} rpm "
        f"of the pinion's speed ({found / expected:.4g} times that); check the unit and the radius of gear_speed, and "
        "the teeth"
    )
    yield Finding("speeds_disagree", message, channel="gear_speed")


def _on_a_shaft(record: Record, known: Mapping[str, float]) -> Iterator[Finding]:
    """A tangential acceleration beside a transmission error: by the inertias one is a multiple of the other's.

    The mesh pushes both shafts by one force, so that the share of each in what they turn against one another is known,
    as far as nothing bends but the teeth.
    """
    error, channel = record.channels.get("transmission_error"), record.channels.get("acceleration")
    if error is None or channel is None or channel.mounting != "tangential" or not record.uniform:
        return
    names = ("n_teeth_pinion", "n_teeth_gear", "module", "inertia_pinion", "inertia_gear")
    if not all(known.get(name) for name in names) or not channel.radius:
        return
    pressure_angle = known.get("pressure_angle", _PRESSURE_ANGLE)
    radii = [base_radius(known[teeth], known["module"], pressure_angle) for teeth in GEOMETRY.values()]
    eases = [radius / known[f"inertia_{shaft}"] for radius, shaft in zip(radii, ("pinion", "gear"), strict=True)]
    share = eases[channel.shaft == "gear"] / (radii[0] * eases[0] + radii[1] * eases[1]) * channel.radius
    ratio = _ratio(error, channel, record.sampling_rate, 2, by_derived=True)
    if ratio is None or 1 / _AGREE <= abs(ratio) / share <= _AGREE:
        return
    message = (
        f"acceleration is {abs(ratio) / share:.3g} times what transmission_error makes of it by the inertias: check "
        "its unit, radius and shaft, and the inertias, or a shaft bends between"
    )
    yield Finding("motions_disagree", message, channel="acceleration", severity="note")


def _mean(record: Record, name: str) -> float | None:
    if name in record.channels:
        return float(record.channels[name].values.mean())
    return record.conditions[name].value if name in record.conditions else None


def _speeds(record: Record) -> NDArray[np.float64] | None:
    """rad/s of the pinion at the begin and at the end of a record, or as it is stated; None where nothing says it."""
    if angle := record.channels.get("pinion_angle"):
        parts = np.array_split(angle.values, _SEGMENTS)
        return np.array([np.ptp(part) / len(part) for part in (parts[0], parts[-1])]) * record.sampling_rate
    if speed := record.channels.get("pinion_speed"):
        return np.array([part.mean() for part in np.array_split(speed.values, _SEGMENTS)])
    stated = record.conditions.get("pinion_speed")
    return None if stated is None else np.array([stated.value])
