"""Scalar expressions of one member: what a traced tensor program becomes before it is written as C++.

An expression is a number or a numbered value. Equal expressions are one value, numbers are folded,
and every value knows how often it changes: per run (it depends on parameters alone) or per stage.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

Kind = Literal["number", "mask"]


@dataclass(frozen=True)
class Value:
    """A numbered value: a member's number or truth."""

    index: int
    kind: Kind
    varies: bool  # within a run


Expression = Value | float
TEMPLATES = {
    "add": "({0} + {1})", "sub": "({0} - {1})", "mul": "({0} * {1})", "div": "({0} / {1})", "neg": "(-{0})",
    "abs": "v_abs({0})", "sqrt": "v_sqrt({0})", "sign": "v_sign({0})", "floor": "v_floor({0})",
    "cos": "v_cos({0})", "sin": "v_sin({0})", "tanh": "v_tanh({0})", "exp": "v_exp({0})", "log": "v_log({0})",
    "atan": "v_atan({0})", "pow": "v_pow({0}, {1})", "maximum": "v_max({0}, {1})", "minimum": "v_min({0}, {1})",
    "gt": "({0} > {1})", "ge": "({0} >= {1})", "lt": "({0} < {1})", "le": "({0} <= {1})",
    "eq": "({0} == {1})", "ne": "({0} != {1})", "and": "({0} & {1})", "or": "({0} | {1})", "not": "(~{0})",
    "where": "({0} ? {1} : {2})", "number": "({0} ? 1.0 : 0.0)",
}  # fmt: skip
MASKS = {"gt", "ge", "lt", "le", "eq", "ne", "and", "or", "not"}
FOLDED = {
    "add": lambda a, b: a + b, "sub": lambda a, b: a - b, "mul": lambda a, b: a * b, "div": lambda a, b: a / b,
    "neg": lambda a: -a, "abs": abs, "sqrt": math.sqrt, "cos": math.cos, "sin": math.sin, "tanh": math.tanh,
    "exp": math.exp, "log": math.log, "atan": math.atan, "pow": math.pow, "maximum": max, "minimum": min,
    "sign": lambda a: float((a > 0) - (a < 0)), "floor": math.floor,
}  # fmt: skip
LARGEST_UNROLLED_POWER = 8  # products that are faster than pow()


@dataclass
class Program:
    """The values of one function in the order in which they are worked out."""

    made: dict[Value, tuple[str, tuple[Expression, ...]]] = field(default_factory=dict)
    inputs: dict[Value, str] = field(default_factory=dict)
    known: dict[tuple, Value] = field(default_factory=dict)
    _count: int = 0

    def input(self, text: str, varies: bool) -> Value:
        """A value that comes from outside; `text` is how C++ reads it."""
        value = self._new("number", varies)
        self.inputs[value] = text
        return value

    def apply(self, name: str, *arguments: Expression) -> Expression:
        """The value of an operation, found again where it was worked out before."""
        numbers = all(not isinstance(a, Value) for a in arguments)
        if numbers and name in FOLDED:
            return float(FOLDED[name](*arguments))
        simple = _simplified(self, name, arguments)
        if simple is not None:
            return simple
        key = (name, *arguments)
        if key not in self.known:
            varies = any(a.varies for a in arguments if isinstance(a, Value))
            kind = "mask" if name in MASKS else "number"
            self.known[key] = self._new(kind, varies)
            self.made[self.known[key]] = (name, arguments)
        return self.known[key]

    def _new(self, kind: Kind, varies: bool) -> Value:
        self._count += 1
        return Value(self._count, kind, varies)


def _simplified(program: Program, name: str, a: tuple[Expression, ...]) -> Expression | None:
    """What needs no operation, or a cheaper one; None where the operation stands."""
    if name == "add" and 0.0 in a:
        return a[1] if a[0] == 0.0 else a[0]
    if name == "sub" and a[1] == 0.0:
        return a[0]
    if name == "sub" and a[0] == 0.0:
        return program.apply("neg", a[1])
    if name == "where" and a[1] == a[2]:
        return a[1]
    if name == "div" and a[0] == 0.0:
        return 0.0
    if name in ("mul", "div") and a[1] == 1.0:
        return a[0]
    if name == "mul" and a[0] == 1.0:
        return a[1]
    if name == "mul" and 0.0 in a:
        return 0.0
    if name == "div" and isinstance(a[1], Value) and not a[1].varies and isinstance(a[0], Value) and a[0].varies:
        return program.apply("mul", a[0], program.apply("div", 1.0, a[1]))
    if name == "pow" and isinstance(a[1], float):
        return _power(program, a[0], a[1])
    return None


def _power(program: Program, base: Expression, exponent: float) -> Expression | None:
    if exponent == 0.5:
        return program.apply("sqrt", base)
    if exponent != int(exponent) or not 0 <= exponent <= LARGEST_UNROLLED_POWER:
        return None
    result: Expression = 1.0
    for _ in range(int(exponent)):
        result = program.apply("mul", result, base)
    return result
