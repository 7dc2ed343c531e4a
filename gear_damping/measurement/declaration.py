"""From the YAML to a plan: what it declares, checked, before any measured file is opened; every problem is noted."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.measurement import layout
from gear_damping.measurement.angular_error import along_the_line, is_angle_of_a_shaft, is_angular_acceleration
from gear_damping.measurement.channels import SEVERAL, AnyChannel, Response, Timed
from gear_damping.measurement.consistency import inconsistencies
from gear_damping.measurement.formats.bracket_words import is_count
from gear_damping.measurement.own_system import NONE, file_of, si_units
from gear_damping.measurement.record import Quantity
from gear_damping.measurement.vocabulary import GEAR_CHANNELS, SHAFT_SPEEDS, channels_of, units_of
from gear_damping.schema.mappings import names, read_declared
from gear_damping.schema.values import OneOf, Problems
from gear_damping.units import parse_unit

if TYPE_CHECKING:
    from gear_damping.physics.systems.base import System

_SENSOR = ("coupling", "uncertainty", "polarity", "gain", "mounting", "shaft", "hold")  # kept as they are declared
_ENCODERS = ("pinion", "gear", "tacho")


@dataclass(frozen=True)
class TimePlan:
    """Where the time comes from: a column in `unit`, or a rate in Hz."""

    column: str | int | None = None
    unit: str | None = None
    sampling_rate: float | None = None


@dataclass(frozen=True)
class ChannelPlan:
    """A declared channel; `unit` None asks the file, `limits` are range and noise as declared.

    `is_scaled` says that its gain is stated, be it 1; `stated_unit` is the angle that `unit` is the length of,
    and `lever` what the gain was multiplied by on that way; `geometry` makes a length of an angle of a shaft whose
    unit the file says.
    """

    name: str
    key: str
    column: str | int
    unit: str | None
    sensor: Mapping[str, object]
    limits: Mapping[str, Quantity]
    timing: TimePlan | None
    is_scaled: bool = False
    stated_unit: str | None = None
    lever: float = 1.0
    geometry: Mapping[str, Quantity] | None = None

    @property
    def shaft_radius(self) -> float | None:
        """m, at which a shaft's speed or acceleration is measured along the circumference; None elsewhere."""
        return self.sensor.get("radius") if self.name in (*SHAFT_SPEEDS, "acceleration") else None


@dataclass(frozen=True)
class EncoderPlan:
    """A shaft encoder or tacho: counts or a pulse train per sample, or the times of the pulses.

    `unit` None asks the file.
    """

    name: str
    key: str
    column: str | int
    timestamps: bool
    unit: str | None
    per_revolution: float
    index: str | int | None = None
    direction: int = 1
    threshold: Quantity | None = None


@dataclass(frozen=True)
class RecordPlan:
    """A declared record; `conditions` of a channel's kind are as declared, others SI.

    `window` is begin and end in s on the record's own clock, `resample` the rate in Hz that it is to have.
    """

    key: str
    name: str | None
    file: str
    role: str | None
    rows: tuple[int, int] | None
    timing: TimePlan
    channels: tuple[ChannelPlan, ...]
    encoders: tuple[EncoderPlan, ...]
    conditions: Mapping[str, Quantity]
    gear_torque_mode: str | None
    mesh_index: bool
    window: tuple[float, float] | None = None
    resample: float | None = None


@dataclass(frozen=True)
class Plan:
    """A declared measurement; `own` parameters are in units still to be compared with the channels'.

    `si` has the unit that each channel is kept in; None where the rig is kept in the unit of its response.
    """

    system: str
    parameters: Mapping[str, Quantity]
    own: Mapping[str, Quantity]
    records: tuple[RecordPlan, ...]
    segment_s: float | None = None
    si: Mapping[str, str] | None = None


