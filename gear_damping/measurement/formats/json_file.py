"""JSON as loggers, web services and pandas write it: columns by name, rows as objects or lists, one object a line.

Channels in a list of objects, `{"name": "x", "unit": "mm", "data": [...]}`, go by their names. What lies deeper bears
the path to it, `axle.x`, and rows of lists are columns `x[0]`, `x[1]`, as elsewhere; lists of objects with long lists
in them are records, `data[0].x`.
"""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.formats.moments import moments_of
from gear_damping.measurement.formats.not_applied import not_applied, said_of
from gear_damping.measurement.formats.number_texts import is_number
from gear_damping.measurement.formats.stated_rate import rate_beside
from gear_damping.measurement.formats.table import ArrayTable, Held, Table, held_arrays, unreadable
from gear_damping.measurement.formats.units_beside import units_beside

SUFFIXES = (".json", ".jsonl", ".ndjson")

_UNITS = ("unit", "units")  # beside the one list of an object, which then is a channel
_NAME = re.compile(
    r"^(channel|signal|sensor)?_?(name|label|id)$|^(channel|signal)$", re.I
)  # the key of what it is called
_NAMES = "columns"  # beside rows of lists, as pandas writes them apart (`orient="split"`)


def read(path: Path, max_bytes: int) -> Table:
    """The lists of a JSON file as columns; numbers as they are, clocks as s from the first, null as nan.

    Raises:
        InputError: not JSON, or it holds no list of numbers.
    """
    with unreadable(path, "not a readable JSON file", "export it again, or as CSV"):
        held, left_out, single, texts = [], [], {}, {}
        for name, values, unit in _lists("", _parsed(path.read_bytes())):
            array, begins = _array(values)
            own, other = held_arrays({name: array})
            if array.size == 1 and own:
                single[name] = array
            if len(values) == 1 and isinstance(values[0], str):
                texts[name] = values[0]
            begun = None if begins is None else lambda begins=begins: begins
            held += [replace(one, unit=unit, begins=begun) for one in own]
            left_out += other
        units = units_beside((one.name for one in held if one.shape != (1,)), texts)
        held = [replace(one, unit=one.unit or units.get(one.name)) for one in held]
        table = ArrayTable(path, _channels(held), left_out)
    table.stated_rate = rate_beside(single, texts)
    table.not_applied = _scales(held, single)
    table.notes += said_of(path.name, table.not_applied)
    return table


def _scales(held: list[Held], single: Mapping[str, NDArray]) -> dict[str, dict[str, float]]:
    """The factors and zeros that stand beside the values of a channel, by its name."""
    found = {}
    for one in held:
        below = f"{one.name}."
        beside = {name[len(below) :]: value.item() for name, value in single.items() if name.startswith(below)}
        if one.name and one.name not in single and (scales := not_applied(beside)):
            found[one.name] = scales
    return found


def _channels(held: list[Held]) -> list[Held]:
    """What has more than one value, where anything has: the others state something of it."""
    return [one for one in held if one.shape != (1,)] or held


def _parsed(content: bytes) -> Any:
    """What a file holds; a list of its lines where each is JSON of its own."""
    text = content.decode(json.detect_encoding(content)).removeprefix("\ufeff")
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        try:
            return [json.loads(line) for line in text.splitlines() if line.strip()]
        except json.JSONDecodeError:
            raise error from None


def _lists(name: str, value: Any, unit: str | None = None) -> Iterator[tuple[str, Sequence[Any], str | None]]:
    """Every list of single values below a value: its path, what it holds, its unit."""
    if isinstance(value, dict):
        yield from _of_object(name, value)
    elif not isinstance(value, list):
        yield name, [value], unit
    elif (channels := _own_names(value)) is not None:
        for own, (channel, key) in channels.items():
            unit = next((channel[one] for one in _UNITS if isinstance(channel.get(one), str)), None)
            own = name + own if own.startswith("[") else own
            yield own, channel[key], unit
            for other in (one for one in channel if one not in (key, *_UNITS) and not _NAME.match(one)):
                yield from _lists(_below(own, other), channel[other])
    elif _are_records(value):
        for k, one in enumerate(value):
            yield from _lists(f"{name}[{k}]", one)
    elif any(isinstance(one, dict) for one in value):
        rows = [one if isinstance(one, dict) else {} for one in value]
        for key in dict.fromkeys(key for row in rows for key in row):
            yield from _lists(_below(name, key), [row.get(key) for row in rows])
    elif any(isinstance(one, list) for one in value):
        rows = [one if isinstance(one, list) else [] for one in value]
        for place in range(max(map(len, rows))):
            column = [row[place] if place < len(row) else None for row in rows]
            yield from _lists(f"{name}[{place}]" if name else "", column, unit)
    else:
        yield name, value, unit


