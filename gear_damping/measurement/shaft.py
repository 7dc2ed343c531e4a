"""A shaft's angle at the samples of a record, out of what its encoder or tacho left in the file."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.encoders import TURN, angle_from_counts, angle_from_pulses, rising_edges
from gear_damping.measurement.plan import EncoderPlan
from gear_damping.measurement.timebase import TimeBase
from gear_damping.units import parse_unit, to_si

_TURN_TOLERANCE = 0.25  # of a turn; a pulse is known to a sample
ReadColumn = Callable[[str | int, str], NDArray[np.float64]]


def shaft_angle(
    plan: EncoderPlan, base: TimeBase, rows: ReadColumn, whole: ReadColumn, file: str
) -> NDArray[np.float64]:
    """(n,) rad at the record's samples as they are stamped in the file.

    Args:
        plan: The declared encoder or tacho.
        base: The record's time base.
        rows: Reads the record's rows of a column.
        whole: Reads a whole column, such as the times of pulses.
        file: The file, for messages.

    Raises:
        InputError: a column, unit or pulse train that cannot be used.
    """
    time = base.time if base.stamps is None else base.stamps
    if plan.name != "tacho" and not plan.timestamps:
        angle = angle_from_counts(rows(plan.column, f"{plan.key}.column"), plan.per_revolution, plan.direction)
        return angle - (0.0 if plan.index is None else _at_index_pulse(plan, angle, rows, file))
    key = f"{plan.key}.{'timestamps' if plan.timestamps else 'column'}"
    if plan.timestamps:
        pulses = whole(plan.column, key) * to_si(1.0, plan.unit, "s", f"{plan.key}.unit", file)
    else:
        signal = rows(plan.column, key)
        pulses = rising_edges(signal, time, _threshold(plan, signal, file))
    angle = angle_from_pulses(pulses, time, plan.per_revolution, plan.direction, key, file)
    return angle - (0.0 if plan.index is None else _at_index_stamp(plan, angle, time, whole, file))


def _threshold(plan: EncoderPlan, signal: NDArray, file: str) -> float:
    """The declared threshold in the column's unit, else half way between the extremes."""
    if plan.threshold is None:
        return float(signal.min() + signal.max()) / 2
    key = f"{plan.key}.threshold"
    declared = to_si(plan.threshold.value, plan.threshold.unit, plan.unit, key, file)
    return declared / parse_unit(plan.unit, f"{plan.key}.unit", file).factor


def _at_index_pulse(plan: EncoderPlan, angle: NDArray, rows: ReadColumn, file: str) -> float:
    """The angle at the first index pulse, which is the shaft's zero."""
    signal = rows(plan.index, f"{plan.key}.index")
    high = np.flatnonzero(signal > (signal.min() + signal.max()) / 2)
    if not high.size:
        raise InputError(Problem(f"{plan.key}.index", "holds no pulse", plan.index, "leave it out", file))
    _refuse_turns(plan, angle[high[np.r_[True, np.diff(high) > 1]]], file)
    return float(angle[high[0]])


def _refuse_turns(plan: EncoderPlan, at: NDArray, file: str) -> None:
    """Index pulses come once a turn, or the counts per revolution are not those of this encoder."""
    turns = float(np.median(np.abs(np.diff(at)))) / TURN if at.size > 1 else 1.0
    if abs(turns - 1) > _TURN_TOLERANCE:
        rule = f"its pulses are {turns:.3g} turns of {plan.per_revolution:g} counts apart"
        raise InputError(Problem(f"{plan.key}.index", rule, plan.index, "check counts_per_revolution", file))


def _at_index_stamp(plan: EncoderPlan, angle: NDArray, time: NDArray, whole: ReadColumn, file: str) -> float:
    """The same from the times of the index pulses."""
    key = f"{plan.key}.index"
    stamps = whole(plan.index, key) * to_si(1.0, plan.unit, "s", f"{plan.key}.unit", file)
    seconds = stamps[0]
    if not time[0] <= seconds <= time[-1]:
        rule = "the first index pulse lies outside the record"
        raise InputError(Problem(key, rule, plan.index, "shorten the record, or leave it out", file))
    _refuse_turns(plan, np.interp(stamps[stamps <= time[-1]], time, angle), file)
    return float(np.interp(seconds, time, angle))
