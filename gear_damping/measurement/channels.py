"""The channels of measurement.yaml: which keys each takes, what acts on them, and why the others are refused."""

from collections.abc import Mapping
from types import MappingProxyType as Frozen
from typing import Annotated, ClassVar

from pydantic import model_validator

from gear_damping.errors import InputError, Problem
from gear_damping.measurement import other_words as words
from gear_damping.measurement.angular_error import is_angle, is_angular_acceleration
from gear_damping.measurement.quantities import PERIODS, Column, Corner, Cutoff, Gain, Measured, Rate, Share
from gear_damping.measurement.record import Quantity
from gear_damping.schema.mappings import Declared, Path, key
from gear_damping.schema.values import Flag, OneOf, Text, refuse
from gear_damping.units import spoken

Reasons = Frozen[str, tuple[str, str]]


class Stamps(Declared):
    """The column of the time stamps."""

    title: ClassVar[str] = "a time column"
    column: Annotated[str | int, Column()] = key(
        "Column of the time stamps.", "time base", missing="name the column of the time stamps"
    )
    unit: Annotated[str, Text()] = key("Unit of the stamps; absent, that of the column's header.", "time base")

    @classmethod
    def not_a_mapping(cls, place: Path, value: object) -> tuple[str, str]:
        """Rule and remedy where something else, a value, stands at `place`."""
        rule, remedy = super().not_a_mapping(place, value)
        is_column = isinstance(value, str | int) and not isinstance(value, bool)
        return rule, f"write {place[-1]}: {{column: {value}, unit: s}}, or its unit" if is_column else remedy


class Timed(Declared):
    """Time stamps or a rate."""

    meant: ClassVar[Mapping[str, str]] = Frozen({**PERIODS, **words.RATES})
    time: Stamps = key("Time stamps. Small jitter is put on a grid; uneven stamps are kept.", "time base")
    sampling_rate: Annotated[Quantity, Rate()] = key("Constant rate, instead of `time`.", "time base")

    @model_validator(mode="after")
    def _one_time_base(self) -> "Timed":
        if self.given("time") and self.given("sampling_rate"):
            rule = "time and sampling_rate are both given"
            refuse(rule, self.sampling_rate.value, "keep the one that is right", "sampling_rate")
        return self


SEVERAL = "lists several sensors, and a record takes one"  # how the rule begins that refuses a list of them
_GAIN = "write gain, by which values are divided: what the column holds for one unit of the quantity"
_SCALES = {
    **dict.fromkeys(("scale", "factor", "sensitivity", "calibration", "scaling", "multiplier"), _GAIN),
    "offset": "write datum: arbitrary where its zero is not known; a known one is subtracted in the file",
    "file": "write file beside channels: a record reads one file, into which its channels must be put together",
    "inverted": "write polarity: -1",
    "sign": "write polarity: -1 for a reversed sensor",
}


class AnyChannel(Timed):
    """What every channel takes: its column, its unit, its own time base, its sign and its scale."""

    meant: ClassVar[Mapping[str, str]] = Frozen({**PERIODS, **_SCALES, **words.OF_A_CHANNEL})
    si: ClassVar[str | None] = None  # the unit that values are converted to; None: the rig's own
    derivative: ClassVar[int | None] = None  # of an oscillator's displacement; None for an input
    is_input: ClassVar[bool] = False

    @classmethod
    def not_a_mapping(cls, place: Path, value: object) -> tuple[str, str]:
        """Rule and remedy where something else, a value, stands at `place`; several sensors are a list."""
        if isinstance(value, str | int) and not isinstance(value, bool):
            rule, remedy = super().not_a_mapping(place, value)[0], f"write {place[-1]}: {{column: {value}, unit: …}}"
            constant = f"write a value that was constant under conditions, and a column as {place[-1]}: "
            return rule, f"{constant}{{column: …, unit: …}}" if spoken(value) else remedy
        if not isinstance(value, list) or len(value) < 2 or not all(isinstance(one, dict) for one in value):
            return super().not_a_mapping(place, value)
        remedy = "keep one, without the list; declare each of the others in a measurement.yaml of its own beside the "
        return f"{SEVERAL} {place[-1]}", f"{remedy}same file, and compare what comes out"

    column: Annotated[str | int, Column()] = key(
        "Header text without its quotes, or 0-based index.", "values",
        missing="name the column by its header text or its 0-based index",
    )  # fmt: skip
    unit: Annotated[str, Text()] = key("Unit of the values; absent, that of the column's header.", "values")
    polarity: Annotated[int, OneOf((1, -1))] = key("Sign that the values are multiplied by.", "values", 1)
    gain: Annotated[float, Gain(nonzero=True)] = key(
        "The file's value over the quantity: values are divided by it, and `unit` is that of the quantity.",
        "values",
        1.0,
    )


