"""Kinds of plain values: each checks itself, says what is wrong in one message, and describes itself for the pages.

A check raises InputError with keys relative to the value ("" for the value itself).
"""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any, NoReturn

from pydantic import GetCoreSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.units import SUFFIXES, number_in

_COMMA = re.compile(r"[+-]?\d+,\d+")  # a number with a decimal comma
_NOT_FINITE = re.compile(r"^\s*[+-]?\.?(inf|infinity|nan)\b", re.I)


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


def refuse(rule: str, value: object = None, remedy: str = "", at: str = "") -> NoReturn:
    """Raise InputError about a value, or about the key `at` in it."""
    raise InputError(Problem(at, rule, value, remedy))


def is_not_finite(value: object) -> bool:
    """Whether it is infinite or nan, or a text that begins like it, `inf mm`."""
    if isinstance(value, str):
        return bool(_NOT_FINITE.match(value))
    return isinstance(value, int | float) and not isfinite(value)


class Value:
    """A kind of value: `read` checks it and `says` describes it."""

    def read(self, value: Any, name: str) -> Any:
        """The value in the form that the program keeps; raises InputError."""
        raise NotImplementedError

    def says(self) -> str:
        """What may be written, for the reference page."""
        raise NotImplementedError

    def keys(self) -> tuple[str, ...]:
        """The keys of a value that is a mapping; none for a plain one."""
        return ()

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        def check(value: Any, info: ValidationInfo) -> Any:
            return self.read(value, info.field_name or "")

        return core_schema.with_info_plain_validator_function(check)


class Text(Value):
    """A text that is not empty."""

    def read(self, value: Any, name: str) -> str:
        """The text; `unit: 1`, a pure number, is one too."""
        if isinstance(value, str) and value.strip():
            return value
        if type(value) is int and name == "unit":
            return str(value)
        return refuse("must be a text", value, "put it in quotes" if isinstance(value, int | float) else "write a text")

    def says(self) -> str:
        """A text."""
        return "text"


class Flag(Value):
    """True or false."""

    def read(self, value: Any, name: str) -> bool:
        """The flag."""
        if not isinstance(value, bool):
            refuse("must be true or false", value, "write true or false")
        return value

    def says(self) -> str:
        """A flag."""
        return "`true` or `false`"


@dataclass(frozen=True)
class OneOf(Value):
    """One of a few words or numbers."""

    choices: tuple[object, ...]

    def read(self, value: Any, name: str) -> Any:
        """The word; Python takes True for 1, people do not."""
        words = [str(choice) for choice in self.choices]
        if not isinstance(value, bool) and isinstance(value, str | int) and str(value) in words:
            return self.choices[words.index(str(value))]
        return refuse(f"must be one of {', '.join(words)}", value, nearest(str(value), words))

    def says(self) -> str:
        """The words."""
        return ", ".join(f"`{choice}`" for choice in self.choices)


