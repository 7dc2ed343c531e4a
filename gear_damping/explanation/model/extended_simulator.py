"""The extended model as a file that every experiment takes as simulator.extended=PATH."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.units import is_of_kind

UNIT = "unit"  # the option of a rig that says what it is measured in
NOT_OF_THE_RIG = ("initial_displacement", "initial_velocity")
HEADER = (
    "# The simulator that task=explain ended with; values are SI, or of a `unit` per unit of mass.\n"
    "# Use it by simulator.extended=PATH: its effects and values take the place of the chosen simulator's.\n"
)


def extended_node(outcome: Outcome, length: str = "m") -> dict[str, Any]:
    """The `simulator` node of a model: system, options, parameters, and every effect with its parameters.

    Args:
        outcome: The fitted model.
        length: The unit that the displacement was fitted in.
    """
    hypothesis = outcome.hypothesis
    node: dict[str, Any] = {"system": hypothesis.system.name, **hypothesis.system.chosen}
    node |= {UNIT: _known(length)} if UNIT in node else {}
    effects: dict[str, dict[str, Any]] = {effect.name: dict(effect.chosen) for effect in hypothesis.effects}
    for name, value in outcome.flat_given().items():
        effect, _, own = name.partition(".")
        plain = [float(v) for v in value] if isinstance(value, tuple) else float(value)
        if own:
            effects[effect][own] = plain
        elif name not in NOT_OF_THE_RIG:
            node[name] = plain
    return node | effects


def _known(length: str) -> str | None:
    """A unit, or None for one that a file cannot say."""
    return length if is_of_kind(length, length) else None


def write_extended(path: Path, outcome: Outcome, notes: Mapping[str, Any], length: str = "m") -> Path:
    """Write the node with its header.

    Args:
        path: Of the file; an existing one is not overwritten.
        outcome: The fitted model.
        notes: Lines for the header: name and value.
        length: The unit that the displacement was fitted in.
    """
    lines = "".join(f"# {name}: {value}\n" for name, value in notes.items())
    with path.open("x", encoding="utf-8") as file:
        file.write(HEADER + lines + yaml.safe_dump(extended_node(outcome, length), sort_keys=False))
    return path
