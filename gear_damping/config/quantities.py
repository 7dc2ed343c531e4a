"""Numbers with units in the configuration: parameters become SI here, other keys as `schema.values.Number` has it."""

from collections.abc import Container, Mapping, Sequence
from math import isfinite
from typing import Any

from gear_damping.config.keys import unit_of
from gear_damping.errors import InputError, Problem
from gear_damping.physics.parameter import Parameter
from gear_damping.schema.values import is_not_finite
from gear_damping.units import DIGITS, SUFFIXES, parse_unit, said_as, spoken, to_si


def split_suffix(key: str, known: Container[str]) -> tuple[str, str | None]:
    """The parameter a key names and the unit of its suffix: `pinion_speed_rpm` → (`pinion_speed`, `rpm`)."""
    if key in known:
        return key, None
    name, _, suffix = key.rpartition("_")
    if suffix in SUFFIXES and name in known:
        return name, SUFFIXES[suffix]
    return key, None


def quantity(value: Any, expected: str, key: str, source: str, unit: str | None = None) -> float:
    """A number in `expected` from a plain number (in that, or in `unit`), {value, unit} or a text such as `80um`.

    Args:
        value: As it was given.
        expected: SI; of a rig that is measured in another unit, that; "" where nobody knows it.
        key: Its key.
        source: Where it comes from.
        unit: Of a plain number.

    Raises:
        InputError: it is neither, not finite, or in a unit of another kind.
    """
    if said := spoken(value):
        value, unit = said
    if isinstance(value, Mapping):
        extra = set(value) - {"value", "unit"}
        if extra or "value" not in value:
            rule = "must be a number or {value: …, unit: …}"
            raise InputError(Problem(key, rule, dict(value), f"for example {{value: 1, unit: {expected}}}", source))
        unit, value = value.get("unit", unit), value["value"]
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not isfinite(value):
        rule = "must be a finite number" + (f" in {unit or expected}" if (unit or expected) != "1" else "")
        remedy = "write a number" + (f", or {{value: …, unit: {expected}}}" if expected else "")
        remedy += ": neither infinity nor nan is one" if is_not_finite(value) else ""
        raise InputError(Problem(key, rule, value, remedy, source))
    if unit and not expected:
        rule, remedy = "is in a unit, and that of the rig is not known", "add simulator.unit=m, or what the rig is in"
        raise InputError(Problem(key, rule, f"{value:g} {unit}", remedy, source))
    if not unit or unit.strip() == expected:
        return float(value)
    return to_si(float(value), unit, expected, key, source) / parse_unit(expected).factor


def number_of(key: str, value: Any) -> Any:
    """The number of a quantity in SI, or in the unit that its key carries; what is no quantity as it is.

    Args:
        key: Its full key.
        value: As it was given.
    """
    said, own = said_as(value), unit_of(key)
    if said is None or own is None:
        return value
    try:
        return float(f"{said[0] * parse_unit(said[1]).factor / parse_unit(own).factor:.{DIGITS}g}")
    except InputError:  # of a job that could not run
        return value


def parameter_value(
    value: Any, parameter: Parameter, key: str, source: str, unit: str | None = None
) -> float | tuple[float, ...]:
    """The value of a declared parameter in SI, a tuple for a list-valued one.

    Raises:
        InputError: its type, unit or range is wrong.
    """
    if not parameter.vector:
        found = quantity(value, parameter.unit, key, source, unit)
        _refuse(parameter.problem(found, key, source))
        return found
    listed, unit = _listed(value, unit)
    if listed is None:
        raise InputError(
            Problem(key, f"must be a list of numbers in {unit or parameter.unit}", value, _as_list(value), source)
        )
    numbers = tuple(quantity(v, parameter.unit, f"{key}[{i}]", source, unit) for i, v in enumerate(listed))
    for i, number in enumerate(numbers):
        _refuse(parameter.problem(number, f"{key}[{i}]", source))
    return numbers


def _as_list(value: Any) -> str:
    """The remedy for what is no list; one number is one of a list."""
    alone = isinstance(value, int | float | str) and not isinstance(value, bool)
    return f"write [{value}], or [a, b, …]" if alone else "write [a, b, …]"


def _listed(value: Any, unit: str | None) -> tuple[Sequence[Any] | None, str | None]:
    if isinstance(value, Mapping) and isinstance(value.get("value"), list):
        return value["value"] or None, value.get("unit", unit)
    return (value or None, unit) if isinstance(value, list) else (None, unit)


def _refuse(problem: Problem | None) -> None:
    if problem:
        raise InputError(problem)
