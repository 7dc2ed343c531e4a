"""Records that hold the same samples: fitted twice, intervals are too narrow; held out too, a fit judges itself."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.record import Finding, Record

FEWEST = 16  # samples that are the same: fewer steps of a sensor may agree by chance


def with_what_is_fitted_twice(records: Sequence[Record], responses: Collection[str]) -> tuple[Record, ...]:
    """The records; one whose response an earlier one holds too, of which one is fitted, with a note of that."""
    found: list[Record] = []
    for record in records:
        earlier = (one for one in found if _is_fitted(one) or _is_fitted(record))
        first = next((one for one in earlier if _repeats(record, one, responses)), None)
        found.append(record if first is None else replace(record, findings=(*record.findings, _finding(record, first))))
    return tuple(found)


def _finding(record: Record, first: Record) -> Finding:
    """What the same samples in two records do."""
    if _is_fitted(record) and _is_fitted(first):
        message = (
            f"holds samples that '{first.name}' holds too, and both are fitted: they count twice, and every "
            "interval is too narrow; let each have its own slice or window, or leave one out"
        )
        return Finding("fitted_twice", message, record.name, severity="note")
    message = (
        f"holds samples that '{first.name}' holds too, and one of them is held out: what was fitted to them is "
        "judged by them; let each have its own slice or window, or leave one out"
    )
    return Finding("fitted_and_held_out", message, record.name, severity="note")


def _is_fitted(record: Record) -> bool:
    return record.role in ("fit", None)


def _repeats(record: Record, other: Record, responses: Collection[str]) -> bool:
    """Whether a response of both has the same values at the same stamps."""
    begin, end = max(record.time[0], other.time[0]), min(record.time[-1], other.time[-1])
    for name in responses:
        if name in record.channels and name in other.channels:
            own, theirs = (_within(one.channels[name].values, one.time, begin, end) for one in (record, other))
            if own.size < FEWEST or theirs.size != own.size or own[0] != theirs[0]:  # which spares reading nearly all
                continue
            if np.array_equal(own, theirs) and np.ptp(own) > 0:
                return True
    return False


def _within(values: NDArray[np.float64], time: NDArray[np.float64], begin: float, end: float) -> NDArray[np.float64]:
    return values[np.searchsorted(time, begin) : np.searchsorted(time, end, side="right")]
