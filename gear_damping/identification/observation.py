"""From measured records to what a fit sees: which channels respond, how sensors show the motion, what drives it."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot

import numpy as np
import torch
from scipy.interpolate import CubicSpline
from scipy.stats import f as f_distribution
from torch import Tensor

from gear_damping.errors import InputError, Problem, with_article
from gear_damping.identification.angle_steps import between_steps
from gear_damping.identification.output_error.records import Filter, FitRecord, FreeParameter, Observed
from gear_damping.measurement.record import Channel, Measurement, Quantity, Record
from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.oscillator import Oscillator

MEANS = ("pinion_torque", "gear_torque")
SPEED_BLOCKS = 12  # of a record, over which a measured speed is averaged
DRIFTS_AT = 0.01  # level of the test that it does not
MESH_PHASE = FreeParameter("mesh_phase", 0.0)  # of a record without an index: its own; shaft effects add their phases


@dataclass(frozen=True)
class Known:
    """What a file states of the rig.

    Args:
        values: By the file's names, in SI or the rig's own units.
        uncertainty: Relative standard deviation of those that are not known exactly.
        system: What was measured.
    """

    values: dict[str, float]
    uncertainty: dict[str, float]
    system: type[System] = Oscillator


def has_spring(known: Known, system: type[System]) -> bool:
    """Whether something pulls a rig back: its file does not state a constant stiffness of 0."""
    return system.spring is None or known.values.get(system.spring, 1.0) != 0


def known_of(measurement: Measurement) -> Known:
    """What the measurement states of its rig; the uncertainty of an input's gain is one of what it drives."""
    stated = measurement.parameters
    values = {name: quantity.value for name, quantity in stated.items()}
    uncertainty = {name: quantity.uncertainty for name, quantity in stated.items() if quantity.uncertainty}
    for name, gain in measurement.base.gains.items():
        relative = max((r.channels[name].uncertainty for r in measurement.records if name in r.channels), default=0.0)
        if relative:
            values.setdefault(gain, 1.0)
            uncertainty[gain] = hypot(relative, uncertainty.get(gain, 0.0))
    return Known(values, uncertainty, measurement.base)


def response_names(record: Record, system: type[System]) -> tuple[str, ...]:
    """The channels of a record that are fitted, the one that tells most first.

    The speed of the pinion is one only where no transmission error is declared, and an accelerometer on a casing
    never: its path from the shafts is unknown.
    """
    names = [name for name in system.responses if name in record.channels]
    if "transmission_error" in names:
        names = [name for name in names if name != "pinion_speed"]
    return tuple(name for name in names if record.channels[name].mounting != "casing")


def fitted_names(record: Record, system: type[System]) -> tuple[str, ...]:
    """The same, of which there must be one.

    Raises:
        InputError: the record has no response that can be fitted.
    """
    names = response_names(record, system)
    if not names:
        rule, remedy = f"no response of {with_article(system.name)}", f"declare one of {', '.join(system.responses)}"
        raise InputError(Problem(f"{record.name}.channels", rule, remedy=remedy, source=str(record.file)))
    return names


