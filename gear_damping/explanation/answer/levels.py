"""Levels that records have of their own, as of their damping: brought to one scale, and told record by record."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import torch
from torch import Tensor

from gear_damping.explanation.answer.gain import damping_ratios
from gear_damping.explanation.evidence.declared_units import rig_unit
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.candidates import Candidate
from gear_damping.explanation.model.homogeneity import block_of
from gear_damping.explanation.model.hypothesis import Outcome, natural_frequency_hz
from gear_damping.explanation.model.own_phases import own_levels
from gear_damping.explanation.model.positive import copied
from gear_damping.identification.oscillator.linear_model import DAMPING
from gear_damping.identification.output_error.normal_equations import nuisance_basis, project_out
from gear_damping.identification.output_error.records import SEPARATOR
from gear_damping.identification.output_error.uncertainty import QUANTILE
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import DampingForce, Effect, ElasticForce

SAME = 0.01  # share of a column that the levels leave of it: less is their mean, but for the steps of slopes
Rows = list[dict[str, Any]]


def of_unit_spread(outcome: Outcome, candidates: Sequence[Candidate]) -> Outcome:
    """The same motion with levels whose mean square is 1: only their products with the spread act."""
    if not any(one.own_levels for one in candidates):
        return outcome
    for names in own_levels(outcome).values():
        outcome = _of_unit_spread(outcome, *names)
    return outcome


def _of_unit_spread(outcome: Outcome, spread: str, level: str) -> Outcome:
    values, shared = dict(outcome.values), outcome.fitted.shared.clone()
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


def levels_by_record(outcome: Outcome, cause: str, evidence: Evidence) -> Rows:
    """By how much the coefficient of a cause is off its mean in each fitted record, with its 95 % interval.

    Every parameter is a nuisance but that of the mean, which the levels of all records together are as well. What the
    file states of them counts: of a speed alone masses, stiffness and damping may all be larger together.
    """
    problem, prediction = outcome.problem, outcome.linearisation
    of_spread, level = own_levels(outcome)[cause]
    places = {p.name: i for i, p in enumerate(problem.free) if p.name.startswith(level + SEPARATOR)}
    spread = outcome.values.get(of_spread, 0.0)
    if not places or not spread:
        return []
    own = nuisance_basis(prediction.sensitivity[0], problem.n_shared)
    apart = project_out(prediction.sensitivity[0], own).flatten(0, 1)[:, : problem.n_shared]
    samples, apart = len(apart), torch.cat([apart, _stated(outcome, {*places, of_spread})])
    columns = apart[:, list(places.values())] / spread
    levels = torch.linalg.qr(_scaled(columns)).Q
    beside = (apart - levels @ (levels.T @ apart)).norm(dim=0) > SAME * apart.norm(dim=0)
    basis = torch.linalg.qr(_scaled(apart[:, beside])).Q
    columns = columns - basis @ (basis.T @ columns)
    residual = project_out(prediction.residual[0].unsqueeze(-1), own).flatten()
    residual = residual - basis[:samples] @ (basis[:samples].T @ residual)
    level = float(problem.level(prediction.residual[0]))
    errors = _errors(columns, residual, block_of(outcome, evidence), level**2)
    rows = []
    for name, error in zip(places, errors.tolist(), strict=True):
        value = spread * outcome.values[name]
        ends = [value - QUANTILE * error, value + QUANTILE * error]
        rows.append({"record": name.partition(SEPARATOR)[2], "value": value, "interval95": ends})
    return rows


def _stated(outcome: Outcome, but: set[str]) -> Tensor:
    """A row for what is known of each shared parameter, (n, n), but of some."""
    problem = outcome.problem
    _, slope = problem.expectation(outcome.fitted.shared, outcome.linearisation.residual[0])
    counts = torch.tensor([parameter.name not in but for parameter in problem.free[: problem.n_shared]])
    return torch.diag(slope * counts)


def damping_by_record(outcome: Outcome, evidence: Evidence) -> Rows:
    """The damping ratio of each fitted record in % of critical with its 95 % interval; none where it is one for all."""
    rows, of_spread, level = _rows_of(outcome, DampingForce, evidence)
    if not rows:
        return []
    spread = outcome.values[of_spread]
    mean, by_one = damping_ratios(outcome, {level: torch.tensor([0.0, 1.0], dtype=torch.float64)})
    return _told(rows, lambda value: max(0.0, mean + (by_one - mean) * value / spread))


def coefficient_by_record(outcome: Outcome, evidence: Evidence) -> Rows:
    """The damping coefficient of each fitted record, in SI or per unit of mass; none where it is one for all.

    Without a spring no damping is critical, and the coefficient itself is told.
    """
    mean = float(outcome.flat_given().get(DAMPING, 0.0))
    return _told(_rows_of(outcome, DampingForce, evidence)[0], lambda value: max(0.0, mean + value))


def frequency_by_record(outcome: Outcome, evidence: Evidence) -> Rows:
    """The natural frequency of each fitted record in Hz with its 95 % interval; none where it is one for all."""
    rows, _, _ = _rows_of(outcome, ElasticForce, evidence)
    given = outcome.flat_given()
    stiffness = float(given.get(outcome.hypothesis.system.spring, 0.0))
    if not rows or stiffness <= 0:  # another law has taken the place of the spring
        return []
    mean = natural_frequency_hz(outcome.hypothesis.model, given)
    return _told(rows, lambda value: mean * max(0.0, 1 + value / stiffness) ** 0.5)


def _told(rows: Rows, of_level: Callable[[float], float]) -> Rows:
    """Levels with their intervals as another figure that grows with them."""
    return [
        {
            "record": row["record"],
            "value": of_level(row["value"]),
            "interval95": [of_level(end) for end in row["interval95"]],
        }
        for row in rows
    ]


def _rows_of(outcome: Outcome, kind: type[Effect], evidence: Evidence) -> tuple[Rows, str, str]:
    """The levels of a force of a kind that differs from record to record, with its spread and level by name."""
    for effect in outcome.hypothesis.effects:
        if isinstance(effect, kind) and (names := own_levels(outcome).get(effect.name)):
            return levels_by_record(outcome, effect.name, evidence), *names
    return [], "", ""


def said_of_levels(outcome: Outcome, evidence: Evidence) -> list[str]:
    """Sentences with the damping ratio, and the natural frequency, of every record, from the largest."""
    if evidence.has(Trait.REST) and not evidence.has_spring:
        unit = rig_unit("N*s/m", evidence)
        return _said(coefficient_by_record(outcome, evidence), "viscous damping", unit, 3)
    damping, frequency = damping_by_record(outcome, evidence), frequency_by_record(outcome, evidence)
    return [*_said(damping, "damping ratio", "%", 3), *_said(frequency, "natural frequency", "Hz", 5)]


def _said(rows: Rows, what: str, unit: str, digits: int) -> list[str]:
    if not rows:
        return []

    def text(row: dict[str, Any]) -> str:
        value, low, high = (f"{one:.{digits}g}" for one in (row["value"], *row["interval95"]))
        return f"{value} {unit} ({low} to {high}) in {row['record']}"

    listed = ", ".join(text(row) for row in sorted(rows, key=lambda row: -row["value"]))
    return [f"The {what} is {listed}: no one figure stands for all of them."]


def _errors(columns: Tensor, residual: Tensor, block: int, variance: float) -> Tensor:
    """Standard errors of coefficients, (columns,), whose residuals are correlated within blocks.

    Rows of columns beyond the samples are what is known of parameters, of this `variance`.
    """
    inverse, samples = torch.linalg.pinv(columns.T @ columns), len(residual)
    scores = (columns[:samples] * residual.unsqueeze(1))[: samples // block * block]
    blocks = scores.unflatten(0, (-1, block)).sum(1)
    of_known = variance * columns[samples:].T @ columns[samples:]
    return (inverse @ (blocks.T @ blocks + of_known) @ inverse).diagonal().clamp(min=0).sqrt()


def _scaled(columns: Tensor) -> Tensor:
    return columns / columns.norm(dim=0).clamp(min=1e-300)
