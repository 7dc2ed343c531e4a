"""Declarations of what an effect or a system can be given: parameters (numbers) and options (choices)."""

from dataclasses import dataclass
from math import inf, pi

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.units import Dimension, parse_unit

# The units of drawings, and their size in SI.
USUAL = {"m": (("mm", 1e-3), ("um", 1e-6)), "rad": (("deg", pi / 180),)}


@dataclass(frozen=True)
class Parameter:
    """A number with a unit, bounds and a default, all in SI.

    Args:
        name: Its key in the configuration.
        unit: Its SI unit; the conversion to the solver's natural units follows from it.
        default: The value when the effect is on and the key is absent; None: it must be given.
        lower: Smallest value that makes sense.
        upper: Largest value that makes sense.
        meaning: One line for the documentation.
        source: `paper` where the paper prints the value, `assumed` elsewhere.
        vector: Whether it is a list of values (harmonics, teeth, steps) instead of one.
        whole: Whether it counts something.
    """

    name: str
    unit: str
    default: float | tuple[float, ...] | None
    meaning: str
    lower: float = -inf
    upper: float = inf
    source: str = "assumed"
    vector: bool = False
    whole: bool = False

    @property
    def dimension(self) -> Dimension:
        """Exponents of mass, length, time, angle, voltage and current."""
        return parse_unit(self.unit).dimension

    def problem(self, value: float, key: str, source: str = "") -> Problem | None:
        """The problem with `value` (SI), or None when it lies within the bounds and is whole where it must be."""
        inside = self.lower <= value <= self.upper
        if inside and (not self.whole or value == round(value)):
            return None
        rule = "must be a whole number" if inside else f"must lie within {self.lower:g} … {self.upper:g} {self.unit}"
        nearest_valid = min(max(value, self.lower), self.upper) if value == value else self.default
        nearest_valid = round(nearest_valid) if self.whole else nearest_valid
        return Problem(key, rule, value, self._as_in(value) or f"nearest valid value {nearest_valid:g}", source)

    def _as_in(self, value: float) -> str:
        """The value in SI that a number was meant to be in the unit that drawings have; empty where it is none."""
        meant = [(unit, value * factor) for unit, factor in USUAL.get(self.unit, ())]
        said = [f"{value:g} {unit} are {one:.4g}" for unit, one in meant if self.lower <= one <= self.upper < value]
        return f"in {self.unit}: {', '.join(said)}" if said else ""


@dataclass(frozen=True)
class Option:
    """A choice that changes the form of an equation."""

    name: str
    choices: tuple[object, ...]
    default: object
    meaning: str

    def problem(self, value: object, key: str, source: str = "") -> Problem | None:
        """The problem with `value`, or None when it is one of the choices."""
        if any(value == choice and type(value) is type(choice) for choice in self.choices):
            return None
        rule = "must be one of " + ", ".join(str(choice) for choice in self.choices)
        return Problem(key, rule, value, nearest(str(value), [str(c) for c in self.choices]), source)


@dataclass(frozen=True)
class UnitOption(Option):
    """A unit, of any kind; None where nobody knows it."""

    def problem(self, value: object, key: str, source: str = "") -> Problem | None:
        """The problem with `value`, or None when it is a unit."""
        if value is None:
            return None
        if not isinstance(value, str):
            return Problem(key, "must be a unit", value, f"for example {self.default}", source)
        try:
            parse_unit(value, key, source)
        except InputError as error:
            return error.problems[0]
        return None