def fit_record(record: Record, system: type[System], spring: bool = True) -> FitRecord:
    """A record as the fits see it.

    Args:
        record: As it was loaded.
        system: Of the rig.
        spring: Whether the rig has a restoring force: without one the zero of a displacement is the initial position.

    Raises:
        InputError: the record has no response that can be fitted.
    """
    names = fitted_names(record, system)
    channels = [(_observed(record, record.channels[name], spring), record.channels[name].values) for name in names]
    inputs = {name: _input(record, record.channels[name]) for name in system.inputs if name in record.channels}
    if "pinion_angle" in inputs:
        inputs["pinion_angle"] = torch.as_tensor(between_steps(inputs["pinion_angle"].numpy()))
    uncertain = _uncertain(record)
    known = {name: quantity.value for name, quantity in record.conditions.items()}
    is_standing = known.get("pinion_speed") == 0  # a measured speed is the vibration then
    if "pinion_speed" in record.channels and "pinion_angle" not in inputs and not is_standing:
        speed = _input(record, record.channels["pinion_speed"])
        steady = steady_speed(speed)
        if steady is None:
            inputs["pinion_angle"] = _integrated(speed, record.sampling_rate)
        else:  # noise that is integrated wanders off: a mean with its error does not
            mean, error = steady
            known["pinion_speed"] = mean
            own = FreeParameter("pinion_speed", mean, error, deviation=error, expected=mean)
            uncertain = [own, *(p for p in uncertain if p.name != "pinion_speed")]
    if "pinion_angle" in record.channels:
        uncertain += _angle_errors(record, record.channels["pinion_angle"])
    parameters = {parameter.name for parameter in system.parameters}
    for name in (one for one in system.inputs if one in record.conditions and one not in parameters):
        inputs[name] = torch.full((len(record.time),), record.conditions[name].value, dtype=torch.float64)
    known = {name: value for name, value in known.items() if name not in inputs}
    first, *others = [(observed, torch.as_tensor(values, dtype=torch.float64)) for observed, values in channels]
    return FitRecord(
        record.name,
        first[1],
        record.sampling_rate,
        inputs,
        known | _means(inputs, record.sampling_rate),
        observed=first[0],
        others=tuple(others),
        own=tuple(
            p for p in uncertain if p.name not in inputs and not (p.name == "pinion_speed" and "pinion_angle" in inputs)
        ),
        stamps=None if record.uniform else _positions(record),
        held=tuple(name for name in inputs if name in record.channels and record.channels[name].hold),
    )


def _observed(record: Record, channel: Channel, spring: bool) -> Observed:
    lowpass = (Filter(channel.lowpass, channel.lowpass_order),) if channel.lowpass else ()
    highpass = (Filter(channel.highpass, channel.highpass_order, high=True),) if channel.highpass else ()
    return Observed(
        channel.name,
        offset=channel.datum == "arbitrary" and (spring or channel.name != "displacement"),
        filters=(*lowpass, *highpass) if _within_band(lowpass, record) else highpass,
        delay=channel.delay,
        shaft=channel.shaft,
        radius=channel.radius,
        drifts=channel.name == "displacement" and not spring,
        absolute=channel.frame == "absolute" and "base_acceleration" in record.channels,
        gain_uncertainty=channel.uncertainty,
    )


def _within_band(lowpass: tuple[Filter, ...], record: Record) -> bool:
    """A corner beyond the band of the record filters nothing that is in it."""
    return bool(lowpass) and lowpass[0].corner < record.sampling_rate


def _input(record: Record, channel: Channel) -> Tensor:
    """An input at evenly spaced instants, moved by what its sensor is late."""
    values = channel.values
    if not record.uniform or channel.delay:
        grid = (record.time if record.uniform else _grid(record)) + channel.delay
        at = np.clip(grid, record.time[0], record.time[-1])
        values = _kept(record, values, grid) if channel.hold else CubicSpline(record.time, values)(at)
    return torch.as_tensor(values, dtype=torch.float64)


