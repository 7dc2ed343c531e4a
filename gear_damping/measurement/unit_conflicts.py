"""What the header or the name of a column says of its unit, against the one that was declared."""

import re

from gear_damping.errors import InputError
from gear_damping.measurement.angular_error import is_angular_acceleration
from gear_damping.measurement.declared_units import Conversion
from gear_damping.measurement.formats.bracket_words import is_count, is_level, spelt_out, unit_of_its_kind
from gear_damping.measurement.formats.header import is_among_words
from gear_damping.measurement.named_units import gravity_at_end, unit_at_end
from gear_damping.measurement.raw import SAME_UNIT, RawChannel, RawRecord
from gear_damping.measurement.record import Finding
from gear_damping.measurement.vocabulary import OSCILLATOR_CHANNELS
from gear_damping.units import Dimension, Unit, is_of_kind, multiple_of_a_unit, of_a_shaft, parse_unit, scaled_unit

# What a sensor gives for one unit, `100 mV/g`, or how much one volt is, `125 mm/s/V`.
_SENSITIVITY = re.compile(
    r"(?:\d[\d.,]*\s*)?(?:(?:mV|V|pC)/\(?(?P<below>[^\W\d][^()\[\]\s]*)|(?P<above>[^\W\d_][^()\[\]\s]*)/(?:mV|V)(?!\w))"
)
_MOTIONS = ("displacement", "velocity", "acceleration")  # each the derivative of the one before
_LENGTH, _ANGLE, _PER_SECOND = (
    Dimension(length=1),
    Dimension(angle=1),
    Dimension(time=-1),
)  # of what moves, turns, and of either by the second
_IN_BRACKETS = re.compile(r"[(\[]([^()\[\]]*)[)\]]")


def unit_conflict(raw: RawChannel, record: RawRecord, conversion: Conversion) -> Finding | None:
    """The header names a unit and the YAML another one."""
    said = raw.plan.stated_unit or raw.unit
    stated = parse_unit(said)
    name = record.table.names[record.table.index(raw.plan.column, raw.plan.key)]
    if not raw.plan.is_scaled and (sensitivity := _sensitivity_in(name, said)):
        return _sensitivity_conflict(raw, said, sensitivity)
    if raw.header_unit is None:
        return None if raw.plan.is_scaled else _name_conflict(raw, name, said, stated)
    if raw.header_unit == said:
        return None
    if step := multiple_of_a_unit(raw.header_unit):
        return None if raw.plan.is_scaled else _step_conflict(raw, said, *step)
    if scaled_unit(raw.header_unit):
        return None if raw.plan.is_scaled else _factor_unsaid(raw, said)
    try:
        header, stated = _by_the_minute(parse_unit(raw.header_unit), stated)
    except InputError:
        return None if raw.plan.is_scaled else _among_words(raw, said, stated)
    is_other = header.dimension != stated.dimension
    if is_other and raw.plan.is_scaled:
        return None  # a gain of another kind lies between: volts in the file, what they stand for in the YAML
    if is_other and header.dimension == parse_unit("kg").dimension and stated.dimension == parse_unit("N").dimension:
        header, is_other = parse_unit(raw.header_unit.replace("kg", "kgf")), False  # as load cells say it
    if (header.dimension, header.factor) == (stated.dimension, stated.factor):
        return None
    has_words = is_among_words(name, raw.header_unit)
    if has_words and raw.plan.is_scaled:
        return None
    kept = "rad/s^2" if is_angular_acceleration(said) else conversion.unit
    message = (
        f"the header of column '{raw.plan.column}' says '{raw.header_unit}' and the YAML '{said}', "
        f"which was used to read {raw.plan.name} in {kept}; correct the one that is wrong"
    )
    if is_other:
        message += f", or write gain: what the column holds for one {said} (1 where its header names something else)"
    elif has_words:
        message += f", or write gain: 1 where '{raw.header_unit}' in the header is not its unit"
    return Finding("unit_conflict", message, channel=raw.plan.name)


def other_motion(raw: RawChannel) -> Finding | None:
    """A note where a velocity or an acceleration is in a unit of another derivative, as an acceleration in mm/s."""
    order = OSCILLATOR_CHANNELS.get(raw.plan.name)
    unit = parse_unit(raw.unit).dimension
    is_motion = unit in [kind * _PER_SECOND**k for kind in (_LENGTH, _ANGLE) for k in range(len(_MOTIONS))]
    if not order or not is_motion or -unit.time == order:
        return None
    motion = _MOTIONS[int(-unit.time)]
    message = f"{raw.plan.name} is in {raw.unit}, a unit of a {motion}; declare it as {motion} where it is one"
    return Finding("unit_conflict", message, channel=raw.plan.name, severity="note")


def _sensitivity_in(name: str, said: str) -> str | None:
    """The sensitivity of a sensor in a header that says no unit of the kind of the declared one beside it."""
    found = _SENSITIVITY.search(name)
    if found is None or any(is_of_kind(text, said) for text in _IN_BRACKETS.findall(name.replace(found[0], ""))):
        return None
    return found[0] if is_of_kind(found["below"] or found["above"], said) else None


def _sensitivity_conflict(raw: RawChannel, said: str, sensitivity: str) -> Finding:
    """The header says how many volts one unit is, `100 mV/g`, and the YAML that the column is in that unit."""
    message = (
        f"the header of column '{raw.plan.column}' says '{sensitivity}', the sensitivity of a sensor, and the YAML "
        f"'{said}', which was used; write gain: what the column holds for one {said}, or gain: 1 where it is in {said}"
    )
    return Finding("unit_conflict", message, channel=raw.plan.name)