@dataclass(frozen=True)
class Number(Value):
    """A finite number.

    Args:
        least: Smallest value.
        most: Largest value.
        whole: Whether it counts something.
        exclusive: Whether the bounds themselves are excluded.
        nonzero: Whether 0 is.
        unit: What it is in; a quantity in any unit of that kind may be given too. Empty: what its key ends in, if that
            is a unit (`frequency_max_hz`).
    """

    least: float = -inf
    most: float = inf
    whole: bool = False
    exclusive: bool = False
    nonzero: bool = False
    unit: str = ""

    def read(self, value: Any, name: str) -> float:
        """The number as a float; one that counts as an int."""
        unit = self.unit_of(name)
        if unit:
            value = number_in(value, unit)
        kind, words = (int, "a whole number") if self.whole else (int | float, "a number")
        words += f", or a quantity such as 1 {unit}" if unit not in ("", "1") else ""
        if is_not_finite(value):
            rule = f"must be a {'whole' if self.whole else 'finite'} number"
            refuse(rule, value, f"write {words}: neither infinity nor nan is one")
        if isinstance(value, bool) or not isinstance(value, kind):
            remedy = f"write {words}"
            if isinstance(value, str) and _COMMA.fullmatch(value.strip()):
                remedy = f"write {value.strip().replace(',', '.')}, with a decimal point"
            refuse(f"must be {'a whole number' if self.whole else 'a finite number'}", value, remedy)
        if not (self.least < value < self.most if self.exclusive else self.least <= value <= self.most):
            refuse(*self._range(value))
        if self.nonzero and value == 0:
            refuse("must not be 0", value, "leave it out where there is none")
        return value if self.whole else float(value)

    def says(self) -> str:
        """The number and its range."""
        bounds = [f"at least {self.least:g}"] if isfinite(self.least) else []
        unit = f" in `{self.unit}`" if self.unit not in ("", "1") else ""
        return ", ".join([f"number{unit}", *bounds, *(["not 0"] if self.nonzero else [])])

    def unit_of(self, name: str) -> str:
        """The unit of a plain number under a key; empty where it has none."""
        return self.unit or SUFFIXES.get(name.rpartition("_")[2], "")

    def _range(self, value: float) -> tuple[str, float, str]:
        """Rule, value and remedy of a number that lies outside."""
        if isfinite(self.least) and not isfinite(self.most):
            return f"must be at least {self.least:g}", value, ""
        near = min(max(value, self.least), self.most)
        side = ("just above " if near == self.least else "just below ") if self.exclusive else ""
        rule = f"must lie {'strictly between' if self.exclusive else 'within'} {self.least:.10g} and {self.most:.10g}"
        return rule, value, f"nearest valid value {side}{near:.10g}"


@dataclass(frozen=True)
class Names(Value):
    """A list of different names, of a few where `choices` says which."""

    choices: tuple[str, ...] = ()

    def read(self, value: Any, name: str) -> list[Any]:
        """The names."""
        if not _differ(value):
            refuse("must be a list of different names", value, f"write {self._example(value)}")
        for one in value if self.choices else ():
            if one not in self.choices:
                refuse(f"must be one of {', '.join(self.choices)}", value, nearest(str(one), self.choices))
        return value

    def _example(self, value: Any) -> str:
        """What was meant as a list, or how one is written."""
        if isinstance(value, str) and value:
            return f"[{value}], also for one alone"
        named = list(dict.fromkeys(map(str, value))) if isinstance(value, list) and value else ["first", "second"]
        return f"[{', '.join(named)}], each name once"


@dataclass(frozen=True)
class Levels(Value):
    """A list of different numbers, or a span, two that ascend."""

    each: Number
    ascend: bool = False

    def read(self, value: Any, name: str) -> list[float]:
        """The numbers."""
        unit = self.each.unit_of(name)
        if unit and isinstance(value, list):
            value = [number_in(one, unit) for one in value]
        words = "two numbers that ascend, [1, 30]" if self.ascend else "a list of different numbers, [30, 20, 10]"
        is_list = _differ(value) or (self.ascend and isinstance(value, list))
        if not is_list or not all(type(one) in (int, float) and isfinite(one) for one in value):
            refuse(f"must be {words}", value, f"write {words}")
        if self.ascend and not (len(value) == 2 and value[0] <= value[1]):
            refuse(f"must be {words}", value, f"write {words}")
        for one in value:
            try:
                self.each.read(one, name)
            except InputError as error:
                refuse(error.problems[0].rule, value, error.problems[0].remedy)
        return value


def _differ(value: Any) -> bool:
    return isinstance(value, list) and 0 < len(value) == len(set(map(str, value)))


@dataclass(frozen=True)
class Given(Value):
    """A value of the configuration, where every key stands; null says that it is open, where it may be."""

    kind: Value
    optional: bool = False

    def read(self, value: Any, name: str) -> Any:
        """The value, or None."""
        if value is not None:
            return self.kind.read(value, name)
        choices: Sequence[object] = getattr(self.kind, "choices", ())
        remedy = f"choose one of {', '.join(map(str, choices))}" if choices else "give a value"
        return None if self.optional else refuse("must be given", None, remedy)