def declared_plan(
    content: object, problems: Problems, source: str, own: "Mapping[str, type[System]]" = NONE
) -> Plan | None:
    """The plan that the content of a measurement.yaml declares.

    Args:
        content: What the YAML file holds.
        problems: Takes everything that is wrong.
        source: The YAML file, for messages.
        own: Systems of one's own by name.

    Returns:
        The plan without its wrong records, or None where not even the system is known.
    """
    system = _system(content, problems, source, tuple(own))
    if system is None:
        return None
    before = len(problems)
    file = read_declared(file_of(own[system]) if system in own else layout.FILES[system], content, problems, source)
    found = problems[before:]
    problems[before:] = _several_once(found)
    if file is None:
        return None
    wrong = {k for k in range(len(file.records)) if any(p.key.startswith(f"records[{k}]") for p in found)}
    problems += [Problem(p.key, p.rule, p.value, p.remedy, source) for p in inconsistencies(file, wrong)]
    parameters, in_own_units = _parameters(file)
    records = tuple(
        _record(record, f"records[{k}]", parameters, problems, source)
        for k, record in enumerate(file.records)
        if record
    )
    segment_s = file.segments.value if file.segments else None
    return Plan(system, parameters, in_own_units, records, segment_s, _kept(file, own.get(system)))


def _several_once(found: Sequence[Problem]) -> list[Problem]:
    """The problems; that a record takes one sensor of a kind is said of the first record that lists several."""
    told, kept = set(), []
    for problem in found:
        of_a_channel = problem.rule, problem.key.rpartition(".")[2]
        if not problem.rule.startswith(SEVERAL) or of_a_channel not in told:
            kept.append(problem)
        told.add(of_a_channel)
    return kept


def _kept(file: layout.AnyFile, own: "type[System] | None") -> Mapping[str, str] | None:
    """The SI unit of every channel; None where the rig is kept in units of its own."""
    if own is not None:
        return si_units(own)
    return GEAR_CHANNELS if isinstance(file, layout.GearFile) else None


def _system(content: object, problems: Problems, source: str, own: tuple[str, ...]) -> str | None:
    """The system, without which no other key has a meaning; misspelt keys beside it are named too."""
    allowed = tuple(names(layout.GearFile))
    if not isinstance(content, dict):
        rule = f"must be a mapping with keys among {', '.join(allowed)}"
        problems.append(Problem("the file", rule, content, "write `key: value` lines", source))
        return None
    if "system" not in content:
        problem = Problem("system", "is missing", None, names(layout.AnyFile)["system"].json_schema_extra["missing"])
    else:
        try:
            return OneOf((*layout.SYSTEMS, *own)).read(content["system"], "system")
        except InputError as error:
            (problem,) = error.problems
    meant = layout.AnyFile.meant
    for name in content:  # of a system that is known they are told where it is read
        if name not in allowed:
            remedy = meant.get(name) or nearest(str(name), allowed)
            problems.append(Problem(str(name), "unknown key", None, remedy, source))
    problems.append(Problem("system", problem.rule, problem.value, problem.remedy, source))
    return None


def _parameters(file: layout.AnyFile) -> tuple[dict[str, Quantity], dict[str, Quantity]]:
    """Those in SI, and those in units that are still to be compared with the channels'."""
    given = file.parameters
    units = {} if given is None else units_of(type(given))
    found = {name: getattr(given, name) for name in units if given.given(name)}
    own = {name: quantity for name, quantity in found.items() if units[name] == "own"}
    return {name: quantity for name, quantity in found.items() if name not in own}, own


def _record(
    record: layout.AnyRecord, key: str, parameters: Mapping[str, Quantity], problems: Problems, source: str
) -> RecordPlan:
    declared = _declared_channels(record)
    conditions, mode = _conditions(record)
    based = "base_acceleration" in declared
    gear = isinstance(record, layout.GearRecord)
    channels = [
        _channel(name, channel, f"{key}.channels.{name}", _resolved(name, channel, record, based), problems, source)
        for name, channel in declared.items()
    ]
    return RecordPlan(
        key=key,
        name=record.name,
        file=record.file,
        role=record.role,
        rows=record.slice,
        timing=_timing(record) or _timing(record.channels) or TimePlan(),
        channels=tuple(_as_length(plan, parameters) if is_angle_of_a_shaft(plan) else plan for plan in channels),
        encoders=tuple(_encoders(record, key)) if gear else (),
        conditions=conditions,
        gear_torque_mode=mode,
        mesh_index=record.mesh_index if gear else False,
        window=record.window.seconds if record.window else None,
        resample=record.resample.value if record.resample else None,
    )


