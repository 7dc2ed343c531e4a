"""Whether shafts and their mesh are as declared: the angle that advances, the speed that is stated, the ratio of two
encoders, the side to which a torque presses the flanks.
"""

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.record import Finding, Record

LARGEST_TRANSMISSION_ERROR = 1e-3  # m; a gear pair deflects by micrometres
SPEED_TOLERANCE = 0.02  # of a stated speed: about the slip of an induction motor
_COARSE = 50  # parts of a record in which a shaft is seen to advance
_ONE_WAY = 0.9  # share of the parts that turn one way
_REVERSALS = 3  # of a shaft that is turned back and forth by its drive
_STILL = 0.01  # of the way that all parts make; a part below stands still
_MEANLESS = 0.1  # of the mean size of a speed: of a shaft that turns one way the mean is all of it
_BESIDE = 0.01  # of the samples, which noise may take beyond zero
_TEETH = range(5, 301)  # tooth counts that are tried
_TURN = 2 * np.pi  # rad in one turn of a shaft


def check_shafts(record: Record) -> list[Finding | None]:
    """What is suspicious in the angle and the speed of the pinion."""
    return [_turning(record), _speed(record), _backwards(record)]


def tooth_ratio(
    pinion: NDArray[np.float64], gear: NDArray[np.float64], teeth: tuple[float, float], radius_pinion: float
) -> Finding | None:
    """The finding where the mean slopes of two shaft angles contradict the tooth counts.

    Teeth hold the shafts together: over any time the angles may depart from the ratio by the transmission error
    alone, so that the ratio is known the better the longer the shafts have turned.

    Args:
        pinion: (n,) rad.
        gear: (n,) rad.
        teeth: Declared counts of pinion and gear.
        radius_pinion: Base radius in m.
    """
    declared = teeth[1] / teeth[0]
    turned = [float(np.polyfit(np.linspace(0, 1, angle.size), angle, 1)[0]) for angle in (pinion, gear)]
    allowed = LARGEST_TRANSMISSION_ERROR / radius_pinion
    if abs(turned[0] - declared * turned[1]) <= allowed or abs(turned[1]) <= allowed:
        return None
    measured = turned[0] / turned[1]
    tolerance = allowed / abs(turned[1])
    said = f"{teeth[1]:g}/{teeth[0]:g} = {declared:.6g}"
    message = f"the two encoders turn at a ratio of {measured:.6g}, and the teeth say {said}"
    if abs(measured + declared) <= tolerance:
        remedy = "write direction: -1 beside one of them, or take it out where it stands"
        return Finding("tooth_ratio", f"{message}; one of the two directions is wrong: {remedy}")
    if abs(measured - 1 / declared) <= tolerance:
        return Finding("tooth_ratio", f"{message}; the encoders of pinion and gear, or the tooth counts, are exchanged")
    near = _nearest_teeth(abs(measured), tolerance, teeth)
    guess = f" (as {near[1]}/{near[0]} teeth would)" if near else ""
    return Finding("tooth_ratio", f"{message}{guess}; check n_teeth_pinion, n_teeth_gear and the counts per revolution")


def _nearest_teeth(ratio: float, tolerance: float, teeth: tuple[float, float]) -> tuple[int, int] | None:
    """The counts nearest to the declared ones whose ratio is the measured one; None where none in range is."""
    found = [
        (pinion, round(pinion * ratio))
        for pinion in _TEETH
        if abs(round(pinion * ratio) / pinion - ratio) <= tolerance and round(pinion * ratio) in _TEETH
    ]
    return min(found, key=lambda pair: abs(pair[0] - teeth[0]) + abs(pair[1] - teeth[1]), default=None)


