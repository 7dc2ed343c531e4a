"""Kinds of values that only measured data have: columns, rows, and quantities with their unit.

A check raises InputError with keys relative to the value ("" for the value itself, `unit` for its unit).
"""

import re
from dataclasses import dataclass
from math import inf
from types import MappingProxyType as Frozen
from typing import Any, NoReturn

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.measurement.record import Quantity
from gear_damping.schema.values import Number, OneOf, Text, Value, is_not_finite, refuse
from gear_damping.units import behind, is_of_kind, parse_unit, said_as, spoken, to_si

ORDERS = (1, 2, 4)  # poles of a Butterworth filter that the simulated sensor has too (`sensor_lowpass`)
NOT_UNCERTAIN = (
    "has no meaning here: only parameters, conditions of a gear_pair and the gain of a channel may be uncertain"
)
# What people write for a rate.
PERIODS = Frozen(
    dict.fromkeys(
        ("sampling_time", "sampling_period", "sample_time", "sampling_interval", "dt", "Ts"),
        "write sampling_rate, which may be the time from one sample to the next: {value: 3, unit: ms}",
    )
)
EACH_ITS_OWN = "make each file a record of its own, with the same channels"
Found = list[Problem]
_THOUSANDS = re.compile(r"^\s*([+-]?\d{1,3}(?:[, '’]\d{3})+)\s*([A-Za-z%µμ°].*?)?\s*$")  # `1,000 Hz`, `1 000 Hz`
_BARE = re.compile(r"^\s*[+-]?\d+(\.\d+)?\s*$")
_DECIMAL_COMMA = re.compile(r"^\s*([+-]?\d+),(\d+([eE][+-]?\d+)?\s*\D.*?)\s*$")
_BOTH_SIGNS = re.compile(r"^\s*(?:±|\+/?-)\s*(\S.*?)\s*$")  # `±50 mm`, `+-50 mm`
_ELECTRIC = ("V", "A")  # in which columns of sensors usually are
# The units that people mean by a bare number, by the unit that it is converted to.
_USUAL = Frozen(
    {
        "rad/s": ("rpm", "rad/s"),
        "Hz": ("Hz", "kHz"),
        "s": ("ms", "s"),
        "m": ("mm", "m"),
        "rad": ("deg", "rad"),
        "kg": ("kg", "gram"),
        "kg*m^2": ("kg*m^2", "kg*cm^2"),
        "N/m": ("N/um", "N/mm", "N/m"),
    }
)


class Gain(Number):
    """What a column holds for one unit of a quantity: a number, as the unit of the column is not declared."""

    def read(self, value: Any, name: str) -> float:
        """The number."""
        number, unit = said_as(value) or (0.0, "")
        of_column, _, of_quantity = unit.partition("/")
        if not of_quantity:
            return super().read(value, name)
        remedy = f"write unit: {of_quantity}, and gain: {number:g} where the column is in {of_column}"
        whole = next((one for one in _ELECTRIC if of_column != one and is_of_kind(of_column, one)), "")
        if whole:
            remedy += f", {to_si(number, of_column, whole):g} where it is in {whole}"
        return refuse("must be a number: what the column holds for one unit", value, remedy)


@dataclass(frozen=True)
class Share(Number):
    """A relative uncertainty; a bare number above 1 is more likely one in per cent."""

    least: float = 0.0
    unit: str = "1"

    def read(self, value: Any, name: str) -> float:
        """The number, as a part of one."""
        if isinstance(value, int | float) and not isinstance(value, bool) and 1 < value < inf:
            remedy = f"write {name}: {value:g} % (or {value / 100:g}), or {100 * value:g} % where it is"
            refuse(f"is relative, and means {100 * value:g} %", value, remedy)
        return super().read(value, name)


class Column(Value):
    """The header text of a column, or its 0-based index."""

    def read(self, value: Any, name: str) -> str | int:
        """The text or the index."""
        if isinstance(value, str | int) and not isinstance(value, bool):
            return value
        quotes = "put the header text in quotes: without them YAML reads off, on, yes and 1e3 as something else"
        remedy = quotes if isinstance(value, bool | float) else ""
        return refuse("must be the header text of a column or its 0-based index", value, remedy)

    def says(self) -> str:
        """A column."""
        return "header text, or 0-based index"


class FileName(Text):
    """The name of one file."""

    def read(self, value: Any, name: str) -> str:
        """The name; several files are several records."""
        if isinstance(value, list):
            return refuse("a record has one file", value, EACH_ITS_OWN)
        return super().read(value, name)


