"""Everything that can be hidden, by name."""

from __future__ import annotations

from .effect import Effect
from .effects_contact import CONTACT
from .effects_geometry import GEOMETRY
from .effects_load import LOAD
from .effects_sensor import SENSOR
from .outside import OUTSIDE

HIDDEN: dict[str, Effect] = {effect.name: effect for effect in (*CONTACT, *GEOMETRY, *LOAD, *SENSOR)}
FOREIGN: dict[str, Effect] = {effect.name: effect for effect in OUTSIDE}
EFFECTS = tuple(HIDDEN)

# pairs that one diagnosis should name both of: no two of a class that data cannot separate
PAIRS = (
    ("pinion_eccentricity", "cubic_stiffness"), ("torque_ripple", "profile_error"),
    ("gear_eccentricity", "tooth_crack"), ("pitch_error", "hertz_stiffness"),
    ("pinion_stiffness_modulation", "sensor_offset"), ("profile_error", "coulomb_friction"),
    ("power_law_damping", "pinion_eccentricity"), ("gear_stiffness_modulation", "windage_drag"),
    ("load_dependent_contact", "gear_eccentricity"), ("shaft_angle_error", "profile_error"),
    ("cubic_stiffness", "torque_ripple"), ("hysteretic_damping", "pitch_error"),
)  # fmt: skip
FAULTS = (
    "nan_run", "dropped_samples", "repeated_stamps", "mm_for_m", "rpm_for_rad_s", "swapped_channels",
    "wrong_tooth_count", "clipped_sensor", "uneven_stamps", "oversampled", "empty_file", "mixed_rates",
)  # fmt: skip
STRATA = (
    *EFFECTS, "pairs", "null", "outside", "one_record", "one_condition", "tacho_error", "data_fault",
)  # fmt: skip
