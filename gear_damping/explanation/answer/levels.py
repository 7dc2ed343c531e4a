"""Levels that records have of their own, as of their damping: brought to one scale, and told record by record."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import torch
from torch import Tensor

from gear_damping.explanation.answer.gain import damping_ratios
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.candidates import Candidate
from gear_damping.explanation.model.homogeneity import block_of
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.own_phases import own_level
from gear_damping.explanation.model.positive import copied
from gear_damping.identification.output_error.normal_equations import nuisance_basis, project_out
from gear_damping.identification.output_error.records import SEPARATOR
from gear_damping.identification.output_error.uncertainty import QUANTILE

SAME = 0.01  # share of a column that the levels leave of it: less is their mean, but for the steps of slopes
Rows = list[dict[str, Any]]


def of_unit_spread(outcome: Outcome, candidates: Sequence[Candidate]) -> Outcome:
    """The same motion with levels whose mean square is 1: only their products with the spread act."""
    if not any(one.own_levels for one in candidates):
        return outcome
    values, shared = dict(outcome.values), outcome.fitted.shared.clone()
    spread, level = own_level(outcome)
    levels = {name: value for name, value in values.items() if name.startswith(level + SEPARATOR)}
    size = (sum(value**2 for value in levels.values()) / max(len(levels), 1)) ** 0.5
    if not size:
        return outcome
    factors = {spread: size} | dict.fromkeys(levels, 1 / size)
    predictions = [one and copied(one) for one in (outcome.fitted.prediction, outcome.whitened)]
    for place, parameter in enumerate(outcome.problem.free):
        if (factor := factors.get(parameter.name)) is None:
            continue
        values[parameter.name] *= factor
        shared[place] = (values[parameter.name] - parameter.start) / parameter.scale
        for one in filter(None, predictions):
            one.sensitivity[..., place] /= factor
    own = {name: value / size if name.startswith(level + SEPARATOR) else value for name, value in outcome.own.items()}
    fitted = replace(outcome.fitted, shared=shared, prediction=predictions[0])
    return replace(outcome, fitted=fitted, values=values, own=own, whitened=predictions[1])


def levels_by_record(outcome: Outcome, evidence: Evidence) -> Rows:
    """By how much the damping coefficient of each fitted record is off the mean one, with its 95 % interval.

    Every parameter is a nuisance but that of the mean, which the levels of all records together are as well.
    """
    problem, prediction = outcome.problem, outcome.linearisation
    of_spread, level = own_level(outcome)
    places = {p.name: i for i, p in enumerate(problem.free) if level and p.name.startswith(level + SEPARATOR)}
    spread = outcome.values.get(of_spread, 0.0)
    if not places or not spread:
        return []
    own = nuisance_basis(prediction.sensitivity[0], problem.n_shared)
    apart = project_out(prediction.sensitivity[0], own).flatten(0, 1)[:, : problem.n_shared]
    columns = apart[:, list(places.values())] / spread
    levels = torch.linalg.qr(_scaled(columns)).Q
    beside = (apart - levels @ (levels.T @ apart)).norm(dim=0) > SAME * apart.norm(dim=0)
    basis = torch.linalg.qr(_scaled(apart[:, beside])).Q
    columns = columns - basis @ (basis.T @ columns)
    residual = project_out(prediction.residual[0].unsqueeze(-1), own).flatten()
    errors = _errors(columns, residual - basis @ (basis.T @ residual), block_of(outcome, evidence))
    rows = []
    for name, error in zip(places, errors.tolist(), strict=True):
        value = spread * outcome.values[name]
        ends = [value - QUANTILE * error, value + QUANTILE * error]
        rows.append({"record": name.partition(SEPARATOR)[2], "value": value, "interval95": ends})
    return rows


def damping_by_record(outcome: Outcome, evidence: Evidence) -> Rows:
    """The damping ratio of each fitted record in % of critical with its 95 % interval; none where it is one for all."""
    rows = levels_by_record(outcome, evidence)
    if not rows:
        return []
    of_spread, level = own_level(outcome)
    spread = outcome.values[of_spread]
    levels = [0.0, 1.0, *(float(row["value"]) / spread for row in rows)]
    mean, by_one, *ratios = damping_ratios(outcome, {level: torch.tensor(levels, dtype=torch.float64)})
    slope = (by_one - mean) / spread
    return [
        {
            "record": row["record"],
            "value": ratio,
            "interval95": [max(0.0, ratio + slope * (end - row["value"])) for end in row["interval95"]],
        }
        for row, ratio in zip(rows, ratios, strict=True)
    ]


def said_of_levels(rows: Rows) -> str:
    """A sentence with the damping ratio of every record, from the largest."""
    if not rows:
        return ""
    ordered = sorted(rows, key=lambda row: -row["value"])
    said = [
        f"{r['value']:.3g} % ({r['interval95'][0]:.3g} to {r['interval95'][1]:.3g}) in {r['record']}" for r in ordered
    ]
    return f"The damping ratio is {', '.join(said)}: no one figure stands for all of them."


def _errors(columns: Tensor, residual: Tensor, block: int) -> Tensor:
    """Standard errors of coefficients, (columns,), whose residuals are correlated within blocks."""
    inverse = torch.linalg.pinv(columns.T @ columns)
    scores = (columns * residual.unsqueeze(1))[: len(columns) // block * block]
    blocks = scores.unflatten(0, (-1, block)).sum(1)
    return (inverse @ (blocks.T @ blocks) @ inverse).diagonal().clamp(min=0).sqrt()


def _scaled(columns: Tensor) -> Tensor:
    return columns / columns.norm(dim=0).clamp(min=1e-300)
