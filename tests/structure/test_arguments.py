"""No function of the package takes more arguments than a reader can hold."""

import ast
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "gear_damping"
MOST = 6  # what belongs together travels as one thing


def too_many(source):
    """(name, arguments) of functions that take more than that; `self`, `cls` and what stars collect do not count."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            given = node.args
            names = [one.arg for one in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
            count = len([name for name in names if name not in ("self", "cls")])
            if count > MOST:
                yield node.name, count


def test_no_function_takes_more_than_six():
    found = {
        f"{path.relative_to(PACKAGE)}: {name}": count
        for path in sorted(PACKAGE.rglob("*.py"))
        for name, count in too_many(path.read_text(encoding="utf-8"))
    }
    assert found == {}


def test_the_count_would_see_one():
    assert list(too_many("def far(self, a, b, c, d, *, e, f, g=1, **rest): ...")) == [("far", 7)]
