"""Every key that the declarations of measurement.yaml hold, and another value for each, for tests that walk them."""

from collections.abc import Iterator

from gear_damping.measurement import layout
from gear_damping.measurement.quantities import Column, Instant, Measured, Rows
from gear_damping.schema.mappings import Declared, inner_model, kind_of, names
from gear_damping.schema.values import Flag, Number, OneOf, Text, Value

Key = tuple[tuple[str, ...], Value, str]
OTHER_UNIT = {"m": "mm", "N*m": "mN*m", "rad": "mrad", "rad/s": "mrad/s", "m/s^2": "mm/s^2", "s": "min", "Hz": "1/min",
              "V": "mV", "kg*m^2": "kg*mm^2", "kg": "gram", "1": "%", "1/s^2": "1/ms^2", "1/s": "1/ms",
              "m/s": "mm/s", "mm/s": "m/s", "N": "mN", "m/s^2/N": "mm/s^2/N", "mm": "m", "mN*m": "N*m",
              "N/m": "N/mm"}  # fmt: skip
OTHER_COLUMN = {"wave": "tide", "ts": "t", "t": "ts", "pulses": "marks", "back_pulses": "marks"}


def declared_keys() -> Iterator[Key]:
    """Path of every key that the declarations hold, its kind, and the inner key of a quantity."""
    for system, model in layout.FILES.items():
        yield from _keys((system,), model)


def _keys(path: tuple[str, ...], model: type[Declared]) -> Iterator[Key]:
    for name, info in names(model).items():
        inner, kind = inner_model(info), kind_of(info)
        if inner is not None:
            yield from _keys((*path, name), inner)
            continue
        for part in kind.keys() or ("",):
            yield (*path, name, part) if part else (*path, name), kind, part


def holder(content: dict, path: tuple[str, ...]) -> dict | None:
    """The mapping that holds the last key of a path in the first record; None where it is not there."""
    for part in path[:-1]:
        content = content.get(part) if isinstance(content, dict) else None
        content = content[0] if isinstance(content, list) else content
    return content if isinstance(content, dict) and path[-1] in content else None


def another(value: object, kind: Value, part: str) -> object:
    """Another value of the same kind."""
    if part == "unit" or (isinstance(kind, Text) and value in OTHER_UNIT):
        return OTHER_UNIT[value]
    if part == "order":
        return 4
    if isinstance(kind, OneOf):
        return kind.choices[kind.choices.index(value) - 1]
    if isinstance(kind, Column):
        return OTHER_COLUMN.get(value, "f")
    if isinstance(kind, Rows):
        return [value[0] + 1, value[1]]
    if isinstance(kind, Flag):
        return not value
    if isinstance(kind, Text):
        return {"data.npz": "other.npz"}.get(value, f"{value}x")
    assert isinstance(kind, Instant | Number | Measured)
    return round(1.1 * value) if isinstance(kind, Measured) and kind.whole else 0.95 * value