class Delayed(AnyChannel):
    """A channel that may be late."""

    delay: Annotated[Quantity, Measured("s", "any")] = key(
        "How late the channel is behind the others.", "response: the prediction is delayed; input: the series is moved"
    )


class Ranged(AnyChannel):
    """A channel with a full scale."""

    range: Annotated[Quantity, Measured(None)] = key(
        "Full scale of the sensor, ±; of a WAV file, what ±1 stands for.",
        "check: samples at it are clipped, and where none is, none is",
    )


class Scaled(AnyChannel):
    """A channel whose gain may be uncertain."""

    uncertainty: Annotated[float, Share()] = key(
        "Relative standard uncertainty of the gain; 0 means known.", "prior on the gain", 0.0
    )


class Response(Delayed, Ranged, Scaled):
    """What a simulation is compared with."""

    usual_datum: ClassVar[str] = "absolute"
    lowpass: Annotated[Corner, Cutoff()] = key("Low-pass of the sensor or its amplifier.", "filters the prediction")
    noise: Annotated[Quantity, Measured(None)] = key(
        "Standard deviation of the sensor's noise; absent, it is estimated.", "weight of the channel"
    )
    highpass: Annotated[Corner, Cutoff(usual=1)] = key(
        "High-pass of the sensor or its amplifier.", "filters the prediction"
    )

    coupling: Annotated[str, OneOf(("DC", "AC"))] = key(
        "`AC`: the channel has lost its mean, so that its datum is arbitrary.", "offset of each record", "DC"
    )
    datum: Annotated[str, OneOf(("absolute", "arbitrary"))] = key(
        "`arbitrary`: the zero means nothing, and every record has an offset of its own. Absent, arbitrary for an "
        "oscillator's displacement, an acceleration, the speed of a shaft and whatever is AC-coupled, absolute "
        "otherwise.", "offset of each record",
    )  # fmt: skip

    @model_validator(mode="after")
    def _filters(self) -> "Response":
        problems = []
        if self.lowpass and self.highpass and self.lowpass.frequency <= self.highpass.frequency:
            rule = "must lie above highpass"
            problems.append(Problem("lowpass", rule, self.lowpass.frequency, "exchange the two"))
        if self.coupling == "AC" and self.datum == "absolute":
            rule = "an AC-coupled channel has lost its mean, so that its zero cannot be absolute"
            problems.append(Problem("datum", rule, self.datum, "leave out datum: absolute, or coupling: AC"))
        if problems:
            raise InputError(problems)
        return self


def _input_reasons(offset: str) -> Reasons:
    driven = "an input is what drives the simulation, taken as it was recorded"
    return Frozen(
        {
            "lowpass": (f"{driven}, and what a filter took away cannot be given back", "declare the filter's delay"),
            "highpass": (f"{driven}, and what a filter took away cannot be given back", offset),
            "coupling": (f"{driven}, with its mean", offset),
            "datum": (f"{driven}, with its mean", offset),
            "noise": (f"{driven}; its noise is not weighed", "leave it out: it is a part of what the fit leaves"),
        }
    )


class Held(AnyChannel):
    """An input that may stay at each value until the next sample."""

    hold: Annotated[bool, Flag()] = key(
        "Whether each value stays until the next sample, as a controller puts it out, however uneven the stamps are; "
        "absent, it does where the series switches between few levels, or stands still and jumps. Otherwise the series "
        "is smooth between samples.", "input between samples",
    )  # fmt: skip


class Input(Held, Delayed, Ranged, Scaled):
    """A torque, a force or the motion of the base: what drives the simulation."""

    is_input: ClassVar[bool] = True


