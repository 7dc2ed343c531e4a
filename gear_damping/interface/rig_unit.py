"""The unit of a rig without a known mass: a model's own, and that of the records, which its values are put in."""

from collections.abc import Mapping

from gear_damping.errors import InputError, Problem
from gear_damping.explanation.evidence.declared_units import DERIVATIVES, length_unit
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.extended_simulator import NOT_OF_THE_RIG, UNIT
from gear_damping.interface.model import Model
from gear_damping.measurement.record import Channel
from gear_damping.physics import model as physics
from gear_damping.units import Dimension, Unit, is_of_kind, parse_unit

Values = Mapping[str, float | tuple[float, ...]]
GRAVITIES = ("gn", "mgn")  # what stands for a `g` in a product, where that would be read as a mass
LAW, EXPONENT = "power_law_damping.coefficient", "power_law_damping.exponent"  # the one unit that an exponent decides


def in_the_unit_of(evidence: Evidence, model: physics.Model, values: Values) -> Model:
    """A fitted model, whose values are in the unit of the records, that says so.

    Args:
        evidence: The records.
        model: What was fitted to them.
        values: What came out, by flat name.
    """
    return Model.holding(model, values, _option(model, evidence.channel))


def converted(model: Model, evidence: Evidence) -> tuple[Model, Values]:
    """A model that was made in a unit of its own, in that of the records; one of unknown unit is taken to be in that.

    Returns:
        The model, and those defaults of its effects in the unit of the records that depend on it.

    Raises:
        InputError: the two units are of different kinds, and some of its values depend on them.
    """
    option = _option(model, evidence.channel)
    mine = model.system.chosen.get(UNIT)
    if not option or mine is None:
        return Model.holding(model, model.given, option), {}
    powers, given = _powers(model), model.given
    defaults = {name: one.default for name, one in model.parameters().items() if "." in name and name not in given}
    own, theirs = parse_unit(mine), _length(evidence.channel)
    if own.dimension == theirs.dimension:
        factor = own.factor / theirs.factor
        moved = {name: _times(value, factor ** powers.get(name, 0)) for name, value in given.items()}
        held = {name: _times(value, factor ** powers[name]) for name, value in defaults.items() if name in powers}
        return Model.holding(model, moved, option), held if factor != 1 else {}
    wrong = [name for name, value in given.items() if name in powers and value and name not in NOT_OF_THE_RIG]
    if wrong:
        there = option[UNIT] or length_unit(evidence.channel)
        rule = f"is in the unit of the model, '{mine}', and the records are in '{there}', of another kind"
        remedy = f"make the model with {type(model.system).__name__}(unit='{there}', …) and give its values in that"
        raise InputError([Problem(name, rule, given[name], remedy) for name in wrong])
    return Model.holding(model, given, option), {}


def _powers(model: Model) -> dict[str, float]:
    """The power of its length in the unit of every parameter in whose unit there is one; masses are 1."""
    found = {name: one.dimension.length for name, one in model.parameters().items()}
    if LAW in found:
        exponent = model.given.get(EXPONENT, model.parameters()[EXPONENT].default)
        found[LAW] = 1 - exponent
    return {name: power for name, power in found.items() if power}


def _times(value: float | tuple[float, ...], factor: float) -> float | tuple[float, ...]:
    return tuple(one * factor for one in value) if isinstance(value, tuple) else value * factor


def _option(model: physics.Model, channel: Channel | None) -> dict[str, str | None]:
    """The option of a system that says what it is measured in; empty of one that has none."""
    if UNIT not in model.system.chosen or channel is None:
        return {}
    name = next((name for name in GRAVITIES if parse_unit(name) == parse_unit(channel.unit)), channel.unit)
    order = DERIVATIVES.get(channel.name, 0)
    plain = length_unit(channel) if name == channel.unit else f"{name}*s^{order}" if order else name
    return {UNIT: plain if is_of_kind(plain, plain) else None}


def _length(channel: Channel) -> Unit:
    """The unit of the displacement behind a response."""
    unit, seconds = parse_unit(channel.unit), Dimension(time=1)  # exponent of one integration in time
    return Unit(unit.factor, unit.dimension * seconds ** DERIVATIVES.get(channel.name, 0))
