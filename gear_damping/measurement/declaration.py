"""From the YAML to a plan: every key, word and quantity is checked and every problem noted."""

from gear_damping.measurement.fields import Fields, Problems
from gear_damping.measurement.plan import ChannelPlan, EncoderPlan, Plan, RecordPlan, TimePlan
from gear_damping.measurement.record import ROLES, Quantity
from gear_damping.measurement.vocabulary import (
    CHANNEL_KEYS,
    CHANNELS,
    CONDITIONS,
    ENCODER_KEYS,
    ENCODERS,
    GEAR_TORQUE_MODES,
    MAY_BE_NEGATIVE,
    MAY_BE_ZERO,
    MOUNTED_KEYS,
    PARAMETERS,
    RECORD_KEYS,
    SYSTEMS,
    TACHO_KEYS,
    TIME_KEYS,
    TIMING,
    TOP_KEYS,
    WHOLE,
)
from gear_damping.units import parse_unit


def declared_plan(content: object, problems: Problems, source: str) -> Plan | None:
    """The plan that the content of a measurement.yaml declares.

    Args:
        content: What the YAML file holds.
        problems: Takes everything that is wrong.
        source: The YAML file, for messages.

    Returns:
        The plan without its wrong records, or None where not even the system is known.
    """
    top = Fields(content, "", TOP_KEYS, problems, source)
    if "system" not in top:
        top.missing("system", f"choose one of {', '.join(SYSTEMS)}")
    system = top.choice("system", SYSTEMS)
    if system is None:
        return None
    parameters, own = _parameters(top.fields("parameters", tuple(PARAMETERS[system])), system)
    listed = top.content.get("records")
    if not isinstance(listed, list) or not listed:
        top.add("records", "must be a list of at least one record", "begin each record with '- file: ...'")
        listed = []
    records = [
        _record(Fields(item, f"records[{k}]", RECORD_KEYS, problems, source), system) for k, item in enumerate(listed)
    ]
    return Plan(system, parameters, own, tuple(record for record in records if record))


def _parameters(fields: Fields, system: str) -> tuple[dict[str, Quantity], dict[str, Quantity]]:
    parameters, own = {}, {}
    for name in fields.content:
        unit = PARAMETERS[system][name]
        quantity = _own_parameter(fields, name) if unit == "own" else fields.quantity(name, unit)
        if quantity is None:
            continue
        (own if unit == "own" else parameters)[name] = quantity
        if quantity.value < 0 and name not in MAY_BE_NEGATIVE:
            fields.add(name, "must not be negative")
        elif quantity.value == 0 and name not in (*MAY_BE_NEGATIVE, *MAY_BE_ZERO):
            fields.add(name, "must be positive")
        elif name in WHOLE and quantity.value != round(quantity.value):
            fields.add(name, "must be a whole number")
    return parameters, own


def _own_parameter(fields: Fields, name: str) -> Quantity | None:
    """A value in the rig's own units where no unit is given."""
    value = fields.content[name]
    if isinstance(value, dict) and "unit" not in value:
        fields.content[name] = {**value, "unit": "own"}
    return fields.quantity(name, None)


def _record(fields: Fields, system: str) -> RecordPlan | None:
    file = fields.text("file")
    if "file" not in fields:
        fields.missing("file", "name the file of the record, relative to this YAML")
    channels = fields.fields("channels", (*TIMING, *CHANNELS[system]))
    encoders = fields.fields("encoders", ENCODERS)
    if "encoders" in fields and system != "gear_pair":
        fields.add("encoders", "only a gear_pair has encoders", "declare the response under channels")
    if "channels" not in fields and "encoders" not in fields:
        fields.missing("channels", f"declare at least one of {', '.join(CHANNELS[system])}")
    conditions, mode = _conditions(fields, channels, system)
    plan = RecordPlan(
        key=fields.key,
        name=fields.text("name"),
        file=file or "",
        role=fields.choice("role", ROLES),
        rows=_rows(fields),
        timing=_record_timing(fields, channels),
        channels=tuple(_channels(channels, system)),
        encoders=tuple(plan for name in encoders.content if (plan := _encoder(encoders, name))),
        conditions=conditions,
        gear_torque_mode=mode,
        mesh_index=fields.flag("mesh_index"),
    )
    return plan if file else None


def _conditions(record: Fields, channels: Fields, system: str) -> tuple[dict[str, Quantity], str | None]:
    """Constant conditions, and `balanced` or `held` where that stands for the gear torque."""
    fields = record.fields("conditions", tuple(CONDITIONS[system]))
    mode = None
    for place in (fields, channels):
        if isinstance(place.content.get("gear_torque"), str):
            mode = place.choice("gear_torque", GEAR_TORQUE_MODES)
            del place.content["gear_torque"]
    found = {
        name: fields.quantity(name, None if CONDITIONS[system][name] == "own" else CONDITIONS[system][name])
        for name in fields.content
    }
    return {name: quantity for name, quantity in found.items() if quantity}, mode