class Torque(Input):
    """A torque in N*m."""

    title: ClassVar[str] = "a torque"
    si: ClassVar[str | None] = "N*m"
    refused: ClassVar[Reasons] = _input_reasons("declare parameters.torque_offset with its uncertainty")


class GearTorque(Held, Delayed, Ranged):
    """The torque on the gear in N*m."""

    title: ClassVar[str] = "the gear's torque"
    si: ClassVar[str | None] = "N*m"
    is_input: ClassVar[bool] = True
    refused: ClassVar[Reasons] = Frozen(
        {
            **_input_reasons("leave it out"),
            "uncertainty": (
                "an uncertain gain is fitted of the pinion's torque meter alone, because only one of the two shows",
                "declare it for pinion_torque",
            ),
        }
    )


class Force(Input):
    """A force in any unit."""

    title: ClassVar[str] = "a force"
    refused: ClassVar[Reasons] = _input_reasons("leave it out: a constant force is allowed for beside any input")


class BaseAcceleration(Delayed, Ranged):
    """The acceleration of the base."""

    title: ClassVar[str] = "the acceleration of the base"
    is_input: ClassVar[bool] = True
    refused: ClassVar[Reasons] = Frozen(
        {
            **_input_reasons("leave it out: a constant force is allowed for beside any input"),
            "uncertainty": (
                "only the ratio of the gains of base and response shows",
                "declare the uncertainty of the response's gain",
            ),
        }
    )


_ANGLE = "an angle says where the shaft stands"
_COUNTED = "a turn is a turn: the scale of an angle is known"


class Angle(Delayed):
    """The angle of the pinion."""

    title: ClassVar[str] = "the pinion angle"
    si: ClassVar[str | None] = "rad"
    timing_error: Annotated[Quantity, Measured("s")] = key(
        "Standard deviation by which all of the angle may be late, as where edges of pulses are known to a sample.",
        "prior on where each record begins and on its speed",
    )
    refused: ClassVar[Reasons] = Frozen(
        {
            **_input_reasons("leave it out"),
            "range": (f"{_ANGLE}; it wraps and has no full scale", "leave it out"),
            "uncertainty": (_COUNTED, "leave it out"),
            "noise": (f"{_ANGLE}; an error of the encoder is allowed for by itself", "leave it out"),
            "coupling": (f"{_ANGLE}, and has no mean", "leave it out"),
            "datum": (f"{_ANGLE}, counted from anywhere", "write mesh_index: true where its zero is that of the mesh"),
        }
    )


class Speed(Response):
    """The speed of a shaft."""

    title: ClassVar[str] = "a speed"
    si: ClassVar[str | None] = "rad/s"
    usual_datum: ClassVar[str] = "arbitrary"
    radius: Annotated[Quantity, Measured("m")] = key(
        "Of a velocity along the circumference (a vibrometer's, `unit: mm/s`): the radius at which it is measured.",
        "values: the velocity is divided by it",
    )

    @model_validator(mode="after")
    def _fluctuates(self) -> "Speed":
        if self.datum == "absolute":
            rule = "what is compared of a speed is its fluctuation, whose zero is always arbitrary"
            refuse(rule, self.datum, "leave it out", "datum")
        return self


class GearSpeed(Speed):
    """The speed of the gear."""

    title: ClassVar[str] = "the speed of the gear"

    @model_validator(mode="after")
    def _uncoupled(self) -> "GearSpeed":
        if self.coupling == "AC":
            rule = "what is compared of this speed is its fluctuation, whatever its coupling"
            refuse(rule, self.coupling, "leave it out; the corner of an AC coupling is a highpass", "coupling")
        return self


class TransmissionError(Response):
    """x = r_b1 theta_1 - r_b2 theta_2 along the line of action."""

    title: ClassVar[str] = "a transmission error"
    si: ClassVar[str | None] = "m"
    shaft: Annotated[str, OneOf(("pinion", "gear"))] = key(
        "Of a transmission error in a unit of an angle (`arcsec`, `urad`): the shaft whose angle it is.",
        "length along the line of action: the angle times the base radius of that shaft",
    )

    @model_validator(mode="after")
    def _of_a_shaft(self) -> "TransmissionError":
        if self.unit is not None and is_angle(self.unit) and not self.given("shaft"):
            rule = f"a transmission error in '{self.unit}' is the angle of a shaft, and nothing says of which"
            refuse(rule, None, "write shaft: pinion (or gear), whose base radius makes it a length", "shaft")
        if self.given("shaft") and self.unit is not None and not is_angle(self.unit):
            rule = "has a meaning only for a transmission error in a unit of an angle"
            refuse(rule, self.shaft, "leave it out, or state the unit, as arcsec", "shaft")
        return self