def _turning(record: Record) -> Finding | None:
    """A shaft angle advances one way, apart from its encoder's noise; it may stop, and turn back over whole turns."""
    angle = record.channels.get("pinion_angle")
    if angle is None or np.ptp(angle.values) == 0:
        return None
    parts = np.diff(angle.values[:: max(1, angle.values.size // _COARSE)])
    moving = np.sign(parts[np.abs(parts) > _STILL * np.abs(parts).max()])
    if max(np.mean(moving > 0), np.mean(moving < 0)) >= _ONE_WAY:
        return None
    if np.sum(moving[1:] != moving[:-1]) <= _REVERSALS and np.ptp(angle.values) >= _TURN:
        return None
    message = "pinion_angle does not advance like that of a turning shaft; was another column taken for it?"
    return Finding("angle_not_turning", message, channel="pinion_angle")


def _speed(record: Record) -> Finding | None:
    """The stated or measured speed against the angle that was turned through."""
    angle, condition = record.channels.get("pinion_angle"), record.conditions.get("pinion_speed")
    measured = record.channels.get("pinion_speed")
    if angle is None or not (condition or measured):
        return None
    if condition:
        stated = fastest = condition.value
    else:
        stated = float(np.trapezoid(measured.values, record.time)) / record.duration
        fastest = float(np.mean(np.abs(measured.values)))
    rate = float(angle.values[-1] - angle.values[0]) / record.duration
    allowed = max(SPEED_TOLERANCE, 3 * (condition.uncertainty if condition else measured.uncertainty))
    is_fluctuation = not condition and abs(stated) < _MEANLESS * fastest  # what a coupled sensor leaves of a speed
    if abs(rate - stated) <= allowed * abs(fastest) or stated == 0 or is_fluctuation:
        return None
    message = (
        f"the pinion angle turns at {rate * 30 / np.pi:.5g} rpm and the stated speed is "
        f"{stated * 30 / np.pi:.5g} rpm; check unit, direction and counts per revolution"
    )
    return Finding("speed_mismatch", message, channel="pinion_angle")


def _backwards(record: Record) -> Finding | None:
    """The note that the pinion turns against the torque that drives it."""
    torque, known = record.channels.get("pinion_torque"), record.conditions.get("pinion_torque")
    angle, speed = record.channels.get("pinion_angle"), _pinion_speed(record)
    if (torque is None and known is None) or (angle is not None and np.ptp(angle.values) < _TURN):
        return None
    load = np.atleast_1d(known.value if torque is None else torque.values)
    if np.any(load * speed >= 0):
        return None
    message = (
        f"the pinion turns at {speed * 30 / np.pi:.5g} rpm under a torque of {np.mean(load):.3g} N m that drives it "
        "the other way, and each shaft counts positive in its own sense of driving; where the gear drives it so, "
        "nothing is to be done; else change the direction of encoders (direction: -1), the polarity of a measured "
        "angle or speed (polarity: -1), or the sign of a speed or torque under conditions"
    )
    return Finding("turns_backwards", message, channel="" if angle is None else angle.name, severity="note")


def other_side(record: Record, n_teeth: tuple[float, float]) -> Finding | None:
    """A transmission error with a zero of its own that is, throughout, where the torque parts the flanks.

    Over a turn of both shafts errors of the teeth and of their seats are on either side; of less it is a note.

    Args:
        record: One of a gear pair.
        n_teeth: Teeth of the pinion and of the gear.
    """
    error, torque = record.channels.get("transmission_error"), record.channels.get("pinion_torque")
    known = record.conditions.get("pinion_torque")
    if error is None or error.datum != "absolute" or (torque is None and known is None):
        return None
    load = np.atleast_1d(known.value if torque is None else torque.values)
    way = np.sign(np.median(load))
    if np.any(way * load <= 0) or np.quantile(way * error.values, 1 - _BESIDE) >= 0:
        return None
    low, high = (end / error.declared_factor for end in (error.values.min(), error.values.max()))
    message = (
        f"transmission_error lies between {low:.3g} and {high:.3g} {error.declared_unit}, on the side to which a "
        f"torque of {np.mean(load):.3g} N m does not press the flanks; write polarity: -1 where it counts the other "
        "way round, or datum: arbitrary where its zero means nothing"
    )
    turns = abs(_pinion_speed(record)) * record.duration / _TURN * min(1.0, n_teeth[0] / n_teeth[1])
    severity = "data_problem" if turns >= 1 else "note"
    return Finding("other_side", message, record.name, "transmission_error", severity=severity)


def _pinion_speed(record: Record) -> float:
    """Its mean in rad/s, by its angle, else its speed; 0 where neither tells it."""
    angle, speed = record.channels.get("pinion_angle"), record.channels.get("pinion_speed")
    stated = record.conditions.get("pinion_speed")
    if angle is not None:
        return float(angle.values[-1] - angle.values[0]) / record.duration
    if speed is not None and speed.coupling != "AC":
        return float(np.mean(speed.values))
    return stated.value if stated else 0.0


def mesh_beyond_band(record: Record, n_teeth: float) -> Finding | None:
    """The note that teeth mesh faster than half the sampling rate; of shafts whose speed is not told, None.

    Args:
        record: One of a gear pair.
        n_teeth: Teeth of the pinion.
    """
    mesh, half = abs(_pinion_speed(record)) * n_teeth / _TURN, record.sampling_rate / 2
    if mesh <= half:
        return None
    message = (
        f"the teeth mesh at {mesh:.4g} Hz, above half the sampling rate, {half:.4g} Hz: "
        "the mesh is filtered away, or folds back onto lower frequencies"
    )
    return Finding("mesh_beyond_band", message, record.name, severity="note")