@dataclass(frozen=True)
class Instant(Value):
    """A time: a plain number in the unit that stands beside it, or a quantity."""

    def read(self, value: Any, name: str) -> float | Quantity:
        """The number, or the quantity in s."""
        said = said_as(value)
        if isinstance(value, str) and ":" in value:
            rule = "is a clock, and a window is in s from the record's first sample, from which clocks count"
            refuse(rule, value, "write s from there, for example 5 s")
        return Number().read(value, name) if said is None else Quantity(to_si(*said, "s", ""), "s")

    def says(self) -> str:
        """Both."""
        return "number in `unit`, or `{value, unit}`"


class Rows(Value):
    """Rows a to b-1 as [a, b]."""

    def read(self, value: Any, name: str) -> tuple[int, int]:
        """The two row numbers."""
        whole = isinstance(value, list) and all(type(row) is int for row in value)
        if not whole or len(value) != 2 or not 0 <= value[0] < value[1]:
            rule = "must be [a, b] with 0 <= a < b: rows a to b-1, counted from 0"
            refuse(rule, value, "write for example slice: [0, 5000]")
        return value[0], value[1]

    def says(self) -> str:
        """Two row numbers."""
        return "`[a, b]`, 0 <= a < b"


@dataclass(frozen=True)
class Corner:
    """A corner frequency in Hz and the order of the Butterworth filter that has it."""

    frequency: float
    order: int