CASING = "the path from the mesh to a casing is unknown, its gain, delay and zero too"
OF_A_SHAFT = (
    "shaft", "radius", "lowpass", "highpass", "coupling", "delay", "noise", "uncertainty", "datum", "polarity",
)  # fmt: skip


class GearAcceleration(Response):
    """An accelerometer on a shaft, at a radius, or on the casing."""

    title: ClassVar[str] = "the acceleration of a gear pair"
    usual_datum: ClassVar[str] = "arbitrary"
    si: ClassVar[str | None] = "m/s^2"
    mounting: Annotated[str, OneOf(("tangential", "casing"))] = key(
        "`tangential`: on a shaft, turning with it (what it feels of its own weight is an effect, "
        "`accelerometer_gravity`); `casing`: behind an unknown path (a tacho or an encoder tells the angle).",
        "response where tangential; findings in angle and order where on a casing", "casing",
    )  # fmt: skip
    shaft: Annotated[str, OneOf(("pinion", "gear"))] = key("The shaft it turns with.", "response")
    radius: Annotated[Quantity, Measured("m")] = key(
        "Radius of the sensor; not needed of an angular acceleration (`unit: rad/s^2`).", "response"
    )

    @model_validator(mode="after")
    def _mounted(self) -> "GearAcceleration":
        problems = []
        if self.mounting == "casing":
            rule, remedy = f"has no meaning on a casing: {CASING}", "leave it out, or write mounting: tangential"
            problems = [Problem(name, rule, None, remedy) for name in OF_A_SHAFT if self.given(name)]
        else:
            if not self.given("shaft"):
                problems.append(Problem("shaft", "is missing", None, "say on which it sits, shaft: pinion (or gear)"))
            if not self.given("radius") and not is_angular_acceleration(self.unit):
                remedy = "give the radius of the sensor, radius: {value: 30, unit: mm}"
                remedy += ", or state the unit of an angular acceleration, unit: rad/s^2"
                problems.append(Problem("radius", "is missing", None, remedy))
        if problems:
            raise InputError(problems)
        return self


class Motion(Response):
    """A motion of an oscillator."""

    refused: ClassVar[Reasons] = Frozen(
        {
            "mounting": ("it tells accelerometers of a gear_pair on a shaft from those on a casing", "leave it out"),
            "timing_error": ("it is that of the angle of a gear_pair", "write delay, which has a value and its unit"),
        }
    )
    usual_frame: ClassVar[str] = "relative"
    frame: Annotated[str, OneOf(("absolute", "relative"))] = key(
        "Beside a measured `base_acceleration` a_b: relative to the base, or of an acceleration alone against the "
        "ground, x'' + a_b, both positive the same way. "
        "Absent, relative for displacement and velocity, absolute for acceleration.", "response",
    )  # fmt: skip

    @model_validator(mode="after")
    def _measurable(self) -> "Motion":
        if self.frame == "absolute" and self.usual_frame == "relative":
            rule = (
                "an absolute motion needs that of the base, which its acceleration does not give: "
                "integrated, it drifts away"
            )
            refuse(rule, self.frame, "measure relative to the base, or the absolute acceleration", "frame")
        return self


class Displacement(Motion):
    """The displacement of an oscillator, in any unit."""

    title: ClassVar[str] = "a displacement"
    derivative: ClassVar[int | None] = 0  # in time, of the displacement
    usual_datum: ClassVar[str] = "arbitrary"


class Velocity(Motion):
    """Its velocity."""

    title: ClassVar[str] = "a velocity"
    derivative: ClassVar[int | None] = 1  # in time, of the displacement


class Acceleration(Motion):
    """Its acceleration."""

    title: ClassVar[str] = "an acceleration"
    derivative: ClassVar[int | None] = 2  # in time, of the displacement
    usual_datum: ClassVar[str] = "arbitrary"  # the zero of an accelerometer wanders; what is held has no mean one
    usual_frame: ClassVar[str] = "absolute"
