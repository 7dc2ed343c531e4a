"""Reads a tensor program into scalar expressions.

The program is run once for `TRACED_BATCH` members, whose axis is the last one, and watched operation by operation;
every tensor becomes an array of expressions with that axis cut to length one. (`make_fx` of PyTorch would give the
same operations, but it imports its compiler for that, which takes longer than everything else together.)
"""

from collections.abc import Callable, Sequence

import numpy as np
import torch
from torch import Tensor
from torch.utils._python_dispatch import TorchDispatchMode
from torch.utils._pytree import tree_map_only

from gear_damping.simulation.native.expressions import Expression, Program, Value

TRACED_BATCH = 13  # a length that no other axis has
BINARY = {
    "add": "add", "sub": "sub", "mul": "mul", "div": "div", "pow": "pow", "maximum": "maximum", "minimum": "minimum",
    "gt": "gt", "ge": "ge", "lt": "lt", "le": "le", "eq": "eq", "ne": "ne",
    "logical_and": "and", "bitwise_and": "and", "logical_or": "or", "bitwise_or": "or",
    "__and__": "and", "__or__": "or",
}  # fmt: skip
UNARY = {"neg", "abs", "sqrt", "cos", "sin", "tanh", "exp", "log", "atan", "sign", "floor"}
SAME = {"clone", "alias", "detach", "lift_fresh_copy", "contiguous", "_to_copy"}
Arrays = np.ndarray


class UntraceableError(NotImplementedError):
    """An operation that has no native form; the model then runs without native kernel."""


def trace(function: Callable, examples: Sequence[Tensor], inputs: Sequence[Arrays], program: Program) -> list[Arrays]:
    """The results of `function` as arrays of expressions.

    Args:
        function: Takes and returns tensors whose last axis has TRACED_BATCH members.
        examples: Tensors to trace with.
        inputs: Expressions that stand for them.
        program: Where the operations go.

    Raises:
        UntraceableError: the function uses an operation without native form.
    """
    watched = _Watched(program, examples, inputs)
    with torch.no_grad(), watched:
        found = function(*examples)
    return [watched.expressions(tensor) for tensor in (found if isinstance(found, (list, tuple)) else [found])]


class _Watched(TorchDispatchMode):
    """Applies to expressions what PyTorch does to tensors."""

    @classmethod
    def _should_skip_dynamo(cls) -> bool:
        return False  # nothing here is ever compiled; True would import PyTorch's compiler at the first operation

    def __init__(self, program: Program, examples: Sequence[Tensor], inputs: Sequence[Arrays]) -> None:
        super().__init__()
        self.program = program
        self.values: dict[int, Arrays | UntraceableError] = {}
        self.alive: list[Tensor] = []  # an id stands for one tensor while that lives
        for tensor, array in zip(examples, inputs, strict=True):
            self._note(tensor, array)

    def __torch_dispatch__(self, operation: Callable, types: object, args: tuple = (), kwargs: dict | None = None):
        result = operation(*args, **(kwargs or {}))
        try:
            arguments, options = tree_map_only(Tensor, self.expressions, (args, kwargs or {}))
            made = _apply(self.program, operation, result, arguments, options)
        except UntraceableError as problem:  # what nothing follows from may have no native form
            made = problem
        if isinstance(result, Tensor):
            self._note(result, made)
        elif isinstance(result, (list, tuple)):  # a number or a truth is no tensor that anything follows from
            for i, part in enumerate(result):
                self._note(part, made if isinstance(made, UntraceableError) else made[i])
        return result

    def expressions(self, tensor: Tensor) -> Arrays:
        """What stands for a tensor; a tensor that no operation made is a constant."""
        found = self.values.get(id(tensor))
        if isinstance(found, UntraceableError):
            raise found
        return _constant(tensor) if found is None else found

    def _note(self, tensor: Tensor, array: Arrays | UntraceableError) -> None:
        self.alive.append(tensor)
        self.values[id(tensor)] = array


def _constant(tensor: Tensor) -> Arrays:
    return tensor.detach().to(torch.float64).numpy().astype(object)


def _apply(program: Program, operation: Callable, made: Tensor, a: tuple, k: dict) -> Arrays | list[Arrays]:
    name = operation.__name__.split(".")[0]
    if name in SAME:
        return _converted(program, a[0], made)
    if name in BINARY and not k.get("alpha"):
        return _each(program, BINARY[name], *a)
    if name in UNARY:
        return _each(program, name, a[0])
    if name in _SPECIAL:
        return _SPECIAL[name](program, made, a, k)
    raise UntraceableError(f"the operation '{name}' has no native form")


def _each(program: Program, name: str, *arguments: object) -> Arrays:
    """Apply an operation to every element, with broadcasting."""
    arrays = np.broadcast_arrays(*(np.asarray(a, dtype=object) for a in arguments))
    result = np.empty(arrays[0].shape, dtype=object)
    for place in np.ndindex(result.shape):
        result[place] = program.apply(name, *(_number(array[place]) for array in arrays))
    return result


def _number(value: object) -> Expression:
    return value if isinstance(value, Value) else float(value)


def _converted(program: Program, array: Arrays, made: Tensor) -> Arrays:
    """A mask that becomes a number; anything else stays."""
    wants_number = made.dtype.is_floating_point
    flat = [v for v in np.ravel(array) if isinstance(v, Value)]
    if wants_number and any(v.kind == "mask" for v in flat):
        return _each(program, "number", array)
    return array


