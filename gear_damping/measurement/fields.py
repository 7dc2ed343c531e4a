"""Reading a YAML mapping key by key: what is wrong is noted and reading goes on."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import isfinite

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.measurement.record import Quantity
from gear_damping.measurement.vocabulary import QUANTITY_KEYS
from gear_damping.units import to_si


class Problems(list[Problem]):
    """The problems found so far."""

    @contextmanager
    def collecting(self) -> Iterator[None]:
        """Keep the problems of an InputError raised inside, and go on after the block."""
        try:
            yield
        except InputError as error:
            self.extend(error.problems)

    def raise_any(self) -> None:
        """Raise all of them at once, each said once; nothing where there are none."""
        if self:
            raise InputError([problem for k, problem in enumerate(self) if problem not in self[:k]])


class Fields:
    """A mapping of the YAML with the path that leads to it.

    Args:
        content: What stands in the YAML.
        key: Its path, for example `records[0].channels`.
        allowed: The keys that may appear.
        problems: Takes what is wrong.
        source: The YAML file.
    """

    def __init__(self, content: object, key: str, allowed: Sequence[str], problems: Problems, source: str) -> None:
        self.key, self.problems, self.source = key, problems, source
        if not isinstance(content, dict):
            rule = f"must be a mapping with keys among {', '.join(allowed)}"
            problems.append(Problem(key or "the file", rule, content, "write `key: value` lines", source))
            content = {}
        self.content = {name: value for name, value in content.items() if name in allowed}
        for name in content:
            if name not in allowed:
                problems.append(Problem(self.path(name), "unknown key", None, nearest(name, allowed), source))

    def path(self, name: object) -> str:
        """The full path of one of the keys."""
        return f"{self.key}.{name}" if self.key else str(name)

    def __contains__(self, name: str) -> bool:
        return name in self.content

    def add(self, name: str, rule: str, remedy: str = "") -> None:
        """Note that the value of `name` is wrong."""
        self.problems.append(Problem(self.path(name), rule, self.content.get(name), remedy, self.source))

    def missing(self, name: str, remedy: str) -> None:
        """Note that `name` is not there."""
        self.problems.append(Problem(self.path(name), "is missing", None, remedy, self.source))

    def fields(self, name: str, allowed: Sequence[str]) -> "Fields":
        """The mapping under `name`; an empty one where the key is absent."""
        return Fields(self.content.get(name, {}), self.path(name), allowed, self.problems, self.source)

    def text(self, name: str) -> str | None:
        """A text, or None where the key is absent."""
        value = self.content.get(name)
        if value is None or (isinstance(value, str) and value.strip()):
            return value
        if isinstance(value, int) and name == "unit":  # `unit: 1`, a pure number
            return str(value)
        return self.add(name, "must be a text", "put it in quotes")

    def choice(self, name: str, choices: Sequence[object], default: object = None) -> object:
        """One of `choices`."""
        value = self.content.get(name, default)
        if value in choices and not isinstance(value, bool):  # Python takes True for 1
            return value
        if name in self.content:
            words = [str(choice) for choice in choices]
            self.add(name, f"must be one of {', '.join(words)}", nearest(str(value), words))
        return default

    def flag(self, name: str) -> bool:
        """True or false; false where the key is absent."""
        value = self.content.get(name, False)
        if not isinstance(value, bool):
            self.add(name, "must be true or false")
        return value is True

    def number(self, name: str, least: float | None = None, default: float | None = None) -> float | None:
        """A finite number, at least `least`."""
        if name not in self.content:
            return default
        value = self.content[name]
        if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
            self.add(name, "must be a finite number")
        elif least is not None and value < least:
            self.add(name, f"must be at least {least:g}")
        else:
            return float(value)
        return default

    def column(self, name: str = "column") -> str | int | None:
        """A column: its header text, or its 0-based index."""
        value = self.content.get(name)
        if value is None or (isinstance(value, str | int) and not isinstance(value, bool)):
            return value
        return self.add(name, "must be the header text of a column or its 0-based index")

    def quantity(self, name: str, expected: str | None) -> Quantity | None:
        """A value with unit in SI; as declared where `expected` is None.

        A pure number may stand alone where `expected` is "1".
        """
        if name not in self.content:
            return None
        if expected == "1" and not isinstance(self.content[name], dict):
            value = self.number(name)
            return None if value is None else Quantity(value, "1")
        if not isinstance(self.content[name], dict):
            unit = expected or "V"
            return self.add(name, "needs a value and a unit", f"write {name}: {{value: 1.0, unit: {unit}}}")
        inner = self.fields(name, QUANTITY_KEYS)
        value, uncertainty = inner.number("value"), inner.number("uncertainty", least=0.0, default=0.0)
        unit = inner.text("unit") or ("1" if expected == "1" else None)
        if "value" not in inner:
            inner.missing("value", "give a number")
        if unit is None and "unit" not in inner:
            inner.missing("unit", f"give a unit, for example {expected or 'V'}")
        if value is None or unit is None:
            return None
        if expected is None:
            return Quantity(value, unit, uncertainty)
        with self.problems.collecting():
            return Quantity(to_si(value, unit, expected, self.path(name), self.source), expected, uncertainty)
        return None

    def positive(self, name: str, expected: str) -> float | None:
        """The value of a quantity that must be above zero, in SI."""
        quantity = self.quantity(name, expected)
        if quantity is not None and not quantity.value > 0:
            return self.add(name, "must be positive")
        return None if quantity is None else quantity.value
