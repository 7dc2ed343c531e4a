"""Units of a rig's parameters: SI of a gear pair; of an oscillator per unit of mass, with the response's own unit."""

from gear_damping.explanation.evidence import Evidence
from gear_damping.units import parse_unit


def rig_unit(declared: str, evidence: Evidence) -> str:
    """The unit of a parameter that is declared in `declared` (SI)."""
    if evidence.system == "gear_pair":
        return declared
    dimension = parse_unit(declared).dimension
    length = evidence.channel.unit
    powers = {"rad": dimension.angle, "s": dimension.time}
    powers = {length: dimension.length + powers.pop(length, 0)} | powers
    above = [_power(name, power) for name, power in powers.items() if power > 0]
    below = [_power(name, -power) for name, power in powers.items() if power < 0]
    return "/".join(["*".join(above) or "1", *below])


def _power(name: str, power: float) -> str:
    return name if power == 1 else f"{name}^{power:g}"
