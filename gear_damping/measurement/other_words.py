"""What people write in a measurement.yaml in the place of its keys, with the remedy of each.

The nearest key is no remedy of these: `helix_angle` is no `pressure_angle`, and `gear_speed` no `gear_torque`.
"""

from collections.abc import Mapping
from types import MappingProxyType as Frozen


def _each(words: str, remedy: str) -> dict[str, str]:
    return dict.fromkeys(words.split(), remedy)


_AS_COMMENT = "leave it out, or write it as a comment, behind #"
_LOOKED_FOR = "leave it out: how a table is written is found in the file"
_RATE = "write sampling_rate, as sampling_rate: 2 kHz"
_ENCODERS = "write encoders beside channels, with pinion and gear below it, each {column: …, counts_per_revolution: …}"
_PINION = "write pinion_speed: that of the gear times n_teeth_gear over n_teeth_pinion"
_GEAR_PAIR = "write n_teeth_pinion and n_teeth_gear"
_WHOLE = "leave it out: stiffnesses are those of the whole face width"
_FREQUENCY = "write stiffness: (2 pi f)^2 in 1/s^2, for 1.3 Hz {value: 66.7, unit: 1/s^2}"
_CONSTANT = "write what was constant under conditions, as pinion_speed or pinion_torque, else under channels"

RATES = Frozen(_each("fs Fs rate sample_rate samplerate sampling_frequency sample_frequency", _RATE))
OF_A_RECORD: Mapping[str, str] = Frozen(
    {
        **RATES,
        **_each("rows row_range range", "write slice: [a, b], the rows a to b-1 counted from 0"),
        **_each("skiprows skip_rows header header_lines delimiter separator sep decimal encoding", _LOOKED_FOR),
        **_each("sheet sheet_name", "write it before the name of each column, column: Run 1/TE"),
        **_each("comment comments note notes description date operator title temperature", _AS_COMMENT),
        **_each("data path filename csv", "write file, with the name of the file"),
        **_each("start end begin stop", "write window: {from: 1, to: 3, unit: s}"),
        **_each("inputs outputs signals columns sensors", "write channels"),
    }
)
OF_A_GEAR_RECORD: Mapping[str, str] = Frozen({**OF_A_RECORD, **_each("speed rpm torque load", _CONSTANT)})
OF_A_FILE: Mapping[str, str] = Frozen(
    {
        **_each("measurements measurement runs tests files data experiments", "write records"),
        **_each("version comment comments note notes description date title author operator", _AS_COMMENT),
    }
)
OF_GEAR_CHANNELS: Mapping[str, str] = Frozen(
    {
        **_each("te TE dte DTE lte LTE ste STE error displacement", "write transmission_error"),
        **_each("torque input_torque motor_torque drive_torque", "write pinion_torque, or gear_torque of the load"),
        **_each("load load_torque output_torque brake_torque", "write gear_torque"),
        **_each("speed rpm input_speed motor_speed", "write pinion_speed"),
        **_each("output_speed load_speed", "write gear_speed"),
        **_each("pinion_encoder gear_encoder encoder_pinion encoder_gear", _ENCODERS),
        **_each("angle theta", "write pinion_angle, or encoders beside channels of the gear's"),
    }
)
OF_GEAR_CONDITIONS: Mapping[str, str] = Frozen(
    {
        **_each("gear_speed output_speed load_speed", _PINION),
        **_each("speed rpm input_speed motor_speed", "write pinion_speed"),
        **_each("torque input_torque motor_torque drive_torque", "write pinion_torque, or gear_torque of the load"),
        **_each("load load_torque output_torque brake_torque", "write gear_torque"),
        **_each("temperature oil_temperature oil lubricant", _AS_COMMENT),
    }
)
OF_OSCILLATOR_CONDITIONS: Mapping[str, str] = Frozen(
    {
        **_each("load torque voltage excitation input", "write force"),
        **_each("temperature mass amplitude frequency speed rpm", _AS_COMMENT),
    }
)
OF_GEAR_PARAMETERS: Mapping[str, str] = Frozen(
    {
        **_each("z1 z2 N1 N2 teeth n_teeth number_of_teeth", _GEAR_PAIR),
        **_each(
            "helix_angle beta",
            "leave it out, and write module and pressure_angle of the transverse plane: the normal module over "
            "cos(helix angle), and the angle whose tangent is that of the normal one over cos(helix angle)",
        ),
        **_each("face_width width facewidth", _WHOLE),
        **_each("diametral_pitch DP", "write module: 25.4 mm over the diametral pitch"),
        **_each("J1 I1 pinion_inertia", "write inertia_pinion"),
        **_each("J2 I2 gear_inertia", "write inertia_gear"),
        **_each("stiffness mesh_stiffness", "write mesh_stiffness_max and mesh_stiffness_min"),
        **_each("mass", "write equivalent_mass, or inertia_pinion and inertia_gear"),
        **_each("zeta damping", "write damping_ratio"),
        **_each("center_distance centre_distance", "leave it out: module and teeth say it"),
    }
)
OF_AN_OSCILLATOR: Mapping[str, str] = Frozen(
    {
        **_each("zeta damping", "write damping_ratio"),
        **_each("frequency f0 fn omega_n omega0 resonance_frequency", _FREQUENCY),
        **_each("quality_factor Q", "write damping_ratio: 1/(2 Q), for 25 damping_ratio: 2 %"),
        **_each(
            "log_decrement logarithmic_decrement", "write damping_ratio: the decrement over 2 pi, where it is small"
        ),
        **_each("k", "write stiffness: k over the mass, in 1/s^2"),
        **_each("c", "write damping_coefficient: c over the mass, in 1/s"),
    }
)
OF_A_CHANNEL: Mapping[str, str] = Frozen(
    {
        **RATES,
        **_each("invert reverse reversed flip", "write polarity: -1"),
        **_each("filter cutoff bandwidth", "write lowpass, or highpass, with its frequency: lowpass: 1 kHz"),
        **_each("header name index field signal channel col", "write column: its header text, or its 0-based index"),
        **_each(
            "bias zero", "write datum: arbitrary where its zero is not known; a known one is subtracted in the file"
        ),
        **_each("full_scale fullscale", "write range"),
        **_each("radius_mm", "write radius: 30 mm"),
    }
)
ROLES: Mapping[str, str] = Frozen(
    {
        **_each("train training calibration identification fitting", "fit"),
        **_each("test testing validation validate val verify verification", "holdout"),
        **_each("baseline healthy sound", "reference"),
    }
)
