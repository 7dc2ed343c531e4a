"""What the declaration of an effect says, as Markdown."""

from math import isfinite

from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.systems.known import systems_of
from gear_damping.physics.terms import (
    BearingForce,
    Contact,
    ContactChange,
    DampingForce,
    Effect,
    ElasticForce,
    ExtraStates,
    HeldLoad,
    Load,
    LoadFactor,
    LoadPath,
    MeshForceFactor,
    MeshStiffness,
    Sensor,
    StiffnessFactor,
    SystemChange,
    TransmissionErrorSource,
)
from gear_damping.reporting.numbers import NOTHING, number, pretty_unit, quantity

ACTS_ON = {
    MeshStiffness: "the mesh stiffness",
    StiffnessFactor: "the stiffness, as a factor",
    TransmissionErrorSource: "the transmission error that the flanks impose",
    Contact: "the contact of the flanks",
    ElasticForce: "the elastic force",
    DampingForce: "the damping force",
    MeshForceFactor: "the whole mesh force, as a factor",
    Load: "the load",
    LoadFactor: "the load, as a factor",
    LoadPath: "the path from the torques to the mesh",
    HeldLoad: "the load, drawn at random",
    BearingForce: "the bearing",
    ExtraStates: "states of its own",
    SystemChange: "the derived quantities of the system",
    ContactChange: "the zone of double contact",
    Sensor: "the record",
}
MOST_CHOICES = 8  # that are listed in a row of the page
MOST_VALUES = 6  # likewise of a list of defaults
PARAMETER_HEAD = ("| parameter | meaning | unit | default | bounds |", "|---|---|---|---|---|")
OPTION_HEAD = ("| option | meaning | choices | default |", "|---|---|---|---|")


def declaration(kind: type[Effect]) -> list[str]:
    """The lines of an effect: what it is, its equation, source, options and parameters."""
    lines = [_sentence(kind.__doc__ or ""), "", f"`{kind.equation}`", ""]
    lines += [f"- acts on: {acts_on(kind)}"]
    lines += [f"- systems: {', '.join(f'`{name}`' for name in systems_of(kind))}"]
    lines += [f"- dissipates energy: {'yes' if kind.dissipative else 'no'}"]
    lines += [f"- needs: {', '.join(f'`{name}`' for name in kind.requires)}"] if kind.requires else []
    lines += [f"- source: {kind.reference}", ""]
    lines += [*PARAMETER_HEAD, *map(parameter_row, kind.parameters), ""]
    if kind.options:
        lines += [*OPTION_HEAD, *map(option_row, kind.options), ""]
    return lines


def acts_on(kind: type[Effect]) -> str:
    """The slots of the equation of motion that an effect fills, in words."""
    words = [said for slot, said in ACTS_ON.items() if issubclass(kind, slot)]
    channel = getattr(kind, "channel", None)
    return "; ".join(words) + (f" of `{channel}`" if channel else "")


def parameter_row(parameter: Parameter) -> str:
    """The row of a parameter: key, meaning, unit, default and bounds."""
    unit = pretty_unit(parameter.unit) or "1"
    cells = (f"`{parameter.name}`", parameter.meaning, unit, _default(parameter), _bounds(parameter))
    return _row(cells)


def option_row(option: Option) -> str:
    """The row of an option: key, meaning, choices and default."""
    choices = [str(choice).lower() if isinstance(choice, bool) else str(choice) for choice in option.choices]
    said = ", ".join(choices) if len(choices) <= MOST_CHOICES else f"{choices[0]} … {choices[-1]}"
    default = str(option.default).lower() if isinstance(option.default, bool) else str(option.default)
    return _row((f"`{option.name}`", option.meaning, said, default))


def _default(parameter: Parameter) -> str:
    if parameter.default is None:
        return "must be given"
    if not isinstance(parameter.default, tuple):
        return quantity(parameter.default, parameter.unit)
    shown = ", ".join(quantity(value, parameter.unit) for value in parameter.default[:MOST_VALUES])
    more = len(parameter.default) - MOST_VALUES
    return f"{shown}, … ({len(parameter.default)} values)" if more > 0 else shown


def _bounds(parameter: Parameter) -> str:
    low, high = parameter.lower, parameter.upper
    if not isfinite(low) and not isfinite(high):
        return NOTHING
    return f"{number(low)} … {number(high)}".replace("inf", "∞").replace("-", "−")


def _row(cells: tuple[str, ...]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _sentence(text: str) -> str:
    """A docstring with each paragraph on one line."""
    paragraphs = [" ".join(part.split()) for part in text.strip().split("\n\n")]
    return "\n\n".join(paragraphs)
