"""Units of a rig's parameters: SI where its mass is known, else per unit of mass, with the response's own unit."""

from gear_damping.errors import InputError
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.measurement.record import Channel
from gear_damping.physics.model import Model
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Sensor
from gear_damping.units import Dimension, parse_unit

CYCLES = "Hz"  # and not 1/s, which would be read as rad/s
DERIVATIVES = {"velocity": 1, "acceleration": 2}  # in time, of a displacement


def rig_unit(declared: str, evidence: Evidence, recorded: bool = False) -> str:
    """The unit of a parameter that is declared in `declared` (SI).

    Args:
        declared: The unit that the effect declares.
        evidence: The records.
        recorded: Whether it is of a sensor, which acts on what was recorded: a length is one of that then.
    """
    if declared == CYCLES or (evidence.has(Trait.MASS) and not recorded):
        return declared
    dimension = parse_unit(declared).dimension
    length, seconds = (evidence.channel.unit, 0) if recorded else _length(evidence.channel)
    powers = dict.fromkeys((length, "rad", "s"), 0.0)
    for name, power in ((length, dimension.length), ("rad", dimension.angle), ("s", dimension.time)):
        powers[name] += power
    powers["s"] += seconds * dimension.length
    above = [_power(name, power) for name, power in powers.items() if power > 0]
    below = [_power(name, -power) for name, power in powers.items() if power < 0]
    return "/".join(["*".join(above) or "1", *below])


def unit_of(flat: str, model: Model, evidence: Evidence) -> str:
    """The unit of a parameter of a model by its flat name."""
    effect = next((e for e in model.effects if e.name == flat.partition(".")[0]), None)
    recorded = isinstance(effect, Sensor) and effect.channel in (None, model.system.response)
    return rig_unit(model.parameters()[flat].unit, evidence, recorded)


def length_unit(channel: Channel) -> str:
    """The unit of the displacement, from that of whatever response was recorded."""
    length, seconds = _length(channel)
    return f"{length}*{_power('s', seconds)}" if seconds else length


def radian_of(evidence: Evidence) -> float | None:
    """One radian in the unit behind a response: of an angle, its rate or acceleration; None of any other."""
    try:
        found = parse_unit(length_unit(evidence.channel)) if evidence.channel else None
    except InputError:
        return None
    rates = [Dimension(angle=1, time=-derivatives) for derivatives in range(3)]
    return 1 / found.factor if found and found.dimension in rates else None


def _length(channel: Channel) -> tuple[str, int]:
    """A unit, and a power of seconds beside it."""
    order = DERIVATIVES.get(channel.name, 0)
    over = {1: "/s", 2: "/s^2"}.get(order, "")
    return (channel.unit.removesuffix(over), 0) if over and channel.unit.endswith(over) else (channel.unit, order)


def _power(name: str, power: float) -> str:
    name = name if power == 1 or not {"/", "*", "^"} & {*name} else f"({name})"
    return name if power == 1 else f"{name}^{power:g}"
