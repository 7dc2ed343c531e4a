"""Sensors that speak by turns in the rows of a long table, as a column of their names or numbers tells."""

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.table import Table

Array = NDArray[np.float64]
_MOST = 20  # sensors that take turns: a column of more values is a signal
_FEWEST = 8  # rows of each, as many as a record needs
_CHANGES = 0.5  # share of the rows from one to the next that such a column changes in: else it is a state
_REPEATED = 0.3  # share of the rows with the stamp of the one before: of two that take turns each other row has it
_NEARER = 0.5  # of a step to the next row: what a step to the next row of the same sensor stays below
_IDENTITY = re.compile(
    r"(^|[_\s])(id|name|tag|mac|addr(ess)?|node|dev(ice)?|sens(or)?|probe|chan(nel)?|ch|kanal|signal)([_\s]|\d*$)", re.I
)


def refuse_by_turns(
    table: Table, stamps: Array | None, signals: Sequence[Array], used: set[int], rows: slice, source: str
) -> None:
    """Refuse rows that several sensors speak in by turns.

    Args:
        table: The table.
        stamps: (n,) of the rows; None where a rate is declared.
        signals: (n,) values of each channel in these rows.
        used: The places of the columns of the stamps and the channels.
        rows: Those of the record within the table.
        source: What is named in messages.

    Raises:
        InputError: a column says so, and the stamps or the values bear it out.
    """
    signals = [np.where(np.isfinite(one), one, np.nan) for one in signals]
    stamps = None if stamps is None else np.where(np.isfinite(stamps), stamps, np.nan)
    shared = stamps is not None and float(np.mean(np.diff(stamps) == 0)) > _REPEATED
    if not shared and not any(map(_comes_back, signals)):
        return
    for place, name in enumerate(table.names):
        labels = None if place in used else _labels(table, place, rows)
        if labels is None:
            continue
        said, numbers = labels
        is_named = not str(said[0]).replace(".", "").isdigit() or bool(_IDENTITY.search(name))
        by_stamps = shared and is_named and all(np.all(np.diff(stamps[numbers == k]) > 0) for k in range(len(said)))
        may_be = is_named or shared  # else numbers that come again may count the samples of a revolution
        if by_stamps or (may_be and any(_is_smoother_apart(one, numbers) for one in signals)):
            named = f"'{name}'" if name else str(place)
            rule = f"its rows hold {len(said)} signals by turns ({', '.join(said[:4])}), as column {named} says"
            remedy = f"give each a column of its own, as pivot of pandas does with columns={named}, or a file for each"
            raise InputError(Problem("file", rule, str(table.path), remedy, source))


def seen_by_turns(table: Table, columns: Sequence[Array], time: int | None) -> tuple[str, ...]:
    """What is said of a table whose channels nobody has named yet, where its rows are of several sensors by turns.

    Args:
        table: The table.
        columns: The values of its columns; (0,) of those that cannot be read.
        time: The place of the stamps, if there are any.
    """
    rows = slice(0, max(table.lengths, default=0))
    whole = {k: one for k, one in enumerate(columns) if k != time and one.size == rows.stop}
    signals = [one for one in whole.values() if np.unique(one).size > _MOST]
    stamps = None if time is None or columns[time].size != rows.stop else columns[time]
    try:
        refuse_by_turns(table, stamps, signals, set() if time is None else {time}, rows, "")
    except InputError as error:
        return tuple(f"{one.rule}; {one.remedy}" for one in error.problems)
    return ()


def _comes_back(values: Array) -> bool:
    """Whether (n,) values are nearer to those some rows later than to the next ones."""
    steps = [_mean_step(values, lag) for lag in range(1, _MOST + 1) if values.size > _FEWEST + lag]
    return len(steps) > 1 and min(steps[1:]) < _NEARER * steps[0]


def _mean_step(values: Array, lag: int) -> float:
    return _mean(np.abs(values[lag:] - values[:-lag]))


def _mean(steps: Array) -> float:
    """Of those between numbers; infinite where there are none."""
    known = steps[np.isfinite(steps)]
    return float(known.mean()) if known.size else np.inf


def _labels(table: Table, place: int, rows: slice) -> tuple[list[str], NDArray[np.intp]] | None:
    """The few different cells of a column that changes from row to row, and (n,) which of them each row has."""
    try:
        cells = table.cells(place)[rows]
    except InputError:
        return None
    if cells.size != rows.stop - rows.start or np.unique(cells[: 2 * _MOST].astype(str)).size > _MOST:
        return None
    said, numbers, counts = np.unique(cells.astype(str), return_inverse=True, return_counts=True)
    if not 1 < said.size <= _MOST or counts.min() < _FEWEST or np.mean(np.diff(numbers) != 0) <= _CHANGES:
        return None
    return [str(one).strip().removesuffix(".0") for one in said], numbers


def _is_smoother_apart(values: Array, numbers: NDArray[np.intp]) -> bool:
    """Whether values go on smoothly within the rows of each sensor, and jump between them."""
    order = np.argsort(numbers, kind="stable")
    apart, inside = np.abs(np.diff(values[order])), np.diff(numbers[order]) == 0
    return _mean(apart[inside]) < _NEARER * _mean_step(values, 1)
