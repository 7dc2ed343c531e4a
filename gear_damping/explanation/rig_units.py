"""Units of a rig's parameters: SI of a gear pair; of an oscillator per unit of mass, with the response's own unit."""

from gear_damping.explanation.evidence import Evidence
from gear_damping.measurement.record import Channel
from gear_damping.units import parse_unit

DERIVATIVES = {"velocity": 1, "acceleration": 2}


def rig_unit(declared: str, evidence: Evidence) -> str:
    """The unit of a parameter that is declared in `declared` (SI)."""
    if evidence.system == "gear_pair":
        return declared
    dimension = parse_unit(declared).dimension
    length = length_unit(evidence.channel)
    powers = {"rad": dimension.angle, "s": dimension.time}
    powers = {length: dimension.length + powers.pop(length, 0)} | powers
    above = [_power(name, power) for name, power in powers.items() if power > 0]
    below = [_power(name, -power) for name, power in powers.items() if power < 0]
    return "/".join(["*".join(above) or "1", *below])


def length_unit(channel: Channel) -> str:
    """The unit of an oscillator's displacement, from that of whatever response was recorded."""
    order = DERIVATIVES.get(channel.name, 0)
    over = {1: "/s", 2: "/s^2"}.get(order, "")
    if not over or channel.unit.endswith(over):
        return channel.unit.removesuffix(over)
    return f"{channel.unit}*s" + ("^2" if order == 2 else "")


def _power(name: str, power: float) -> str:
    return name if power == 1 else f"{name}^{power:g}"