def _kept(record: Record, values: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """The mean over every step of an even grid of what stays at each value until the next: it gives the same impulse.

    Before the first sample it was that, and after the last one it stays.
    """
    given = np.concatenate([[0.0], np.cumsum(values[:-1] * np.diff(record.time))])
    edges = np.append(grid, grid[-1] + 1 / record.sampling_rate)
    inside = np.interp(edges, record.time, given)
    before, after = np.minimum(edges - record.time[0], 0.0), np.maximum(edges - record.time[-1], 0.0)
    return np.diff(inside + values[0] * before + values[-1] * after) * record.sampling_rate


def _grid(record: Record) -> np.ndarray:
    return record.time[0] + np.arange(len(record.time)) / record.sampling_rate


def _positions(record: Record) -> Tensor:
    return torch.as_tensor((record.time - record.time[0]) * record.sampling_rate, dtype=torch.float64)


def _integrated(speed: Tensor, rate: float) -> Tensor:
    """Angle from speed, from 0 at the start."""
    return torch.cat([speed.new_zeros(1), ((speed[1:] + speed[:-1]) / (2 * rate)).cumsum(0)])


def steady_speed(speed: Tensor) -> tuple[float, float] | None:
    """Mean and standard error of a measured speed (time,) in rad/s; None where it drifts.

    Means over blocks of the record scatter about one value where the speed is steady; where a parabola through them
    takes more than chance leaves to it, the speed drifts (F test).
    """
    means = torch.stack([block.mean() for block in speed.tensor_split(SPEED_BLOCKS)])
    place = torch.linspace(-1, 1, SPEED_BLOCKS, dtype=speed.dtype)
    waves = torch.stack([place**0, place, place**2], 1)
    left = means - waves @ torch.linalg.lstsq(waves, means.unsqueeze(1)).solution[:, 0]
    total, rest = float((means - means.mean()).square().sum()), float(left.square().sum())
    free, taken = SPEED_BLOCKS - 3, 2
    if rest <= 0 or f_distribution.sf((total - rest) / taken / (rest / free), taken, free) < DRIFTS_AT:
        return None if total > 0 else (float(means.mean()), 0.0)
    return float(means.mean()), (total / (SPEED_BLOCKS - 1) / SPEED_BLOCKS) ** 0.5


def _means(inputs: dict[str, Tensor], sampling_rate: float) -> dict[str, float]:
    """Mean load and speed of a record: what depends on the operating condition follows them."""
    found = {name: float(inputs[name].mean()) for name in MEANS if name in inputs}
    if "pinion_angle" in inputs:
        angle = inputs["pinion_angle"]
        found["pinion_speed"] = float(angle[-1] - angle[0]) / (len(angle) - 1) * sampling_rate
    return found


def _angle_errors(record: Record, angle: Channel) -> list[FreeParameter]:
    """Where a shaft stands and how fast it turns beside what edges tell that are known to a sample; none elsewhere."""
    if not angle.timing_error:
        return []
    lasts = float(record.time[-1] - record.time[0])
    late = angle.timing_error * abs(float(angle.values[-1] - angle.values[0])) / lasts
    sizes = {"angle_error": late, "angle_error_rate": 12**0.5 * late / lasts}  # of a line through them
    return [FreeParameter(name, 0.0, size, deviation=size, expected=0.0) for name, size in sizes.items()]


def _uncertain(record: Record) -> list[FreeParameter]:
    """Conditions that are known with an uncertainty only."""
    uncertain = ((name, quantity) for name, quantity in record.conditions.items() if quantity.uncertainty)
    return [_expected(name, quantity) for name, quantity in uncertain]


def _expected(name: str, quantity: Quantity) -> FreeParameter:
    deviation = abs(quantity.value) * quantity.uncertainty
    return FreeParameter(name, quantity.value, deviation, deviation=deviation, expected=quantity.value)


def require_fitted(measurement: Measurement) -> None:
    """Refuse a measurement of which every record is held out.

    Raises:
        InputError: none is there to be fitted.
    """
    if {record.role for record in measurement.records} <= {"holdout", "reference"}:
        rule = "every record is held out, and none is there to be fitted"
        remedy = "write role: fit in some of them, or leave out the role of all"
        raise InputError(Problem("records", rule, remedy=remedy, source=str(measurement.source)))


def require_alike(records: Sequence[FitRecord], source: str) -> None:
    """Refuse records of which some have an input and some do not.

    Raises:
        InputError: they are not alike.
    """
    inputs = {tuple(sorted(name for name in record.inputs)) for record in records}
    if len(inputs) > 1:
        rule, remedy = "some records have a force and some do not", "explain free decays and forced records apart"
        raise InputError(Problem("records", rule, remedy=remedy, source=source))