def _by_the_minute(header: Unit, stated: Unit) -> tuple[Unit, Unit]:
    """Both units, where one is `1/min` and the other one of the speed of a shaft that one as turns by the minute."""
    return of_a_shaft(header, stated), of_a_shaft(stated, header)


def _step_conflict(raw: RawChannel, said: str, number: float, unit: Unit) -> Finding | None:
    """The header counts in steps of a unit, `[0.1 mm]`, and the YAML in whole ones."""
    stated = parse_unit(said)
    gain = stated.factor / (number * unit.factor)
    if unit.dimension != stated.dimension or abs(gain - 1) < SAME_UNIT:
        return None
    message = f"the header of column '{raw.plan.column}' says '{raw.header_unit}' and the YAML '{said}', "
    message += (
        f"which was used; write gain: {gain:.6g}, by which values are divided, or gain: 1 where they are in {said}"
    )
    return Finding("unit_conflict", message, channel=raw.plan.name)


def _factor_unsaid(raw: RawChannel, said: str) -> Finding:
    """The header has a factor behind its unit, `[mm*10]`, and the YAML none."""
    message = (
        f"the header of column '{raw.plan.column}' says '{raw.header_unit}' and the YAML '{said}', which was used; "
        f"write gain: what the column holds for one {said}, which is the factor or one over it, or gain: 1 where there "
        "is none"
    )
    return Finding("unit_conflict", message, channel=raw.plan.name)


def _name_conflict(raw: RawChannel, name: str, said: str, stated: Unit) -> Finding | None:
    """The name of the column ends in a smaller or larger unit than that of the YAML, `x_um`, or in one of others."""
    named = unit_at_end(name)
    if named is None and gravity_at_end(name):
        return _may_be_gravity(raw, name, said, stated)
    if named is None:
        return None
    own, stated = _by_the_minute(parse_unit(named), stated)
    if own.dimension != stated.dimension:
        return _named_otherwise(raw, name, named, said)
    if abs(own.factor / stated.factor - 1) < SAME_UNIT:
        return None
    message = (
        f"column '{name}' is named like one in {named} and the YAML says '{said}', which was used; correct "
        "the one that is wrong, or write gain: 1 where it is the name"
    )
    return Finding("unit_conflict", message, channel=raw.plan.name)


def _named_otherwise(raw: RawChannel, name: str, named: str, said: str) -> Finding | None:
    """The name of the column ends in a unit of another kind than that of the YAML, `x_mV` of one in mm."""
    if name.lower().endswith(said.lower()):
        return None  # `x_nm` in nanometres
    message = (
        f"column '{name}' is named like one in {named} and the YAML says '{said}', a unit of another kind, which was "
        f"used; write gain: what the column holds for one {said}, or gain: 1 where the name means something else"
    )
    return Finding("unit_conflict", message, channel=raw.plan.name, severity="note")


def _may_be_gravity(raw: RawChannel, name: str, said: str, stated: Unit) -> Finding | None:
    """The name of an acceleration ends in a `g`, which may as well stand for the gear or the ground."""
    gravity = parse_unit("g")
    if gravity.dimension != stated.dimension or gravity.factor == stated.factor:
        return None
    message = (
        f"column '{name}' ends in g and the YAML says '{said}', which was used; write unit: g where it is in that, or "
        "gain: 1 where the name means something else"
    )
    return Finding("unit_conflict", message, channel=raw.plan.name, severity="note")


def _among_words(raw: RawChannel, said: str, stated: Unit) -> Finding | None:
    """A word in the brackets of the header is a unit of the kind of the YAML's and another one, `left, mm`."""
    if is_level(raw.header_unit):
        return _level_conflict(raw, said)
    if is_count(raw.header_unit) and not is_of_kind(said, "1"):
        return _counts_conflict(raw, said)
    word = spelt_out(raw.header_unit, said) or unit_of_its_kind(raw.header_unit, said)
    if word is None or parse_unit(word).factor == stated.factor:
        return None
    message = (
        f"the header of column '{raw.plan.column}' says '{raw.header_unit}', where {word} may be the unit, and the "
        f"YAML '{said}', which was used; correct the one that is wrong, or write gain: 1 where it is none"
    )
    return Finding("unit_conflict", message, channel=raw.plan.name)


def _counts_conflict(raw: RawChannel, said: str) -> Finding:
    """The header says that the column counts, `LSB`, and the YAML a unit without how many counts are one."""
    message = (
        f"the header of column '{raw.plan.column}' says '{raw.header_unit}', and the YAML '{said}', which was used; "
        f"write gain: the counts of one {said}, or gain: 1 where the column is in {said}"
    )
    return Finding("unit_conflict", message, channel=raw.plan.name)


def _level_conflict(raw: RawChannel, said: str) -> Finding:
    """The header says a level, `dBV`, and the YAML the unit of a signal."""
    message = (
        f"the header of column '{raw.plan.column}' says '{raw.header_unit}', a level, which is a logarithm, and the "
        f"YAML '{said}', which was used; write the values themselves, 10^(level/20), or gain: 1 where they are these"
    )
    return Finding("unit_conflict", message, channel=raw.plan.name)
