"""No number of a module stands without a word on its unit and its reason, beside it or above it.

Read are numbers, tuples, lists and mappings of them, what is worked out of numbers, and calls that are given numbers
and no text that says what they are (`Parameter("gap", "m", …)` says it), at the top of a module and as plain
attributes of a class. Fields of a dataclass are said in its docstring.
"""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FILES = sorted((ROOT / "gear_damping").rglob("*.py"))
FEWEST_WORDS = 4  # of a comment that holds a unit and a reason
LAID_OUT = "reporting"  # sizes on a page have no other reason than how it looks: their unit is enough
FOR_TOOLS = re.compile(r"#\s*(fmt: skip|noqa|type: ignore).*")
WORD = re.compile(r"[^\W\d_]{2,}")


def is_number(node):
    """Whether an expression is a number, or holds some and nothing that says what they are."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float) and not isinstance(node.value, bool)
    if isinstance(node, ast.UnaryOp):
        return is_number(node.operand)
    if isinstance(node, ast.BinOp):
        return is_number(node.left) or is_number(node.right)
    if isinstance(node, ast.Dict):  # of numbers alone: among others the keys say what they are
        plain = not any(has_text(value) or isinstance(value, ast.Call) for value in node.values)
        return plain and bool(node.values) and all(map(is_number, node.values))
    if isinstance(node, ast.Call):
        given = [*node.args, *(one.value for one in node.keywords)]
        return any(map(is_number, given)) and not has_text(node)
    return isinstance(node, ast.Tuple | ast.List | ast.Set) and any(map(is_number, node.elts))


def has_text(node):
    return any(isinstance(one, ast.Constant) and isinstance(one.value, str) for one in ast.walk(node))


def assigned(tree):
    """Values that are given names: in the module, and in its classes without a type or as ClassVar."""
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            yield node
        if isinstance(node, ast.ClassDef):
            for inner in node.body:
                shared = isinstance(inner, ast.AnnAssign) and "ClassVar" in ast.unparse(inner.annotation)
                if isinstance(inner, ast.Assign) or (shared and inner.value is not None):
                    yield inner


def unsaid(text, fewest=FEWEST_WORDS):
    """Lines of a module that give a number without enough words on it."""
    lines = [FOR_TOOLS.sub("", line) for line in text.splitlines()]
    found = []
    for node in assigned(ast.parse(text)):
        if not is_number(node.value):
            continue
        first = node.lineno - 1
        while first and lines[first - 1].lstrip().startswith("#"):
            first -= 1
        words = " ".join(line.partition("#")[2] for line in lines[first : node.end_lineno])
        if len(WORD.findall(words)) < fewest or not words.strip():
            found.append(f"{node.lineno}: {lines[node.lineno - 1].strip()}")
    return found


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("A = 3", 1), ("A = 3  # m", 1), ("A = 3  # fmt: skip", 1), ("A = 3  # fmt: skip, since it is so", 1),
        ("A = 3  # m, so that it fits a bench", 0), ("# m: as far as\n# anybody walks\nA = 3", 0),
        ("A, B = 1, 2 * 3", 1), ("A = -1e3", 1), ("A: int = 3", 1), ("A = True", 0), ("A = 'x'", 0), ("A = f(3)", 1),
        ("A = f('gap', 'm', 3)", 0), ("A = f(x)", 0), ("A = f({'gap': 3})", 0),
        ("A = {'x': 1, 'y': (2, 3)}", 1), ("A = {'x': 1, 'y': 'm'}", 0),
        ("def f():\n    a = 3", 0), ("class A:\n    b = 3", 1), ("class A:\n    b: ClassVar[int] = 3", 1),
        ("class A:\n    b: int = 3", 0), ("A = (\n    (1.0,),\n)", 1),
    ],
)  # fmt: skip
def test_a_number_without_a_word_is_seen(text, count):
    assert len(unsaid(text)) == count


def test_every_number_of_the_package_has_one():
    found = [
        f"{path.relative_to(ROOT)}:{line}"
        for path in FILES
        for line in unsaid(path.read_text(), 0 if LAID_OUT in path.parts else FEWEST_WORDS)
    ]
    assert len(FILES) > 200
    assert not found, "say unit and reason behind each, or move it into settings:\n" + "\n".join(found)
