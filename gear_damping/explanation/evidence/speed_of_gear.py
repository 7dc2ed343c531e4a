"""The speed of a pinion as a speed meter on the gear tells it, where no angle was recorded."""

from collections.abc import Sequence
from dataclasses import replace

import torch

from gear_damping.explanation.evidence.slow_rotation import VARIES
from gear_damping.identification.observation import steady_speed
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.measurement.record import Record

SPEED = "pinion_speed"
AGREES = 3.0  # deviations of what is stated: a meter that is farther off has lost its mean, or another scale


def with_speed_of_gear(records: Sequence[FitRecord], measured: Sequence[Record], gear_ratio: float) -> list[FitRecord]:
    """Records that begin at the mean of a gear speed that was measured, where that agrees with the speed as stated.

    A mesh of many teeth is soon turned away from its angle by a speed that is stated to a part in a thousand; what is
    expected of the speed stays as it was stated, since the scale of a meter is not exact either.

    Args:
        records: As fits see them.
        measured: As they were loaded.
        gear_ratio: Speed of the gear over that of the pinion.
    """
    return [_of_one(record, source, gear_ratio) for record, source in zip(records, measured, strict=True)]


def _of_one(record: FitRecord, measured: Record, gear_ratio: float) -> FitRecord:
    stated, channel = record.conditions.get(SPEED), measured.channels.get("gear_speed")
    if not stated or channel is None or "pinion_angle" in record.inputs or SPEED in measured.channels:
        return record
    steady = steady_speed(torch.as_tensor(channel.values, dtype=torch.float64) / gear_ratio)
    own = next((parameter for parameter in record.own if parameter.name == SPEED), None)
    deviation = own.deviation if own else VARIES * abs(stated)
    if steady is None or not 0 < abs(steady[0] - stated) <= AGREES * deviation:
        return record
    others = [parameter for parameter in record.own if parameter is not own]
    own = [replace(own, start=steady[0])] if own else []
    return replace(record, conditions=record.conditions | {SPEED: steady[0]}, own=(*own, *others))