@dataclass(frozen=True)
class Measured(Value):
    """A value with its unit, as {value, unit}.

    Args:
        unit: The SI unit that it is converted to; None keeps it as declared, `own` lets the unit be absent and
            means the rig's own one.
        sign: `positive`, `not negative`, `not zero` or `any`.
        uncertain: Whether a relative `uncertainty` has a meaning.
        whole: Whether it is a count.
        within: Smallest and largest value that makes sense, in `unit`; beyond them a unit is wrong.
        beyond: What to do about a value beyond them.
        excluded: What to do about a value that its sign excludes.
    """

    unit: str | None
    sign: str = "positive"
    uncertain: bool = False
    whole: bool = False
    within: tuple[float, float] | None = None
    beyond: str = "check the value and its unit"
    excluded: str = ""

    def keys(self) -> tuple[str, ...]:
        """The keys of the mapping."""
        return ("value", "unit", "uncertainty") if self.uncertain else ("value", "unit")

    def says(self) -> str:
        """The unit and the range."""
        units = {"1": "a number or `{value}`", "own": "in the rig's own unit", None: "in a unit of the channel's kind"}
        bounds = [self.sign] if self.sign != "any" else []
        bounds += [self._range] if self.within else []
        return ", ".join([units.get(self.unit, f"in `{self.unit}`"), *bounds, *(["whole"] if self.whole else [])])

    def read(self, value: Any, name: str) -> Any:
        """The quantity in SI, or as declared."""
        if said := spoken(value):
            value = {"value": said[0], "unit": said[1]}
        if isinstance(value, dict) and "unit" not in value and (said := spoken(value.get("value"))):
            value = value | {"value": said[0], "unit": said[1]}  # {value: 5 %, uncertainty: 0.02}
        if self.unit == "1" and not isinstance(value, dict):
            if is_not_finite(value):
                refuse("must be a finite number", value, self._finite(name))
            value = {"value": Number().read(value, name)}
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if is_number and value == 0 and self.unit not in (None, "own"):  # nothing is nothing in every unit
            value = {"value": value, "unit": self.unit}
        if not isinstance(value, dict):
            self._refuse_without_unit(value, name)
        if "column" in value:
            refuse("is one value, and no column", value, self._of_a_column(name))
        problems = self._unknown(value)
        number = self._number(value, name, problems)
        unit = self._unit(value, problems)
        uncertainty = self._part(value, "uncertainty", Share(), 0.0, problems) if self.uncertain else 0.0
        more = self.more(value, problems)
        if problems:
            raise InputError(problems)
        return self.made(self._checked(Quantity(number, unit, uncertainty)), more)

    def _of_a_column(self, name: str) -> str:
        """What helps where a column is named in the place of a value."""
        return (
            f"write the number and its unit, {self._remedy(None, None, name).removeprefix('write ')}; what a column "
            "holds is a channel"
        )

    def _refuse_without_unit(self, value: Any, name: str) -> NoReturn:
        """Say what is wrong with a value that is no mapping; of a number that no unit would help, that first."""
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if is_not_finite(value):
            remedy = f"{self._remedy(None, None, name)}; leave {name} out where it is not known"
            refuse("must be a finite number, and needs a unit", value, remedy)
        if is_number:
            self._refuse_sign(value, self._remedy(None, value, name))
        refuse("needs a value and a unit", value, self._remedy(value if is_number else None, value, name))

    def more(self, value: dict, problems: Found) -> Any:
        """What else the mapping holds."""

    def made(self, quantity: Quantity, more: Any) -> Any:
        """What the program keeps."""
        return quantity

    def _remedy(self, number: float | None, value: Any, name: str) -> str:
        """How to write it; no one unit is offered for a bare number, whose unit only the user knows."""
        if isinstance(value, str) and (parted := _THOUSANDS.match(value)):
            number, unit = re.sub(r"\D", "", parted[1]), parted[2] or self._example
            point = f", or {parted[1].replace(',', '.')} {unit} with a decimal point" if "," in parted[1] else ""
            return f"write {name}: {number} {unit}, without a sign between thousands{point}"
        if isinstance(value, str) and (comma := _DECIMAL_COMMA.match(value)):
            return f"write a decimal point, not a comma: {name}: {comma[1]}.{comma[2]}"
        if isinstance(value, str) and (both := _BOTH_SIGNS.match(value)) and spoken(both[1]):
            return f"write {name}: {both[1]}, without a sign"
        if number is None and self.unit is None:
            return f"say it in the unit of the channel or one of its kind, as {name}: 5 mm for one in mm"
        if number is None:
            number = value.strip() if isinstance(value, str) and _BARE.match(value) else "…"
            return f"write {name}: {{value: {number}, unit: {self._example}}}, or {name}: {number} {self._example}"
        if self.unit is None:
            return f"say it in the unit of the channel or one of its kind, as {name}: {number} mm for one in mm"
        if self.unit == "own":
            return (
                f"give it in the response's unit per s^2 and per the force's, as {name}: {number} mm/s^2/N for mm and "
                "N, or m/s^2/V for m and V"
            )
        usual = self._usual(number)
        first = f"write {name}: {{value: {number}, unit: {usual[0]}}}, or {name}: {number} {usual[0]}"
        return (
            first + "".join(f", or {number} {unit}" for unit in usual[1:]) + ", whichever it is in" * (len(usual) > 1)
        )

    def _usual(self, number: float) -> tuple[str, ...]:
        """The units that a bare number may be in."""
        return _USUAL.get(self.unit, (self._example,))

    @property
    def _example(self) -> str:
        return {None: "V", "own": "m/s^2/V"}.get(self.unit, self.unit)

    def _number(self, value: dict, name: str, problems: Found) -> float | None:
        """The number of the mapping; None where it has none that is finite, which is noted."""
        if is_not_finite(number := value.get("value")):
            problems.append(Problem("value", "must be a finite number", number, self._finite(name)))
            return None
        return self._part(value, "value", Number(), None, problems)

    def _finite(self, name: str) -> str:
        """What helps where infinity or nan stands for a value."""
        return f"write a finite number, or leave {name} out where it is not known"

    def _unknown(self, value: dict) -> Found:
        found = []
        for key in value:
            if key == "uncertainty" and not self.uncertain:
                found.append(Problem(key, NOT_UNCERTAIN, value[key], "leave it out"))
            elif key not in self.keys():
                comma = str(key).isdigit() and value[key] is None  # {value: 1200,5} holds a key 5 without a value
                remedy = "write a decimal point, not a comma" if comma else nearest(str(key), self.keys())
                found.append(Problem(str(key), "unknown key", None, remedy))
        return found

    def _part(self, value: dict, key: str, kind: Value, default: Any, problems: Found) -> Any:
        if key not in value and key == "value":
            problems.append(Problem(key, "is missing", None, "give a number"))
        if key not in value:
            return default
        try:
            return kind.read(value[key], key)
        except InputError as error:
            problems += [Problem(key, p.rule, p.value, p.remedy) for p in error.problems]
            return default

    def _unit(self, value: dict, problems: Found) -> str:
        assumed = self.unit if self.unit in ("1", "own") else None
        if "unit" not in value and assumed is None:
            problems.append(Problem("unit", "is missing", None, f"give a unit, for example {self._example}"))
        return self._part(value, "unit", Text(), assumed, problems)

    def _checked(self, found: Quantity) -> Quantity:
        number = found.value
        self._refuse_sign(number)
        if found.uncertainty and number == 0:
            rule = "an uncertainty is relative, and there is nothing to relate it to where the value is 0"
            remedy = "state a small value, as 0.1 with an uncertainty of 5000 % for 0.1 +- 5"
            refuse(rule, found.uncertainty, remedy, "uncertainty")
        if self.unit in (None, "own"):
            if found.unit != "own" or self.unit is None:
                parse_unit(found.unit, "unit")
            return found
        return self._in_range(Quantity(to_si(number, found.unit, self.unit, ""), self.unit, found.uncertainty), found)

    def _refuse_sign(self, number: float, otherwise: str = "") -> None:
        """Refuse a number of a sign that it must not have, with a remedy where none is known of its own."""
        remedy = self.excluded or otherwise
        if self.sign == "positive" and not number > 0:
            refuse("must be positive", number, remedy)
        if self.sign == "not negative" and number < 0:
            refuse("must not be negative", number, remedy)
        if self.sign == "not zero" and number == 0:
            refuse("must not be 0", number, remedy)

    def _in_range(self, quantity: Quantity, found: Quantity) -> Quantity:
        """The quantity in SI, refused where it is no count or nothing that a rig has."""
        plain = int(found.value) if found.value == round(found.value) else found.value
        said = plain if found.unit == "1" else f"{found.value:g} {found.unit}"
        if self.whole and quantity.value != round(quantity.value):
            refuse("must be a whole number", said)
        if self.within and not self.within[0] <= quantity.value <= self.within[1]:
            refuse(f"lies outside {self._range}", said, self.beyond)
        return quantity

    @property
    def _range(self) -> str:
        return f"{self.within[0]:g} to {self.within[1]:g}{behind(self.unit)}"


