"""The C++ source of a model's kernel."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from gear_damping.simulation import tsit5
from gear_damping.simulation.kernel import MOST_SHIFT, REACH, ROOT_STEPS, SAME_INSTANT, WATCHED, Batch, Kernel
from gear_damping.simulation.native.emit import Written
from gear_damping.simulation.native.expressions import Program
from gear_damping.simulation.native.trace import TRACED_BATCH, trace
from gear_damping.simulation.stepper import MOST_SPLITS

HERE = Path(__file__).resolve().parent
MOST_VECTORS = 2  # that are stepped together
MOST_STATES_OF_TWO = 6  # of members of which two vectors at once still fit the processor's registers,
MOST_OPERATIONS_OF_TWO = 64  # and of their stages: a longer one keeps the processor busy by itself (measured)


def vectors_of(n_state: int, operations: int) -> int:
    """Vectors of lanes that are stepped together, to hide the latency of each; two take twice as long to compile."""
    return MOST_VECTORS if n_state <= MOST_STATES_OF_TWO and operations <= MOST_OPERATIONS_OF_TWO else 1


def kernel_source(kernel: Kernel, batch: Batch, state: Tensor, width: int) -> str:
    """C++ of everything that happens to members of this structure.

    Args:
        kernel: The model's steps.
        batch: A batch, of which the first member is traced with.
        state: Their state.
        width: Lanes of a vector.

    Raises:
        UntraceableError: a term uses an operation that has no native form.
    """
    program = Program()
    sizes = (state.shape[0], batch.fixed.shape[0], batch.series.shape[0], len(kernel.switch_names))
    inputs = _inputs(program, sizes)
    examples = _examples(batch, state, sizes)

    def rates(u: Tensor, y: Tensor, fixed: Tensor, series: Tensor, index: Tensor, active_branch: Tensor) -> Tensor:
        return kernel.rates(u, y, Batch(fixed, series, index), active_branch)

    def switches(u: Tensor, y: Tensor, fixed: Tensor, series: Tensor, index: Tensor, active_branch: Tensor) -> Tensor:
        return kernel.switches(u, y, Batch(fixed, series, index))

    written = Written(program)
    stage = _flat(trace(rates, examples, inputs, program))
    parts = [written.function("rates", stage)]
    if kernel.switch_names:
        parts.append(written.function("switches", _flat(trace(switches, examples, inputs, program))))
    parts.append(written.setup())
    names = ("WIDTH", "VECTORS", "N_STATE", "N_FIXED", "N_SERIES", "N_SWITCH", "N_KEPT")
    numbers = (width, vectors_of(sizes[0], written.operations(stage)), *sizes, len(written.kept))
    defined = [f"#define {n} {v}" for n, v in zip(names, numbers, strict=True)]
    driver = (HERE / "driver.cpp").read_text()
    return "\n".join([*defined, (HERE / "vectors.h").read_text(), tableau(), crossings(), *parts, driver])


def tableau() -> str:
    """The coefficients of the method as C++: N_STAGE, NODES, STAGES and WEIGHTS."""
    count = len(tsit5.NODES)
    rows = ", ".join(_listed([*row, *[0.0] * (count - 1 - len(row))]) for row in tsit5.STAGES)
    return "\n".join(
        [
            f"static const int N_STAGE = {count};",
            f"static const double NODES[{count}] = {_listed(tsit5.NODES)};",
            f"static const double STAGES[{count}][{count - 1}] = {{{rows}}};",
            f"static const double WEIGHTS[{count}] = {_listed(tsit5.WEIGHTS)};",
        ]
    )


def crossings() -> str:
    """What crossings of a branch are searched with, as C++."""
    return "\n".join(
        [
            f"static const double WATCHED[{len(WATCHED)}] = {_listed(WATCHED)};",
            f"static const double REACH = {REACH!r}, MOST_SHIFT = {MOST_SHIFT!r}, SAME_INSTANT = {SAME_INSTANT!r};",
            f"static const int ROOT_STEPS = {ROOT_STEPS}, MOST_SPLITS = {MOST_SPLITS};",
        ]
    )


def _listed(values: Sequence[float]) -> str:
    return "{" + ", ".join(map(repr, values)) + "}"


def _flat(results: list[np.ndarray]) -> list:
    return [value for result in results for value in np.ravel(result)]


def _inputs(program: Program, sizes: tuple[int, int, int, int]) -> list[np.ndarray]:
    """Expressions of u, y, fixed, series, index and the active branch, in the order of the traced functions."""
    n_state, n_fixed, n_series, n_switch = sizes

    def rows(letter: str, count: int, varies: bool) -> np.ndarray:
        made = np.empty((count, 1), dtype=object)
        for i in range(count):
            made[i, 0] = program.input(f"{letter}[{i}]", varies)
        return made

    u = np.array([program.input("u", True)], dtype=object)
    index = np.array(program.input("index", True), dtype=object)
    return [
        u,
        rows("y", n_state, True),
        rows("P", n_fixed, False),
        rows("S", n_series, True),
        index,
        rows("L", n_switch, True),
    ]


def _examples(batch: Batch, state: Tensor, sizes: tuple[int, int, int, int]) -> list[Tensor]:
    def first(rows: Tensor) -> Tensor:
        return rows[:, :1].expand(rows.shape[0], TRACED_BATCH).clone()

    u = torch.zeros(TRACED_BATCH, dtype=state.dtype)
    active_branch = torch.ones(sizes[3], TRACED_BATCH, dtype=state.dtype)
    return [u, first(state), first(batch.fixed), first(batch.series), torch.zeros((), dtype=state.dtype), active_branch]
