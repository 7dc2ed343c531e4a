"""What the axis of a swept key says: its words and its unit, from the declaration of the effect."""

from gear_damping.physics.catalogue import builtin_effects
from gear_damping.physics.parameter import Parameter
from gear_damping.reporting.numbers import pretty_unit

WORDS = {"snr": "signal-to-noise ratio"}
SUFFIXES = {
    "rpm": "rpm",
    "deg": "°",
    "um": "µm",
    "mm": "mm",
    "ms": "ms",
    "khz": "kHz",
    "hz": "Hz",
    "percent": "%",
    "db": "dB",
}


def axis(quantity: str, unit: str) -> str:
    """The label of an axis: the quantity over its unit, as numbers on it are; a pure number has none."""
    if unit in ("", "1"):
        return quantity
    return f"{quantity} / ({unit})" if "/" in unit else f"{quantity} / {unit}"


def swept_axis(key: str) -> str:
    """The label of an axis over a configuration key: words, unit, and the key itself in the second line.

    Args:
        key: For example `simulator.load_noise.snr_db` or `simulator.backlash.gap_um`.
    """
    parts = key.removeprefix("simulator.").split(".")
    name, unit = _unit(parts)
    words = ", ".join(_words(part) for part in (*parts[:-1], name))
    return f"{words}{f' / {unit}' if unit else ''}\n{key}"


def _unit(parts: list[str]) -> tuple[str, str]:
    """The parameter's name without its unit, and the unit."""
    declared = _declared(parts)
    stem, _, suffix = parts[-1].rpartition("_")
    if declared is not None and suffix not in SUFFIXES:
        return parts[-1], pretty_unit(declared.unit)
    return (stem, SUFFIXES[suffix]) if stem and suffix in SUFFIXES else (parts[-1], "")


def _declared(parts: list[str]) -> Parameter | None:
    effect = builtin_effects().get(parts[0]) if len(parts) > 1 else None
    return next((p for p in effect.parameters if p.name == parts[-1]), None) if effect else None


def _words(part: str) -> str:
    return " ".join(WORDS.get(word, word) for word in part.split("_"))
