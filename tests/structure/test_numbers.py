"""No number of a module stands without a word on its unit and its reason, beside it or above it."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FILES = sorted((ROOT / "gear_damping").rglob("*.py"))


def is_number(node):
    """Whether an expression is a number or holds some: in a tuple, or worked out from others."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float) and not isinstance(node.value, bool)
    if isinstance(node, ast.UnaryOp):
        return is_number(node.operand)
    if isinstance(node, ast.BinOp):
        return is_number(node.left) or is_number(node.right)
    return isinstance(node, ast.Tuple | ast.List) and any(map(is_number, node.elts))


def unsaid(text):
    """Lines of a module that give a number without a word on it."""
    lines = text.splitlines()
    found = []
    for node in ast.parse(text).body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None or not is_number(node.value):
            continue
        own, above = lines[node.lineno - 1 : node.end_lineno], lines[max(node.lineno - 2, 0)]
        if not any("#" in line for line in own) and not above.lstrip().startswith("#"):
            found.append(f"{node.lineno}: {own[0]}")
    return found


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("A = 3", 1), ("A = 3  # m", 0), ("# in m\nA = 3", 0), ("A, B = 1, 2 * 3", 1), ("A = -1e3", 1),
        ("A: int = 3", 1), ("A = True", 0), ("A = 'x'", 0), ("A = f(3)", 0), ("def f():\n    a = 3", 0),
        ("A = (\n    (1.0,),\n)", 1),
    ],
)  # fmt: skip
def test_a_number_without_a_word_is_seen(text, count):
    assert len(unsaid(text)) == count


def test_every_number_of_the_package_has_one():
    found = [f"{path.relative_to(ROOT)}:{line}" for path in FILES for line in unsaid(path.read_text())]
    assert len(FILES) > 200
    assert not found, "say unit and reason behind each, or move it into settings:\n" + "\n".join(found)
