"""The extended model as a file that every experiment takes as simulator.extended=PATH."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from gear_damping.explanation.model.hypothesis import Outcome

NOT_OF_THE_RIG = ("initial_displacement", "initial_velocity")
HEADER = (
    "# The simulator that task=explain ended with; every value is SI, or in the oscillator's own units.\n"
    "# Use it by simulator.extended=PATH: its effects and values take the place of the chosen simulator's.\n"
)


def extended_node(outcome: Outcome) -> dict[str, Any]:
    """The `simulator` node of a model: system, options, parameters, and every effect with its parameters."""
    hypothesis = outcome.hypothesis
    node: dict[str, Any] = {"system": hypothesis.system.name, **hypothesis.system.chosen}
    effects: dict[str, dict[str, Any]] = {effect.name: dict(effect.chosen) for effect in hypothesis.effects}
    for name, value in outcome.flat_given().items():
        effect, _, own = name.partition(".")
        plain = [float(v) for v in value] if isinstance(value, tuple) else float(value)
        if own:
            effects[effect][own] = plain
        elif name not in NOT_OF_THE_RIG:
            node[name] = plain
    return node | effects


def write_extended(path: Path, outcome: Outcome, notes: Mapping[str, Any]) -> Path:
    """Write the node with its header.

    Args:
        path: Of the file; an existing one is not overwritten.
        outcome: The fitted model.
        notes: Lines for the header: name and value.
    """
    lines = "".join(f"# {name}: {value}\n" for name, value in notes.items())
    with path.open("x", encoding="utf-8") as file:
        file.write(HEADER + lines + yaml.safe_dump(extended_node(outcome), sort_keys=False))
    return path
