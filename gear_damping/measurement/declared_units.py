"""The units that values are kept in: SI where the mass of the rig is known, else the rig's own.

An oscillator measured in volts or degrees stays in them; its velocity and acceleration are put in
the displacement's unit per second, and all its records in the units of the first.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.bracket_words import is_count
from gear_damping.measurement.record import Quantity
from gear_damping.measurement.vocabulary import OSCILLATOR_CHANNELS, SHAFT_SPEEDS
from gear_damping.units import LEVEL, Dimension, Unit, of_a_shaft, other_kind, parse_unit

_PER_SECOND = Dimension(time=-1)  # exponent of a derivative in time
_PER = {0: "", 1: "/s", 2: "/s^2"}
_VELOCITY, _ANGULAR_ACCELERATION = parse_unit("m/s"), parse_unit("rad/s^2")
_WHOLE = {"pinion_angle": "rev"}  # what people count the parts of, where it is not the unit in SI
_BASE = "base_acceleration"  # an input in the unit of the response's acceleration


@dataclass(frozen=True)
class Conversion:
    """`value * factor` is the value in `unit`."""

    factor: float
    unit: str


@dataclass(frozen=True)
class _Reference:
    """The unit that a kind of channel is kept in; `order` counts time derivatives."""

    unit: Unit
    text: str
    order: int


class UnitSystem:
    """Converts what was declared into the units that are kept.

    Args:
        si: The unit that each channel is kept in; None where the rig is kept in the unit of its response.
        declared: Name and unit of every channel, in the order of the file; unknown units are skipped.
    """

    def __init__(self, si: Mapping[str, str] | None, declared: Iterable[tuple[str, str]]) -> None:
        self.si = si
        self._response: _Reference | None = None
        self._force: _Reference | None = None
        for name, text in declared if si is None else ():
            if name == _BASE:
                continue
            try:
                unit = parse_unit(text)
            except InputError:
                continue  # reported where the channel itself is converted
            order = OSCILLATOR_CHANNELS[name]
            if order is None:
                self._force = self._force or _Reference(unit, text, 0)
            elif self._response is None or order < self._response.order:
                self._response = _Reference(unit, text, order)

    def conversion(
        self, name: str, text: str, key: str, source: str, radius: float | None = None, said: str = ""
    ) -> Conversion:
        """How values of channel `name` in the unit `text` are converted.

        Args:
            name: The channel.
            text: The unit.
            key: What is at fault in messages.
            source: The file that declares it.
            radius: m, at which the speed of a shaft, or its acceleration, is measured along the circumference.
            said: The whole value, of a limit of the channel, as its noise.

        Raises:
            InputError: the unit is unknown or of another kind than the channel.
        """
        if text.strip() == LEVEL:
            rule, remedy = "a level is a logarithm, and no signal", "give the values themselves, 10^(level/20)"
            raise InputError(Problem(key, rule, text, remedy, source))
        if self.si is not None and is_count(text):
            rule, whole = "says nothing of how much one count is", _WHOLE.get(name, self.si[name])
            remedy = f"write unit: {whole}, and gain: the counts of one {whole}, by which values are divided"
            raise InputError(Problem(key, rule, said or text, remedy, source))
        unit = parse_unit(text, key, source)
        if name in SHAFT_SPEEDS and (radius or unit.dimension == _VELOCITY.dimension):
            return _around(unit, radius, self.si[name], key, text, source)
        if radius and self.si is not None and unit.dimension == _ANGULAR_ACCELERATION.dimension:
            return Conversion(unit.factor * radius, self.si[name])
        if name == "acceleration" and self.si is not None and unit.dimension == _ANGULAR_ACCELERATION.dimension:
            rule = f"'{text}' is the acceleration of a shaft's angle, which a casing has none of"
            raise InputError(Problem(key, rule, text, "say whose it is: mounting: tangential, shaft: pinion", source))
        if self.si is not None:
            kept = _Reference(parse_unit(self.si[name]), self.si[name], 0)
            unit = of_a_shaft(unit, kept.unit)
        else:
            kept = self._oscillator_unit(name, text, unit)
        if unit.dimension != kept.unit.dimension:
            rule = f"the unit '{text}' is not one of the kind of '{kept.text}'"
            remedy = ("it is in the unit of the channel: " if said else "") + other_kind(unit, kept.text)
            raise InputError(Problem(key, rule, said or text, remedy, source))
        return Conversion(unit.factor / kept.unit.factor, kept.text)

    def _oscillator_unit(self, name: str, text: str, unit: Unit) -> _Reference:
        order = 2 if name == _BASE else OSCILLATOR_CHANNELS[name]
        reference = self._force if order is None else self._response
        if reference is None:
            return _Reference(unit, text, 0)
        times = (order or 0) - reference.order if order is not None else 0
        if times < 0:  # of a record that was not read, which is a problem of its own
            return _Reference(unit, text, order or 0)
        dimension = reference.unit.dimension * _PER_SECOND**times
        return _Reference(Unit(reference.unit.factor, dimension), reference.text + _PER[times], order or 0)

    def force_gain(self, quantity: Quantity, source: str) -> Quantity:
        """The force gain in the kept units, response/s^2 per force; `own` says that it is in them."""
        if quantity.unit == "own" or self._response is None or self._force is None:
            return quantity
        key = "parameters.force_gain"
        unit = parse_unit(quantity.unit, key, source)
        per = 2 - self._response.order
        wanted = self._response.unit.dimension * _PER_SECOND**per * self._force.unit.dimension**-1
        text = _gain_text(self._response.text, _PER[per], self._force.text)
        if unit.dimension != wanted:
            rule = f"the unit '{quantity.unit}' is not one of the kind of '{text}'"
            raise InputError(Problem(key, rule, quantity.value, f"give it in '{text}'", source))
        factor = unit.factor / self._response.unit.factor * self._force.unit.factor
        return Quantity(quantity.value * factor, text, quantity.uncertainty)


def _gain_text(response: str, per: str, force: str) -> str:
    """The unit of a gain as people write it: rad/s^2/V, and not rad/s/s/(V)."""
    above = f"{response}^2" if response.endswith("/s") and per == "/s" else response + per
    if force == "1":
        return above
    return f"{above}/{force}" if force.isalpha() else f"{above}/({force})"


def _around(unit: Unit, radius: float | None, kept: str, key: str, text: str, source: str) -> Conversion:
    """Of a velocity along the circumference, to the speed of the shaft."""
    if radius is None:
        rule = f"'{text}' is a velocity along the circumference, which is a speed of the shaft at a known radius only"
        remedy = "add where it is measured, radius: {value: 30, unit: mm}, or give it in 'rad/s'"
        raise InputError(Problem(key, rule, text, remedy, source))
    if unit.dimension != _VELOCITY.dimension:
        rule = f"'{text}' is no velocity along the circumference, which alone a radius has a meaning for"
        raise InputError(Problem(key, rule, text, "leave out radius, or give the unit of the velocity, mm/s", source))
    return Conversion(unit.factor / radius, kept)


def written(quantity: Quantity) -> str:
    """A quantity as people write it."""
    return f"{quantity.value:g} {quantity.unit}"
