"""No effect and no file of an explanation holds a system's name: what differs stands in the system's declaration."""

import ast
from pathlib import Path

import pytest

from gear_damping.physics.systems.known import SYSTEMS

PACKAGE = Path(__file__).resolve().parents[2] / "gear_damping"
# rooms that ask for traits; in the others a name may be a key of a file, or a word on a page
ROOMS = ("physics/effects", "explanation", "identification", "simulation", "config", "tasks", "interface")
FILES = sorted(path for room in ROOMS for path in (PACKAGE / room).rglob("*.py"))


def names_in(text):
    """Lines that hold a system's name as a text of its own; docstrings and sentences are none."""
    nodes = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Constant))
    return sorted({node.lineno for node in nodes if isinstance(node.value, str) and node.value in SYSTEMS})


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ('A = "gear_pair"', [1]), ('if x.system == "oscillator":\n    pass', [1]), ('A = {\n"gear_pair": 1}', [2]),
        ("match x:\n    case 'oscillator': pass", [2]), ('"""A gear_pair."""', []), ('A = "an oscillator swings"', []),
        ("oscillator = 1", []), ('A = f"{x}oscillator"', [1]),
    ],
)  # fmt: skip
def test_a_name_is_seen(text, lines):
    assert names_in(text) == lines


def test_none_stands_where_traits_are_asked_for():
    assert len(FILES) > 200
    found = [f"{path.relative_to(PACKAGE)}:{line}" for path in FILES for line in names_in(path.read_text())]
    assert not found, "ask for a trait (gear_damping/physics/systems/traits.py) instead:\n" + "\n".join(found)
