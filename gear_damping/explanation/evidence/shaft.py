"""Angle of the pinion during a record."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.systems.gear_pair import teeth_of
from gear_damping.physics.systems.traits import Trait

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Shaft:
    """Angle of the pinion in rad by sample, and the tooth counts."""

    angle: Array
    teeth: tuple[int, int]


def shaft_of(record: FitRecord, evidence: Evidence) -> Shaft | None:
    """The shaft of a record; None where none turns."""
    if not evidence.has(Trait.SHAFTS):
        return None
    pinion, gear = teeth_of(evidence.parameters)
    teeth = (round(pinion), round(gear))
    if "pinion_angle" in record.inputs:
        return Shaft(record.at_samples("pinion_angle").numpy(), teeth)
    time = record.instants.numpy() / record.sampling_rate
    start, speed = record.conditions.get("pinion_angle", 0.0), record.conditions.get("pinion_speed", 0.0)
    return Shaft(start + speed * time, teeth)