def _rows(fields: Fields) -> tuple[int, int] | None:
    if "slice" not in fields:
        return None
    rows = fields.content["slice"]
    rule = "must be [a, b] with 0 <= a < b: rows a to b-1, counted from 0"
    whole = isinstance(rows, list) and all(isinstance(row, int) and not isinstance(row, bool) for row in rows)
    if not whole or len(rows) != 2 or not 0 <= rows[0] < rows[1]:
        return fields.add("slice", rule, "write for example slice: [0, 5000]")
    return rows[0], rows[1]


def _timing(fields: Fields) -> TimePlan | None:
    """The time base that `time` or `sampling_rate` declares."""
    if all(name in fields for name in TIMING):
        fields.add("sampling_rate", "time and sampling_rate are both given", "keep the one that is right")
    if "sampling_rate" in fields:
        return TimePlan(sampling_rate=fields.positive("sampling_rate", "Hz"))
    if "time" not in fields:
        return None
    inner = fields.fields("time", TIME_KEYS)
    if "column" not in inner:
        inner.missing("column", "name the column of the time stamps")
    return TimePlan(inner.column(), inner.text("unit"))


def _record_timing(record: Fields, channels: Fields) -> TimePlan:
    inside = _timing(channels)
    if "sampling_rate" in record and inside is not None:
        record.add("sampling_rate", "the time base is given under channels too", "keep the one that is right")
    if "sampling_rate" in record:
        return TimePlan(sampling_rate=record.positive("sampling_rate", "Hz"))
    return inside or TimePlan()


def _channels(fields: Fields, system: str) -> list[ChannelPlan]:
    plans = []
    for name in fields.content:
        if name in TIMING:
            continue
        mounted = name == "acceleration" and system == "gear_pair"
        inner = fields.fields(name, CHANNEL_KEYS + (MOUNTED_KEYS if mounted else ()))
        if "column" not in inner and isinstance(fields.content[name], dict):
            inner.missing("column", "name the column by its header text or its 0-based index")
        column, unit = inner.column(), inner.text("unit")
        if unit:
            with inner.problems.collecting():
                parse_unit(unit, inner.path("unit"), inner.source)
        plan = ChannelPlan(
            name, inner.key, "" if column is None else column, unit,
            _sensor(inner, mounted), _limits(inner), _timing(inner),
        )  # fmt: skip
        plans += [] if column is None else [plan]
    return plans


def _sensor(fields: Fields, mounted: bool) -> dict[str, object]:
    delay = fields.quantity("delay", "s")
    sensor = {
        "lowpass": fields.positive("lowpass", "Hz"),
        "highpass": fields.positive("highpass", "Hz"),
        "coupling": fields.choice("coupling", ("DC", "AC"), "DC"),
        "delay": delay.value if delay else 0.0,
        "uncertainty": fields.number("uncertainty", least=0.0, default=0.0),
        "polarity": fields.choice("polarity", (1, -1), 1),
        "datum": fields.choice("datum", ("absolute", "arbitrary"), "absolute"),
    }
    if sensor["lowpass"] and sensor["highpass"] and sensor["lowpass"] <= sensor["highpass"]:
        fields.add("lowpass", "must lie above highpass", "exchange the two")
    if mounted:
        sensor["mounting"] = fields.choice("mounting", ("tangential", "casing"), "casing")
        sensor["radius"] = fields.positive("radius", "m")
        if sensor["mounting"] == "tangential" and "radius" not in fields:
            fields.missing("radius", "give the radius of the sensor, radius: {value: 30, unit: mm}")
    return sensor


def _limits(fields: Fields) -> dict[str, Quantity]:
    """Full scale and noise level, which are in the unit of the channel or one of its kind."""
    limits = {}
    for name in ("range", "noise"):
        quantity = fields.quantity(name, None)
        if quantity and quantity.value < 0:
            fields.add(name, "must not be negative")
        elif quantity:
            limits[name] = quantity
    return limits


def _encoder(parent: Fields, name: str) -> EncoderPlan | None:
    tacho = name == "tacho"
    fields = parent.fields(name, TACHO_KEYS if tacho else ENCODER_KEYS)
    per = "pulses_per_revolution" if tacho else "counts_per_revolution"
    if per not in fields:
        fields.missing(per, "give the number in one turn of its shaft")
    count = fields.number(per, least=1)
    if ("column" in fields) == ("timestamps" in fields):
        fields.missing("column", "give either column (per sample) or timestamps (times of the pulses)")
    column = fields.column("timestamps" if "timestamps" in fields else "column")
    threshold = fields.quantity("threshold", None) if tacho else None
    direction = fields.choice("direction", (1, -1), 1)
    unit = fields.text("unit") or ("s" if "timestamps" in fields else "V")
    index = None if tacho else fields.column("index")
    if count is None or column is None:
        return None
    stamped = "timestamps" in fields
    return EncoderPlan(name, fields.key, column, stamped, unit, count, index, direction, threshold)