def _own_names(value: list[Any]) -> dict[str, tuple[dict[str, Any], str]] | None:
    """The channels of a list by their names, each with the key of its values; None of a list of anything else.

    A channel is an object with a name that no other has, and one list of single values; without a name the lists must
    be longer than that of the objects, and it goes by its number, `[0]`.
    """
    found: dict[str, tuple[dict[str, Any], str]] = {}
    for k, one in enumerate(value):
        keys = [key for key, inner in one.items() if isinstance(inner, list)] if isinstance(one, dict) else []
        named = [one[key] for key in one if _NAME.match(key) and isinstance(one[key], str)] if keys else []
        named = named or [f"[{k}]" for key in keys if len(one[key]) > len(value)]
        if len(keys) != 1 or not named or named[0] in found or any(isinstance(k, dict | list) for k in one[keys[0]]):
            return None
        found[named[0]] = one, keys[0]
    return found or None


def _are_records(value: list[Any]) -> bool:
    """Whether a list is one of objects that hold records: lists of more numbers than there are objects."""
    lists = [one for row in value if isinstance(row, dict) for one in row.values() if isinstance(one, list)]
    long = [one for one in lists if len(one) > len(value) and all(isinstance(x, int | float | None) for x in one)]
    return bool(long) and all(isinstance(row, dict) for row in value)


def _of_object(name: str, value: dict[str, Any]) -> Iterator[tuple[str, Sequence[Any], str | None]]:
    lists = [key for key, one in value.items() if isinstance(one, list)]
    names = value.get(_NAMES)
    if isinstance(names, list) and len(lists) > 1 and all(isinstance(one, str) for one in names):
        for key in (key for key in lists if key != _NAMES):
            rows = [dict(zip(names, row, strict=False)) for row in value[key] if isinstance(row, list)]
            yield from _lists(name, rows) if rows else ()
        return
    if len(value) > 1 and all(key.isdecimal() for key in value):  # rows by their number, as pandas writes a column
        yield from _lists(name, list(value.values()))
        return
    unit = next((value[key] for key in _UNITS if isinstance(value.get(key), str)), None)
    if len(lists) == 1 and unit is not None:
        yield from _lists(name or lists[0], value[lists[0]], unit)
        for key in (key for key in value if key not in (lists[0], *_UNITS)):
            yield from _lists(_below(name, key), value[key])
        return
    for key, one in value.items():
        yield from _lists(_below(name, key), one)


def _below(name: str, key: str) -> str:
    return f"{name}.{key}" if name else key


def _array(values: Sequence[Any]) -> tuple[NDArray, float | None]:
    """Numbers, written as texts too, and clocks with when the first was; of anything else an array of objects."""
    told = [k for k, one in enumerate(values) if one is not None]
    cells, numbers = [values[k] for k in told], np.full(len(values), np.nan)
    if not cells:
        return np.empty(0), None
    if all(isinstance(one, int | float) for one in cells):
        numbers[told] = cells
        return numbers, None
    texts = [one.strip() for one in cells if isinstance(one, str)]
    if len(texts) == len(cells):
        if all(is_number(one) for one in texts):
            numbers[told] = [float(one) for one in texts]
            return numbers, None
        if (found := moments_of(texts)) is not None:
            numbers[told] = found.seconds
            return numbers, found.begins
    return np.array([str(one) for one in values], dtype=object), None
