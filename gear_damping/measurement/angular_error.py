"""A transmission error that is an angle of one of its shafts, as gear testers write it: its length along the line."""

from collections.abc import Mapping
from dataclasses import replace
from math import cos, pi
from typing import TYPE_CHECKING

from gear_damping.measurement.record import Quantity
from gear_damping.units import Unit, is_of_kind, parse_unit

if TYPE_CHECKING:
    from gear_damping.measurement.declaration import ChannelPlan

GEOMETRY = {"pinion": "n_teeth_pinion", "gear": "n_teeth_gear"}  # the teeth that make a shaft's base radius
NEEDED = ("module", "pressure_angle")  # beside them
LENGTH = "um"  # that the channel is then told in


def base_radius(n_teeth: float, module: float, pressure_angle: float) -> float:
    """m: half of n_teeth * module * cos(pressure_angle)."""
    return n_teeth * module * cos(pressure_angle) / 2


def is_angle(unit: str | None) -> bool:
    """Whether a unit is one of an angle."""
    return is_of_kind(unit, "rad")


def is_angular_acceleration(unit: str | None) -> bool:
    """Whether a unit is one of an angular acceleration."""
    return is_of_kind(unit, "rad/s^2")


def turn_in(unit: str | None) -> float | None:
    """One turn in a unit of angle; None for any other unit."""
    return 2 * pi / parse_unit(unit).factor if unit and is_angle(unit) else None


def is_angle_of_a_shaft(plan: "ChannelPlan") -> bool:
    """Whether a channel is a transmission error that was declared as the angle of one of its shafts."""
    return plan.name == "transmission_error" and "shaft" in plan.sensor


def along_the_line(plan: "ChannelPlan", parameters: Mapping[str, Quantity]) -> "ChannelPlan":
    """The channel as a length: the angle times the base radius of its shaft.

    Args:
        plan: A transmission error that is an angle of a shaft.
        parameters: Of the file, in SI. A file that lacks some of the geometry is refused elsewhere.
    """
    sensor = dict(plan.sensor)
    known = [parameters.get(name) for name in (GEOMETRY[sensor.pop("shaft")], *NEEDED)]
    radius = base_radius(*(one.value for one in known)) if all(known) else 1.0
    angle = parse_unit(plan.unit)
    lever = parse_unit(LENGTH).factor / (radius * angle.factor)  # the declared unit in one micrometre
    sensor["gain"] *= lever
    limits = {name: _length(quantity, radius, angle) for name, quantity in plan.limits.items()}
    return replace(plan, unit=LENGTH, sensor=sensor, limits=limits, stated_unit=plan.unit, lever=lever)


def _length(quantity: Quantity, radius: float, angle: Unit) -> Quantity:
    """A limit in any unit of an angle, or one that is a length already."""
    own = parse_unit(quantity.unit)
    if own.dimension != angle.dimension:
        return quantity
    return Quantity(quantity.value * own.factor * radius / parse_unit(LENGTH).factor, LENGTH, quantity.uncertainty)
