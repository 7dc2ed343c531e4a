"""Units of a rig's parameters: SI of a gear pair; of an oscillator per unit of mass, with the response's own unit."""

from gear_damping.explanation.evidence import Evidence
from gear_damping.units import Dimension, parse_unit

_SI = {"m": Dimension(length=1), "rad": Dimension(angle=1), "V": Dimension(voltage=1), "kg": Dimension(mass=1)}


def rig_unit(declared: str, evidence: Evidence) -> str:
    """The unit of a parameter that is declared in `declared` (SI)."""
    if evidence.system == "gear_pair":
        return declared
    dimension = parse_unit(declared).dimension
    length = evidence.channel.declared_unit
    if evidence.channel.declared_factor != 1:
        response = parse_unit(length).dimension
        length = next((name for name, own in _SI.items() if own == response), length)
    powers = {"rad": dimension.angle, "s": dimension.time}
    powers = {length: dimension.length + powers.pop(length, 0)} | powers
    above = [_power(name, power) for name, power in powers.items() if power > 0]
    below = [_power(name, -power) for name, power in powers.items() if power < 0]
    return "/".join(["*".join(above) or "1", *below])


def _power(name: str, power: float) -> str:
    return name if power == 1 else f"{name}^{power:g}"
