"""Shafts whose angle nobody recorded: the speed that is stated of a record is that of a drive, never quite steady."""

from collections.abc import Sequence
from math import pi

from gear_damping.explanation.evidence.records import Evidence, with_own
from gear_damping.explanation.evidence.slow_rotation import VARIES
from gear_damping.identification.output_error.records import FitRecord, FreeParameter

MOST = 3.0  # such deviations, at which the search of a model that lacks something is held


def with_unsteady_shafts(evidence: Evidence) -> Evidence:
    """The same where the speed of every record whose shaft angle nobody recorded may vary a little."""
    return with_own(evidence, _unsteady)


def has_unsteady_shafts(records: Sequence[FitRecord]) -> bool:
    """Whether the speed of one of them may vary."""
    return any(parameter.name == "pinion_jerk" for record in records for parameter in record.own)


def _unsteady(record: FitRecord) -> tuple[FreeParameter, ...]:
    """What a record has of its own, and three numbers for how its speed goes.

    Within bounds, or what the model does not know yet would bend them.
    """
    speed = record.conditions.get("pinion_speed", 0.0)
    if "pinion_angle" in record.inputs or not speed:
        return record.own
    told = {parameter.name for parameter in record.own}
    rate, varies = 2 * pi / record.duration, VARIES * abs(speed)
    sizes = {"pinion_speed": varies, "pinion_acceleration": varies * rate, "pinion_jerk": varies * rate**2}
    initial = {"pinion_speed": speed}
    return (
        *record.own,
        *(_near(name, initial.get(name, 0.0), size) for name, size in sizes.items() if name not in told),
    )


def _near(name: str, value: float, size: float) -> FreeParameter:
    ends = {"lower": value - MOST * size, "upper": value + MOST * size}
    return FreeParameter(name, value, size, deviation=size, expected=value, **ends)
