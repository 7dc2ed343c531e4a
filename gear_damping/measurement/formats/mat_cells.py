"""Cell arrays that hold a table, one number to a cell, as MATLAB's `[~, ~, raw] = xlsread` leaves one."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.formats.header import find_header

MIXED = "cells of numbers and texts; in MATLAB save its columns, as t = cell2mat(raw(2:end, 1))"
_HEAD = 10  # rows among which names and units are looked for: a sheet has a title, names, units and little more
_SIDES = 2  # of a table: rows and columns
_SCATTERED = 100  # cells of one value each that are listed one by one; more are a table of another kind


def columns_of(cells: NDArray) -> Iterator[tuple[str, NDArray[np.float64]]] | None:
    """The columns of an array of cells with their names, units in brackets behind these; None where it is no table.

    Without names above its numbers it is one matrix, whose name is "". Empty cells are nan.
    """
    if cells.ndim != _SIDES:
        return None
    rows = cells if cells.shape[0] >= cells.shape[1] else cells.T
    first = next((k for k, row in enumerate(rows[: _HEAD + 1]) if not any(isinstance(one, str) for one in row)), None)
    if first is None or first == len(rows):
        return None
    numbers = [[_number(one) for one in row] for row in rows[first:]]
    if any(one is None for row in numbers for one in row):
        return None
    values = np.array(numbers, dtype=np.float64)
    return _named(rows[:first], values) if first else iter([("", values)])


def is_scattered(cells: NDArray) -> bool:
    """Whether the cells of a table hold one number or text each, and are more than can be told one by one."""
    if cells.ndim != _SIDES or cells.size <= _SCATTERED:
        return False
    return all(isinstance(one, str) or _number(one) is not None for one in cells.ravel())


def _named(above: NDArray, values: NDArray[np.float64]) -> Iterator[tuple[str, NDArray[np.float64]]]:
    texts = [[one if isinstance(one, str) else "" for one in row] for row in above]
    header = find_header([*texts, *([str(one) for one in row] for row in values[:_HEAD])], values.shape[1])
    for k, column in enumerate(values.T):
        unit, name = header.units[k] if k < len(header.units) else "", header.name(k) or f"[{k}]"
        yield (f"{name} [{unit.strip('[]() ')}]" if unit.strip("[]() ") else name), column


def _number(cell: Any) -> float | None:
    """The number in a cell, nan of an empty one; None of any other."""
    if isinstance(cell, np.ndarray) and cell.size <= 1 and cell.dtype.kind in "fiub":
        return float(cell.item()) if cell.size else np.nan
    return float(cell) if isinstance(cell, int | float | np.number | np.bool_) and np.isreal(cell) else None
