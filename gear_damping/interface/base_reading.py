"""Whether records of a rig on a moving base are followed far better with another sign, unit or frame than declared."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.record import Measurement, Record
from gear_damping.physics.systems.swinging import BASE
from gear_damping.units import parse_unit

Array = NDArray[np.complex128]
GRAVITY = parse_unit("gn").factor
GAINS = (1.0, -1.0, GRAVITY, -GRAVITY, 1 / GRAVITY, -1 / GRAVITY)  # a wrong sign, and g for m/s^2 or the reverse
DERIVATIVES = {"displacement": 0, "velocity": 1, "acceleration": 2}  # of the motion, by channel
LOUD = 1e-3  # of the largest line of the response: below it there may be noise alone
FOLLOWED = 0.2  # of the inertia force that may be left: what is read right leaves some hundredths, behind a window
BETTER = 3.0  # times less than as declared: noise and a weak non-linearity make a reading no better by that much


@dataclass(frozen=True)
class _Spectra:
    """Windowed lines of one record: i omega, the response, the base, and how often the response is differentiated."""

    rate: Array
    response: Array
    base: Array
    order: int
    frame: str | None

    def left(self, gain: float, frame: str) -> float:
        """What x'' + c x' + k x = -gain a_b leaves at best, relative to what the response shows of x''."""
        relative = self.response - gain * self.base if frame == "absolute" else self.response
        motion, base = relative / self.rate**self.order, gain * self.base / self.rate**2
        wanted, terms = -(motion + base), np.stack([motion / self.rate, motion / self.rate**2], axis=1)
        rows = np.concatenate([terms.real, terms.imag])
        right = np.concatenate([wanted.real, wanted.imag])
        found, *_ = np.linalg.lstsq(rows, right, rcond=None)
        return float(np.linalg.norm(rows @ found - right) / np.linalg.norm(self.response / self.rate**self.order))


def base_reading(measurement: Measurement) -> str | None:
    """A sentence where another reading of the base's acceleration follows the records; None where none does."""
    spectra = list(_spectra(measurement))
    if not spectra:
        return None
    stated = spectra[0].frame or "relative"
    readings = [(gain, stated) for gain in GAINS]
    if all(one.order == DERIVATIVES["acceleration"] for one in spectra):  # others are relative to the base
        readings.append((1.0, "absolute" if stated == "relative" else "relative"))
    left = {one: max(record.left(*one) for record in spectra) for one in readings}
    best = min(left, key=left.get)
    if best == (1.0, stated) or left[best] > min(FOLLOWED, left[1.0, stated] / BETTER):
        return None
    return f"the records are followed far better where {_said(*best)}: check that in the file"


def _said(gain: float, frame: str) -> str:
    """What differs from what is declared, one of gain and frame."""
    if gain == 1.0:
        return f"the response is {frame} (`frame: {frame}`)"
    sign = f"{BASE} has the other sign (`polarity: -1`)" if gain < 0 else ""
    if abs(gain) == 1:
        return sign
    wrong, right = ("m/s^2", "g") if abs(gain) > 1 else ("g", "m/s^2")
    unit = f"{BASE} is in {right} and not in {wrong}, or the response is the reverse"
    return f"{sign} and {unit}" if sign else unit


def _spectra(measurement: Measurement) -> Iterator[_Spectra]:
    """The lines of every record to fit that has a base's acceleration."""
    for record in measurement.records:
        names = [name for name in DERIVATIVES if name in record.channels]
        if record.role in ("fit", None) and BASE in record.channels and names:
            yield _of_record(record, names[0])


def _of_record(record: Record, name: str) -> _Spectra:
    channel, base = record.channels[name], record.channels[BASE]
    step = (record.time[-1] - record.time[0]) / (len(record.time) - 1)
    rate = 2j * np.pi * np.fft.rfftfreq(len(record.time), step)[1:]
    lines = [_lines(np.asarray(one.values, dtype=float)) for one in (channel, base)]
    loud = np.abs(lines[0]) ** 2 > LOUD * np.max(np.abs(lines[0]) ** 2)
    return _Spectra(rate[loud], lines[0][loud], lines[1][loud], DERIVATIVES[name], channel.frame)


def _lines(values: NDArray[np.float64]) -> Array:
    return np.fft.rfft((values - values.mean()) * np.hanning(len(values)))[1:]
