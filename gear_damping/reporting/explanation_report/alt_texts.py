"""What each figure of a report shows, for those who do not see it: its kind, its axes, and the figures in it."""

from collections.abc import Mapping, Sequence
from math import sqrt
from typing import Any

import numpy as np

from gear_damping.reporting.explanation_report.vocabulary import listed
from gear_damping.reporting.figures import Overlay, ResidualSpectrum
from gear_damping.reporting.numbers import number, percent
from gear_damping.reporting.page.render import words

MOST_NAMED = 4  # rows that are read out


def overlay(shown: Overlay, unit: str, quantity: str) -> str:
    """Of measured, nominal and extended."""
    measured = np.asarray(shown.measured)
    curves = {"nominal": shown.nominal, "extended": shown.extended}
    left = [f"{name} {_rms(measured - np.asarray(v))} {unit}" for name, v in curves.items() if v is not None]
    extended = " and extended" if shown.extended is not None else ""
    return (
        f"Three line charts over time of {shown.record}, in {unit}: the {quantity}, measured, with the nominal"
        f"{extended} simulation; the residuals in the same stretch; the residuals of the whole record. "
        f"Root mean square of the residual: {', '.join(left)}."
    )


def misfit(records: Mapping[str, Mapping[str, float | None]], floor: float) -> str:
    """Of before and after."""
    said = [
        f"{name} from {number(entry.get('before'), 3)} to {number(entry.get('after'), 3)}"
        for name, entry in list(records.items())[:MOST_NAMED]
    ]
    return f"Misfit of each held-out record before and after; noise alone leaves {number(floor, 3)}. {_said(said)}"


def spectrum(shown: ResidualSpectrum, unit: str) -> str:
    """Of the residual's spectrum."""
    places = np.asarray(shown.places)
    peak = int(np.nanargmax(np.asarray(shown.before)))
    axis, at = ("frequency in Hz", "Hz") if shown.mesh_order is None else ("order of the pinion", "turns of the pinion")
    height = number(float(np.asarray(shown.before)[peak]), 3)
    after = "" if shown.after is None else f", after {number(float(np.asarray(shown.after)[peak]), 3)} {unit}"
    return (
        f"Line chart of amplitudes in {unit} over {axis}: {listed(list(shown.lines))}. The largest line of the "
        f"residual before lies at {number(float(places[peak]), 3)} {at}: {height} {unit}{after}."
    )


def candidates(rows: Sequence[Mapping[str, Any]], needed: float | None) -> str:
    """Of what was tried."""
    known = sorted((row for row in rows if row.get("share") is not None), key=lambda row: -row["share"])
    said = [f"{words(row['name'])} {percent(row['share'])}" for row in known[:MOST_NAMED]]
    line = "" if needed is None else f" A line marks the {percent(needed)} that a cause has to take."
    return f"Bar chart of the share of the excess that each effect explains on left-out records. {_said(said)}{line}"


def visible(statistics: Mapping[str, float], limit: float) -> str:
    """Of what stands out."""
    ranked = sorted(statistics.items(), key=lambda one: -one[1])
    said = [f"{words(name)} {number(value, 3)}" for name, value in ranked[:MOST_NAMED]]
    above = sum(value > limit for _, value in ranked)
    return (
        f"Bar chart of the standardised score of every effect; {above} of {len(ranked)} pass the limit of "
        f"{number(limit, 3)} standard deviations. {_said(said)}"
    )


def forest(rows: Sequence[Mapping[str, Any]], joint: Mapping[str, Any], quantity: str) -> str:
    """Of the size of a cause by record."""
    said = [f"{row['record']} {number(row['value'], 3)}" for row in rows[:MOST_NAMED]]
    return (
        f"Estimates of {quantity} with 95 % intervals, a row a record, beside that of all records together, "
        f"{number(joint['value'], 3)}. {_said(said)}"
    )


def _said(said: Sequence[str]) -> str:
    return f"{'; '.join(said)}." if said else "There is nothing to show."


def _rms(values: np.ndarray) -> str:
    return number(sqrt(float(np.nanmean(np.square(values)))), 3)