@dataclass(frozen=True)
class Rate(Measured):
    """Samples a second, or the time from one to the next."""

    unit: str | None = "Hz"

    def _usual(self, number: float) -> tuple[str, ...]:
        """A number below one is hardly a rate."""
        return super()._usual(number) if number >= 1 else ("Hz", "s from one sample to the next")

    def _of_a_column(self, name: str) -> str:
        """What helps where a column is named in the place of a rate."""
        return f"write the number and its unit, {name}: 2 kHz; a column of stamps is time: {{column: …, unit: s}}"

    def says(self) -> str:
        """Both."""
        return "in `Hz`, or in `s` from one sample to the next, positive"

    def _checked(self, found: Quantity) -> Quantity:
        is_period = parse_unit(found.unit, "unit").dimension == parse_unit("s").dimension
        if is_period and found.value > 0:
            found = Quantity(1 / to_si(found.value, found.unit, "s"), "Hz")
        return super()._checked(found)


@dataclass(frozen=True)
class Cutoff(Measured):
    """A corner frequency as {value, unit, order}."""

    unit: str | None = "Hz"
    usual: int = 2

    def keys(self) -> tuple[str, ...]:
        """The keys of the mapping."""
        return ("value", "unit", "order")

    def says(self) -> str:
        """The unit, and the orders."""
        return f"in `Hz`, positive; `order` {', '.join(map(str, ORDERS))} ({self.usual} where absent)"

    def more(self, value: dict, problems: Found) -> int:
        """The order of the filter."""
        return self._part(value, "order", OneOf(ORDERS), self.usual, problems)

    def _checked(self, found: Quantity) -> Quantity:
        if found.unit.replace(" ", "") in ("1/s", "s^-1"):
            remedy = "say which: in Hz what counts turns; of radians the 2 pi-th part"
            refuse("may count turns or radians", f"{found.value:g} {found.unit}", remedy)
        return super()._checked(found)

    def made(self, quantity: Quantity, more: int) -> Corner:
        """The corner with its order."""
        return Corner(quantity.value, more)


@dataclass(frozen=True)
class Ratio(Measured):
    """A damping ratio; a bare number above 1 is more likely one in per cent."""

    def read(self, value: Any, name: str) -> Any:
        """The quantity, as a part of one."""
        number = value.get("value") if isinstance(value, dict) and not value.get("unit") else value
        if isinstance(number, int | float) and not isinstance(number, bool) and 1 < number < inf:
            refuse(f"means {100 * number:g} %", value, f"write {name}: {number:g} %, or {100 * number:g} % where it is")
        return super().read(value, name)