def _as_length(plan: ChannelPlan, parameters: Mapping[str, Quantity]) -> ChannelPlan:
    """An angle of a shaft as a length; where the header of the column says its unit, what makes it one."""
    return replace(plan, geometry=parameters) if plan.unit is None else along_the_line(plan, parameters)


def _declared_channels(record: layout.AnyRecord) -> dict[str, AnyChannel]:
    """The channels by name, without words that stand for one."""
    known = {} if record.channels is None else channels_of(type(record.channels))
    found = {name: getattr(record.channels, name, None) for name in known}
    return {name: channel for name, channel in found.items() if channel is not None and not isinstance(channel, str)}


def _conditions(record: layout.AnyRecord) -> tuple[dict[str, Quantity], str | None]:
    """Constant conditions, and `balanced` or `held` where that stands for the gear torque."""
    held = record.conditions
    found = {} if held is None else {n: getattr(held, n) for n in names(type(held)) if held.given(n)}
    words = [getattr(record.channels, "gear_torque", None), found.get("gear_torque")]
    mode = next((word for word in words if isinstance(word, str)), None)
    return {name: quantity for name, quantity in found.items() if not isinstance(quantity, str)}, mode


def _timing(place: Timed | layout.AnyRecord | None) -> TimePlan | None:
    """The time base that `time` or `sampling_rate` declares."""
    time, rate = getattr(place, "time", None), getattr(place, "sampling_rate", None)
    if rate is not None:
        return TimePlan(sampling_rate=rate.value)
    return None if time is None else TimePlan(time.column, time.unit)


def _channel(
    name: str, channel: AnyChannel, key: str, sensor: dict[str, object], problems: Problems, source: str
) -> ChannelPlan:
    if channel.unit and not (channel.si and is_count(channel.unit)):  # of counts the conversion says what helps
        with problems.collecting():
            parse_unit(channel.unit, f"{key}.unit", source)
    limits = {limit: getattr(channel, limit, None) for limit in ("range", "noise")}
    return ChannelPlan(
        name, key, channel.column, channel.unit, sensor,
        {limit: quantity for limit, quantity in limits.items() if quantity}, _timing(channel),
        "gain" in channel.model_fields_set,
    )  # fmt: skip


def _resolved(name: str, channel: AnyChannel, record: layout.AnyRecord, based: bool) -> dict[str, object]:
    """What a Channel keeps of its sensor: what is absent in the file is resolved here."""
    sensor = {key: value for key in _SENSOR if (value := getattr(channel, key, None)) is not None}
    for corner in ("lowpass", "highpass"):
        found = getattr(channel, corner, None)
        if found:
            sensor |= {corner: found.frequency, f"{corner}_order": found.order}
    for length in ("delay", "radius", "timing_error"):
        if quantity := getattr(channel, length, None):
            sensor[length] = quantity.value
    if "shaft" in sensor and is_angular_acceleration(channel.unit):
        sensor.setdefault("radius", 1.0)  # m: there the two are one number
    sensor["datum"] = _datum(name, channel, record)
    if based and hasattr(channel, "frame"):
        sensor["frame"] = channel.frame or channel.usual_frame
    return sensor


def _datum(name: str, channel: AnyChannel, record: layout.AnyRecord) -> str:
    if name == "pinion_angle":
        return "absolute" if record.mesh_index else "arbitrary"
    if not isinstance(channel, Response):
        return "absolute"
    lost = getattr(channel, "coupling", "DC") == "AC"
    return getattr(channel, "datum", None) or ("arbitrary" if lost else channel.usual_datum)


def _encoders(record: layout.GearRecord, key: str) -> list[EncoderPlan]:
    plans = []
    for name in _ENCODERS:
        encoder = getattr(record.encoders, name, None)
        if encoder is None:
            continue
        stamped = encoder.timestamps is not None
        tacho = name == "tacho"
        plans.append(
            EncoderPlan(
                name,
                f"{key}.encoders.{name}",
                encoder.timestamps if stamped else encoder.column,
                stamped,
                encoder.unit,
                encoder.pulses_per_revolution if tacho else encoder.counts_per_revolution,
                None if tacho else encoder.index,
                encoder.direction,
                encoder.threshold if tacho else None,
            )
        )
    return plans
