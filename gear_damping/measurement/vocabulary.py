"""The words that measurement.yaml may use: channels, conditions and parameters of each system."""

from types import MappingProxyType as Frozen

TOP_KEYS = ("system", "parameters", "records")
RECORD_KEYS = (
    "name",
    "file",
    "role",
    "slice",
    "sampling_rate",
    "channels",
    "encoders",
    "conditions",
    "mesh_index",
)
SOURCE_KEYS = ("column", "unit")
TIME_KEYS = SOURCE_KEYS
OWN_TIME_KEYS = ("time", "sampling_rate")
SENSOR_KEYS = (
    "lowpass",
    "highpass",
    "coupling",
    "delay",
    "range",
    "noise",
    "uncertainty",
    "polarity",
    "datum",
)
CHANNEL_KEYS = SOURCE_KEYS + SENSOR_KEYS + OWN_TIME_KEYS
MOUNTED_KEYS = ("mounting", "radius")
QUANTITY_KEYS = ("value", "unit", "uncertainty")
TIMING = ("time", "sampling_rate")
GEAR_TORQUE_MODES = ("balanced", "held")
ENCODERS = ("pinion", "gear", "tacho")
ENCODER_KEYS = ("column", "timestamps", "unit", "counts_per_revolution", "index", "direction")
TACHO_KEYS = ("column", "timestamps", "unit", "pulses_per_revolution", "threshold", "direction")

# channel -> the SI unit that its values are converted to
GEAR_CHANNELS = Frozen(
    {
        "transmission_error": "m",
        "pinion_torque": "N*m",
        "gear_torque": "N*m",
        "pinion_angle": "rad",
        "pinion_speed": "rad/s",
        "acceleration": "m/s^2",
    }
)
# channel -> how many times the displacement is differentiated; None for an input
OSCILLATOR_CHANNELS = Frozen({"displacement": 0, "velocity": 1, "acceleration": 2, "force": None})
CHANNELS = Frozen({"gear_pair": tuple(GEAR_CHANNELS), "oscillator": tuple(OSCILLATOR_CHANNELS)})
SYSTEMS = tuple(CHANNELS)
INPUTS = ("pinion_torque", "gear_torque", "force")  # given to the system, not its response

CONDITIONS = Frozen(
    {
        "gear_pair": Frozen({"pinion_speed": "rad/s", "pinion_torque": "N*m", "gear_torque": "N*m"}),
        "oscillator": Frozen({"force": "own"}),
    }
)
# "own": in the units that the oscillator was measured in
PARAMETERS = Frozen(
    {
        "gear_pair": Frozen(
            {
                "n_teeth_pinion": "1",
                "n_teeth_gear": "1",
                "module": "m",
                "pressure_angle": "rad",
                "inertia_pinion": "kg*m^2",
                "inertia_gear": "kg*m^2",
                "mesh_stiffness_max": "N/m",
                "mesh_stiffness_min": "N/m",
                "contact_ratio": "1",
                "damping_ratio": "1",
                "equivalent_mass": "kg",
                "backlash_gap": "m",
                "torque_gain": "1",
                "torque_offset": "N*m",
            }
        ),
        "oscillator": Frozen({"stiffness": "1/s^2", "damping_coefficient": "1/s", "force_gain": "own"}),
    }
)
MAY_BE_ZERO = ("stiffness", "damping_coefficient", "damping_ratio", "backlash_gap")
MAY_BE_NEGATIVE = ("torque_offset", "torque_gain", "force_gain")
WHOLE = ("n_teeth_pinion", "n_teeth_gear")
