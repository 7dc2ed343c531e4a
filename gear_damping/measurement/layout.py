"""The layout of measurement.yaml: encoders, channels, records and the file itself, for each system."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType as Frozen
from typing import Annotated, Any, ClassVar

from pydantic import model_validator

from gear_damping.errors import InputError, Problem
from gear_damping.measurement import channels as c
from gear_damping.measurement import other_words as words
from gear_damping.measurement.quantities import PERIODS, Column, FileName, Instant, Measured, Rate, Rows
from gear_damping.measurement.record import ROLES, Quantity
from gear_damping.measurement.rig import (
    GEAR_TORQUE_MODES,
    GearConditions,
    GearParameters,
    OscillatorConditions,
    OscillatorParameters,
)
from gear_damping.schema.mappings import Declared, Item, Listed, Path, Word, key
from gear_damping.schema.values import Flag, Number, OneOf, Text, refuse
from gear_damping.units import parse_unit, spoken, to_si

SYSTEMS = ("gear_pair", "oscillator")
COUNTS = ("1", "count", "counts")  # what the column of an encoder may be said to be in
_NO_FILE = "name the file of the record, relative to this YAML"


_COUNTS = (
    "write counts_per_revolution: what the column counts in one turn, four times the lines where it counts every edge"
)
_PULSES = "write pulses_per_revolution"


class Pulses(Declared):
    """Where the angle of a shaft comes from."""

    column: Annotated[str | int, Column()] = key("Column with one value a sample.", "angle")
    timestamps: Annotated[str | int, Column()] = key("Column of the times of the pulses, instead.", "angle")
    direction: Annotated[int, OneOf((1, -1))] = key("-1 where it turns backwards.", "angle", 1)

    @model_validator(mode="after")
    def _one_source(self) -> "Pulses":
        if self.given("column") == self.given("timestamps"):
            remedy = "give either column (per sample) or timestamps (times of the pulses)"
            raise InputError(Problem("column", "is missing", None, remedy))
        if self.given("timestamps") and self.unit:
            to_si(1.0, self.unit, "s", "unit")
        return self


class Encoder(Pulses):
    """An encoder that counts."""

    title: ClassVar[str] = "an encoder"
    meant: ClassVar[Mapping[str, str]] = Frozen(
        dict.fromkeys(("cpr", "ppr", "pulses_per_revolution", "lines", "resolution", "counts", "pulses"), _COUNTS)
    )
    unit: Annotated[str, Text()] = key("Unit of `timestamps`; where absent that of the file, else s.", "angle")
    counts_per_revolution: Annotated[float, Number(least=1)] = key(
        "Counts in one turn of its shaft.",
        "angle",
        missing="give the number in one turn of its shaft, 360 of a column in degrees",
    )
    index: Annotated[str | int, Column()] = key(
        "Column of the index pulse (of its times, beside `timestamps`), which began between the sample that shows it "
        "and the one before; the gear's is checked to come once a turn.",
        "zero of the angle; check: its pulses are a turn apart",
    )

    @model_validator(mode="after")
    def _counts(self) -> "Encoder":
        if self.given("column") and self.unit and self.unit not in COUNTS:
            refuse("counts have no unit", self.unit, "leave it out; an angle with a unit is a channel", "unit")
        return self


class Tacho(Pulses):
    """A pulse train."""

    title: ClassVar[str] = "a tacho"
    meant: ClassVar[Mapping[str, str]] = Frozen(
        {
            **dict.fromkeys(("ppr", "cpr", "counts_per_revolution", "pulses", "pulses_per_turn"), _PULSES),
            "shaft": "leave it out: a tacho is that of the pinion; pulses of the gear are encoders.gear, by timestamps",
        }
    )
    refused: ClassVar[c.Reasons] = Frozen({"index": ("the zero of its angle is its first pulse", "leave it out")})
    unit: Annotated[str, Text()] = key(
        "Unit of the column; where absent that of the file, else V, or s of `timestamps`. Half way between two levels "
        'needs none; of a WAV file a threshold counts in shares of full scale, `unit: "1"`.',
        "threshold; angle",
    )
    pulses_per_revolution: Annotated[float, Number(least=1)] = key(
        "Pulses in one turn of its shaft.", "angle", missing="give the number in one turn of its shaft"
    )
    threshold: Annotated[Quantity, Measured(None, "any")] = key(
        "Level that a pulse rises through; half way where absent.", "angle"
    )

    @model_validator(mode="after")
    def _pulses(self) -> "Tacho":
        if self.given("timestamps") and self.threshold:
            refuse("times of pulses need no threshold", self.threshold.value, "leave it out", "threshold")
        if self.given("column"):
            unit = self.unit or "V"
            parse_unit(unit, "unit")
            if self.threshold:
                to_si(self.threshold.value, self.threshold.unit, unit, "threshold")
        return self


class Encoders(Declared):
    """The encoders and the tacho."""

    title: ClassVar[str] = "a gear_pair"
    pinion: Encoder = key("Encoder of the pinion.", "pinion_angle; with the gear's, the transmission error")
    gear: Encoder = key("Encoder of the gear.", "transmission error, without its mean")
    tacho: Tacho = key("Tacho of the pinion.", "pinion_angle")

    @model_validator(mode="after")
    def _one_pinion(self) -> "Encoders":
        if self.given("tacho") and self.given("pinion"):
            rule = "the pinion's encoder gives the angle of the same shaft"
            refuse(rule, None, "keep one of the two", "tacho")
        return self


class GearChannels(c.Timed):
    """The channels of a gear pair."""

    title: ClassVar[str] = "a gear_pair"
    meant: ClassVar[Mapping[str, str]] = Frozen(
        {
            **PERIODS,
            **words.RATES,
            **words.OF_GEAR_CHANNELS,
            "gear_angle": "write encoders: {gear: {column: ..., counts_per_revolution: 360}} beside channels (deg)",
            "tacho": "it is a key of encoders, which stands beside channels: write it there",
            "encoder": "write encoders beside channels, with pinion and gear below it",
        }
    )
    transmission_error: c.TransmissionError = key("r_b1 theta_1 - r_b2 theta_2, closing positive.", "response")
    pinion_torque: c.Torque = key("Driving torque.", "load")
    gear_torque: Annotated[c.GearTorque, Word(*GEAR_TORQUE_MODES)] = key(
        "Load, positive where it resists; or the word `balanced` or `held`, here or under `conditions`.", "load"
    )
    pinion_angle: c.Angle = key("Angle of the pinion; may wrap. Coarse steps are smoothed.", "angle of the shafts")
    pinion_speed: c.Speed = key(
        "Speed of the pinion.", "angle of the shafts; response where no transmission error is declared"
    )
    gear_speed: c.GearSpeed = key("Speed of the gear.", "response")
    acceleration: c.GearAcceleration = key("An accelerometer.", "response, or findings of a casing")


_DRIVES, _ANSWERS = "write force, in any unit", "write displacement, in any unit"
_BASE = (
    "write the base's as force and that of the mass as displacement, both in one unit ('A moving base' in "
    "docs/measurement.md), or measure base_acceleration"
)


class OscillatorChannels(c.Timed):
    """The channels of an oscillator."""

    title: ClassVar[str] = "an oscillator"
    meant: ClassVar[Mapping[str, str]] = Frozen(
        {
            **PERIODS,
            **words.RATES,
            **dict.fromkeys(("angle", "position"), _ANSWERS),
            **dict.fromkeys(("torque", "voltage", "current"), _DRIVES),
            **dict.fromkeys(("base_velocity", "base_displacement", "base_speed", "base_position"), _BASE),
        }
    )
    displacement: c.Displacement = key("Displacement, in any unit; an angle may wrap.", "response")
    velocity: c.Velocity = key("Velocity.", "response")
    acceleration: c.Acceleration = key("Acceleration.", "response")
    force: c.Force = key("What drives it, in any unit; absent in a free decay.", "input")
    base_acceleration: c.BaseAcceleration = key(
        "Acceleration a_b, against the ground, of the base that it stands on, positive in the direction in which the "
        "motion x relative to the base is: x'' + c x' + k x = -a_b.",
        "input",
    )


class Window(Declared):
    """A stretch of time."""

    title: ClassVar[str] = "a window"
    start: Annotated[Quantity | float, Instant()] = key(
        "First time, as the stamps of the file count, whatever their zero.",
        "rows",
        missing="give the first time",
        alias="from",
    )
    stop: Annotated[Quantity | float, Instant()] = key(
        "Where it ends: samples before this time.", "rows", missing="give the last time", alias="to"
    )
    unit: Annotated[str, Text()] = key("Unit of those that are plain numbers, for example s.", "rows")

    @classmethod
    def not_a_mapping(cls, place: Path, value: object) -> tuple[str, str]:
        """Rule and remedy where something else, a value, stands at `place`; a list of two times is what people mean."""
        rule, remedy = super().not_a_mapping(place, value)
        if isinstance(value, list) and len(value) == 2 and all(isinstance(one, int | float | str) for one in value):
            first, last = value
            unit = "" if all(isinstance(one, str) and spoken(one) for one in value) else ", unit: s"
            remedy = f"write window: {{from: {first}, to: {last}{unit}}}, or slice: [a, b] with the numbers of rows"
        return rule, remedy

    @model_validator(mode="after")
    def _ordered(self) -> "Window":
        plain = [one for one in (self.start, self.stop) if not isinstance(one, Quantity)]
        if plain and not self.unit:
            refuse("is missing", None, "give a unit, for example s, or one at each time: 10 ms", "unit")
        if not plain and self.unit:
            refuse("has no effect: both times have units of their own", self.unit, "leave it out", "unit")
        to_si(1.0, self.unit or "s", "s", "unit")
        first, last = self.seconds
        if first >= last:
            refuse("must lie before 'to'", first, "exchange the two", "from")
        return self

    @property
    def seconds(self) -> tuple[float, float]:
        """From and to in s."""
        one = to_si(1.0, self.unit or "s", "s")
        first, last = (t.value if isinstance(t, Quantity) else t * one for t in (self.start, self.stop))
        return first, last


@dataclass(frozen=True)
class Role(OneOf):
    """What a record is for."""

    def read(self, value: Any, name: str) -> str:
        """The word; others than these are answered with the one that they mean."""
        if isinstance(value, str) and value.lower() in words.ROLES:
            refuse(f"must be one of {', '.join(map(str, self.choices))}", value, f"write {words.ROLES[value.lower()]}")
        return super().read(value, name)


class AnyRecord(Declared):
    """What the records of every system have."""

    meant: ClassVar[Mapping[str, str]] = Frozen(
        {
            **PERIODS,
            **words.OF_A_RECORD,
            "parameters": "they are those of the rig, for all records: write them beside records",
            "segments": "it cuts all records: write it beside records, at the top of the file",
        }
    )
    name: Annotated[str, Text()] = key("Name of the record; that of its file where absent.", "report")
    file: Annotated[str, FileName()] = key(
        "The file, relative to this YAML; `${GEAR_DAMPING_DATA}` is filled in.", "values", missing=_NO_FILE
    )
    role: Annotated[str, Role(ROLES)] = key(
        "Fitted, held out, or a sound casing to compare with; where none is held out, task=explain holds out a part by "
        "itself, and so does task=identify of a gear pair.",
        "fit and score",
    )
    slice: Annotated[tuple[int, int], Rows()] = key("Rows a to b-1, counted from 0.", "rows")
    window: Window = key("The rows between two times, instead of `slice`.", "rows")
    resample: Annotated[Quantity, Rate()] = key("Rate to come down to, behind an anti-alias filter.", "values")
    sampling_rate: Annotated[Quantity, Rate()] = key("Constant rate, here or under channels.", "time base")

    @model_validator(mode="after")
    def _once(self) -> "AnyRecord":
        problems = []
        if self.given("slice") and self.given("window"):
            rule = "slice and window are both given"
            problems.append(Problem("window", rule, None, "keep the one that is right"))
        if self.given("sampling_rate") and self.channels and (self.channels.time or self.channels.sampling_rate):
            rule, remedy = "the time base is given under channels too", "keep the one that is right"
            problems.append(Problem("sampling_rate", rule, self.sampling_rate.value, remedy))
        if problems:
            raise InputError(problems)
        return self


class GearRecord(AnyRecord):
    """A record of a gear pair."""

    title: ClassVar[str] = "a gear_pair"
    meant: ClassVar[Mapping[str, str]] = Frozen({**AnyRecord.meant, **words.OF_A_GEAR_RECORD})
    channels: GearChannels = key("The measured signals, and their time base.", "values")
    encoders: Encoders = key("Encoders and tacho.", "values")
    conditions: GearConditions = key("What was constant. A channel of the same name is used before it.", "values")
    mesh_index: Annotated[bool, Flag()] = key("The zero of the pinion angle is that of the mesh.", "mesh phase", False)

    @model_validator(mode="after")
    def _zero_of_an_angle(self) -> "GearRecord":
        angle, counted = getattr(self.channels, "pinion_angle", None), self.encoders
        if self.mesh_index and angle is None and not (counted and (counted.pinion or counted.tacho)):
            rule = "has no meaning without a measured angle: there is no zero that could be that of the mesh"
            remedy = "leave it out, or declare pinion_angle, encoders.pinion or encoders.tacho"
            refuse(rule, self.mesh_index, remedy, "mesh_index")
        return self


class OscillatorRecord(AnyRecord):
    """A record of an oscillator."""

    title: ClassVar[str] = "an oscillator"
    refused: ClassVar[c.Reasons] = Frozen(
        {
            "encoders": ("only a gear_pair has encoders", "declare the response under channels"),
            "mesh_index": ("only a gear_pair meshes", "leave it out"),
        }
    )
    channels: OscillatorChannels = key("The measured signals, and their time base.", "values")
    conditions: OscillatorConditions = key("What was constant. A channel is used before it.", "values")


class AnyFile(Declared):
    """What the files of every system have."""

    meant: ClassVar[Mapping[str, str]] = words.OF_A_FILE
    system: Annotated[str, OneOf(SYSTEMS)] = key(
        "What was measured.", "model", missing=f"choose one of {', '.join(SYSTEMS)}"
    )
    segments: Annotated[Quantity, Measured("s")] = key(
        "Exact length of the segments that records are fitted and scored in; a shorter end is left out.",
        "fit and score",
    )


BEGIN = "begin each record with '- file: ...'"
_RECORDS = Listed("record", BEGIN)
_MEANING, _ACTS = "The records, each with its file.", "values"
NOMINAL = "Nominal values of the rig that differ from the defaults."


class GearFile(AnyFile):
    """A measurement of a gear pair."""

    title: ClassVar[str] = "a gear_pair"
    parameters: GearParameters = key(NOMINAL, "fit")
    records: Annotated[list[Annotated[GearRecord, Item()]], _RECORDS] = key(_MEANING, _ACTS, missing=BEGIN)


class OscillatorFile(AnyFile):
    """A measurement of an oscillator."""

    title: ClassVar[str] = "an oscillator"
    parameters: OscillatorParameters = key(NOMINAL, "fit")
    records: Annotated[list[Annotated[OscillatorRecord, Item()]], _RECORDS] = key(_MEANING, _ACTS, missing=BEGIN)


OWN_AS = SYSTEMS[1]  # whose channels a system of one's own has
FILES: Frozen[str, type[AnyFile]] = Frozen({"gear_pair": GearFile, "oscillator": OscillatorFile})
