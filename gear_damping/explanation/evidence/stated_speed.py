"""A speed that is stated of one record and is another one's: its mesh stands elsewhere than that speed puts it."""

from math import pi

import numpy as np
from numpy.typing import NDArray

from gear_damping.explanation.evidence.data_faults import FAINT, HARMONICS, STRONG
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.shaft import shaft_of
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.measurement.record import Finding
from gear_damping.physics.systems.traits import Trait

FEWEST = 2  # of them that a sampling rate must hold, and that must stand out: one line may be the structure's
NEAR, FAR = 0.01, 0.25  # of the stated speed: a nearer one is its uncertainty; farther, combs of other orders lie too
FEWEST_TEETH = 50  # that pass in a record: of fewer, combs a hundredth apart are not told apart
OUT = 10.0  # times what is usual at other speeds: a harmonic that stands out
WIDTH = 1.5  # lines of a spectrum on either side that a wave with a Hann window fills
FINE = 4  # trial frequencies to the width of a line of the highest harmonic


def stated_speed_faults(evidence: Evidence) -> list[Finding]:
    """A finding for each record whose mesh stands where another speed than the stated one puts it.

    Other records must have theirs where they are stated: a tooth count that is wrong moves all of them.
    """
    if not evidence.has(Trait.TEETH):
        return []
    told = [record for record in evidence.records if _is_stated(record)]
    counted = {record.name: _counted(record, evidence) for record in told}
    kept = [name for name, one in counted.items() if one is not None and one[0] >= STRONG]
    return [
        _finding(record, one[1], evidence)
        for record in told
        if kept and (one := counted[record.name]) is not None and one[1] is not None
    ]


def _is_stated(record: FitRecord) -> bool:
    """Whether a record turns at a speed that is stated and steady, no angle of it being measured."""
    changing = any(record.conditions.get(name) for name in ("pinion_acceleration", "pinion_jerk"))
    return bool(record.conditions.get("pinion_speed")) and "pinion_angle" not in record.inputs and not changing


def _counted(record: FitRecord, evidence: Evidence) -> tuple[float, float | None] | None:
    """The share of the comb of the stated mesh, and the factor by which another one stands elsewhere.

    None of a record that is too short or too coarse; the factor is None where the stated comb is there, or none is.
    """
    teeth = shaft_of(record, evidence).teeth[0]
    mesh = teeth * abs(record.conditions["pinion_speed"]) / (2 * pi)
    seconds = len(record.response) / record.sampling_rate
    count = min(int(record.sampling_rate / (2 * (1 + FAR) * mesh)), HARMONICS)
    if mesh * seconds < FEWEST_TEETH or count < FEWEST:
        return None
    power = _power(record.response.numpy())
    factors = np.arange(1 - FAR, 1 + FAR, 1 / (FINE * count * mesh * seconds))
    combs = np.array([_comb(power, factor * mesh * seconds, count) for factor in factors])  # (factors, harmonics)
    shares, is_near = combs.sum(1), np.abs(factors - 1) <= NEAR
    own, at = float(shares[is_near].max()), int(np.where(is_near, 0.0, shares).argmax())
    is_comb = np.count_nonzero(combs[at] >= OUT * np.median(combs, 0)) >= FEWEST
    is_elsewhere = shares[at] >= STRONG and own <= FAINT * shares[at] and is_comb
    return own, float(factors[at]) if is_elsewhere else None


def _power(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Share of a record's variance by line of its spectrum, with a Hann window."""
    power = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(len(values)))) ** 2
    return power / max(power.sum(), 1e-300)


def _comb(power: NDArray[np.float64], line: float, count: int) -> NDArray[np.float64]:
    """The share of each of the first harmonics of a frequency, in lines of the spectrum."""
    ends = [(round(h * line - WIDTH), round(h * line + WIDTH) + 1) for h in range(1, count + 1)]
    return np.array([power[max(first, 0) : stop].sum() for first, stop in ends])


def _finding(record: FitRecord, factor: float, evidence: Evidence) -> Finding:
    stated = 60 * record.conditions["pinion_speed"] / (2 * pi)
    message = (
        f"its mesh stands where a pinion_speed of {factor * stated:.5g} rpm puts it, and {stated:.5g} rpm are stated: "
        "correct the speed, or the file that the record names"
    )
    return Finding("other_speed", message, record=record.name, channel=evidence.channel.name)