def _filled(number: float) -> Callable:
    def make(program: Program, made: Tensor, a: tuple, k: dict) -> Arrays:
        return np.full(_shape(made), number, dtype=object)

    return make


def _shape(made: Tensor) -> tuple[int, ...]:
    shape = tuple(made.shape)
    return (*shape[:-1], 1) if shape and shape[-1] == TRACED_BATCH else shape


def _sum(program: Program, made: Tensor, a: tuple, k: dict) -> Arrays:
    axes = a[1] if len(a) > 1 and a[1] is not None else list(range(a[0].ndim))
    return _reduced(program, "add", a[0], axes, made)


def _extreme(name: str) -> Callable:
    def reduce(program: Program, made: Tensor, a: tuple, k: dict) -> Arrays:
        axes = a[1] if isinstance(a[1], (list, tuple)) else [a[1]]
        return _reduced(program, name, a[0], axes, made)

    return reduce


def _reduced(program: Program, name: str, array: Arrays, axes: Sequence[int], made: Tensor) -> Arrays:
    for axis in axes:
        if axis % array.ndim == array.ndim - 1:
            raise UntraceableError("a sum over the members")
    for axis in sorted((axis % array.ndim for axis in axes), reverse=True):
        parts = [np.take(array, i, axis=axis) for i in range(array.shape[axis])]
        array = parts[0]
        for part in parts[1:]:
            array = _each(program, name, array, part)
    return np.reshape(array, _shape(made))


def _clamp(program: Program, made: Tensor, a: tuple, k: dict) -> Arrays:
    low = a[1] if len(a) > 1 else k.get("min")
    high = a[2] if len(a) > 2 else k.get("max")
    result = a[0]
    if low is not None:
        result = _each(program, "maximum", result, low)
    return result if high is None else _each(program, "minimum", result, high)


_SPECIAL: dict[str, Callable] = {
    "where": lambda p, n, a, k: _each(p, "where", *a),
    "logical_not": lambda p, n, a, k: _each(p, "not", a[0]),
    "bitwise_not": lambda p, n, a, k: _each(p, "not", a[0]),
    "rsub": lambda p, n, a, k: _each(p, "sub", a[1], a[0]),
    "reciprocal": lambda p, n, a, k: _each(p, "div", 1.0, a[0]),
    "sgn": lambda p, n, a, k: _each(p, "sign", a[0]),
    "tanh_backward": lambda p, n, a, k: _each(p, "mul", a[0], _each(p, "sub", 1.0, _each(p, "mul", a[1], a[1]))),
    "square": lambda p, n, a, k: _each(p, "mul", a[0], a[0]),
    "clamp": _clamp,
    "clamp_min": _clamp,
    "clamp_max": lambda p, n, a, k: _each(p, "minimum", a[0], a[1]),
    "sum": _sum,
    "amin": _extreme("minimum"),
    "amax": _extreme("maximum"),
    "select": lambda p, n, a, k: np.take(a[0], a[2], axis=a[1]),
    "slice": lambda p, n, a, k: _slice(*a),
    "unbind": lambda p, n, a, k: [np.take(a[0], i, axis=_axis(a)) for i in range(a[0].shape[_axis(a)])],
    "stack": lambda p, n, a, k: np.stack(a[0], axis=a[1] if len(a) > 1 else 0),
    "cat": lambda p, n, a, k: np.concatenate(a[0], axis=a[1] if len(a) > 1 else 0),
    "unsqueeze": lambda p, n, a, k: np.expand_dims(a[0], a[1]),
    "squeeze": lambda p, n, a, k: np.reshape(a[0], _shape(n)),
    "view": lambda p, n, a, k: np.reshape(a[0], _shape(n)),
    "reshape": lambda p, n, a, k: np.reshape(a[0], _shape(n)),
    "_unsafe_view": lambda p, n, a, k: np.reshape(a[0], _shape(n)),
    "copy_": lambda p, n, a, k: np.broadcast_to(a[1], _shape(n)),  # later uses refer to this result
    "expand": lambda p, n, a, k: np.broadcast_to(a[0], _shape(n)),
    "zeros_like": _filled(0.0),
    "zeros": _filled(0.0),
    "new_zeros": _filled(0.0),
    "_new_zeros_with_same_feature_meta": _filled(0.0),
    "_efficientzerotensor": _filled(0.0),
    "ones_like": _filled(1.0),
    "ones": _filled(1.0),
    "new_ones": _filled(1.0),
    "full_like": lambda p, n, a, k: np.full(_shape(n), float(a[1]), dtype=object),
    "full": lambda p, n, a, k: np.full(_shape(n), float(a[1]), dtype=object),
    "new_full": lambda p, n, a, k: np.full(_shape(n), float(a[2]), dtype=object),
    "scalar_tensor": lambda p, n, a, k: np.asarray(float(a[0]), dtype=object),
    "flip": lambda p, n, a, k: np.flip(a[0], axis=tuple(a[1])),
}


def _axis(a: tuple) -> int:
    return a[1] if len(a) > 1 else 0


def _slice(array: Arrays, axis: int = 0, start: int | None = None, stop: int | None = None, step: int = 1) -> Arrays:
    if axis % array.ndim == array.ndim - 1:
        return array
    stop = None if stop is None or stop > array.shape[axis] else stop
    place = [slice(None)] * array.ndim
    place[axis] = slice(start, stop, step)
    return array[tuple(place)]
