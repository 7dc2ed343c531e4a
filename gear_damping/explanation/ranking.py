"""Step 5b: what each candidate could explain, by its sensitivity with the nuisance projected out (score test)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from gear_damping.explanation.candidates import Candidate
from gear_damping.explanation.evidence import Evidence
from gear_damping.explanation.hypothesis import Outcome, begun_from
from gear_damping.identification.output_error.least_squares import full_jacobian
from gear_damping.identification.output_error.problem import DIFFERENCE, OutputErrorProblem
from gear_damping.simulation.solver_settings import Solver

PROBE = 0.05  # share of a strength's size that its slope is taken over
CONTAINED = 0.99  # cosine with what another can do, from which it contains this one
VISIBLE = 5.0  # standard deviations at which an effect counts as visible


@dataclass(frozen=True)
class Score:
    """What a candidate promises.

    Args:
        candidate: The candidate.
        gain: Share of the fitted residual's energy that it would take, linearised.
        start: Coordinates of its free parameters at that optimum.
        direction: Unit vector of what it would explain, nuisance projected out.
        smallest: Size of its first strength that would just be visible, in the strength's own unit.
        columns: Orthonormal basis of what it can do beside the nuisance, (samples, n).
        variants: Of an effect that is tried as a whole, its other sizes.
    """

    candidate: Candidate
    gain: float
    start: Tensor
    direction: Tensor
    smallest: float
    columns: Tensor
    variants: tuple[Candidate, ...] = ()


class Projector:
    """Takes out of a signal what the free parameters of a fit could do.

    What is expected of the parameters counts as further samples, one for each, behind those of the records.
    """

    def __init__(self, outcome: Outcome) -> None:
        jacobian = full_jacobian(outcome.fitted.prediction.sensitivity, outcome.problem.n_shared)[0]
        expected, slope = outcome.problem.expectation(outcome.fitted.shared)
        self.expected = expected
        rows = torch.nn.functional.pad(torch.diag(slope), (0, jacobian.shape[1] - len(slope)))
        jacobian = torch.cat([jacobian, rows])
        norms = jacobian.norm(dim=0).clamp(min=1e-300)
        self.basis = torch.linalg.qr(jacobian / norms).Q

    def __call__(self, signal: Tensor) -> Tensor:
        """`signal` (samples + n_shared, n) without its part in the span of the sensitivities."""
        return signal - self.basis @ (self.basis.T @ signal)


def scores(
    outcome: Outcome,
    evidence: Evidence,
    candidates: Sequence[Candidate],
    noise: float,
    solver: Solver | None = None,
    report: Callable[[int, int], None] | None = None,
) -> list[Score]:
    """Every candidate's score, the most promising first."""
    project = Projector(outcome)
    residual = torch.cat([outcome.fitted.prediction.residual[0].reshape(-1), project.expected])
    base = _predicted(outcome)
    found = []
    for number, candidate in enumerate(candidates):
        score = _score(candidate, outcome, evidence, project, residual, base, noise, solver)
        found += [score] if score is not None else []
        if report:
            report(number + 1, len(candidates))
    return sorted(found, key=lambda score: -score.gain)


def _predicted(outcome: Outcome) -> Tensor:
    return (outcome.problem.response * outcome.problem.weights - outcome.fitted.prediction.residual[0]).reshape(-1)


def _score(
    candidate: Candidate,
    outcome: Outcome,
    evidence: Evidence,
    project: Projector,
    residual: Tensor,
    base: Tensor,
    noise: float,
    solver: Solver | None,
) -> Score | None:
    free = candidate.hypothesis.free
    problem = OutputErrorProblem(candidate.hypothesis.model, candidate.hypothesis.given, free, evidence.fit, solver)
    points, steps = _probes(candidate, len(free))
    states = begun_from(problem, outcome, len(points))
    found = (problem.predict(points, states) * problem.weights).reshape(len(points), -1)
    if not bool(found.isfinite().all()):
        return None
    columns = torch.nn.functional.pad((found - base) / steps.unsqueeze(1), (0, len(project.expected))).T
    beside = project(columns)
    # What the nuisance takes but for rounding is nothing of its own.
    own = beside.norm(dim=0) > 1e-6 * columns.norm(dim=0).clamp(min=1e-300)
    beside = torch.where(own, beside, torch.zeros_like(beside))
    if not bool(own.any()):
        return _unseen(candidate, len(free), len(residual))
    coefficients = _coefficients(beside, residual)
    explained = beside @ coefficients
    wide = torch.cat([beside, project(_within_reach(candidate, problem, states[:1], project))], 1)
    gain = float(residual @ _explained(wide, residual) / residual.square().sum())
    basis, spread, _ = torch.linalg.svd(beside, full_matrices=False)
    kept = basis[:, spread > 1e-6 * spread[0]]
    smallest = VISIBLE * noise / float(beside[:, 0].norm().clamp(min=1e-300)) * _unit(candidate)
    start = _start(candidate, coefficients, len(free))
    return Score(candidate, gain, start, explained / explained.norm().clamp(min=1e-300), smallest, kept)


def _coefficients(columns: Tensor, signal: Tensor) -> Tensor:
    return torch.linalg.lstsq(columns, signal.unsqueeze(1), rcond=1e-9, driver="gelsd").solution[:, 0]


def _explained(columns: Tensor, signal: Tensor) -> Tensor:
    return columns @ _coefficients(columns, signal)


def _within_reach(candidate: Candidate, problem: OutputErrorProblem, states: Tensor, project: Projector) -> Tensor:
    """What another size of an effect that is tried as a whole would change, and another start of its states.

    Far from linear as it is, an effect whose size is not among those tried would otherwise be judged by a size
    that fits badly.
    """
    if not candidate.presence:
        return torch.zeros(len(project.basis), 0, dtype=torch.float64)
    own = [i for i, p in enumerate(candidate.hypothesis.free) if p.name.startswith(candidate.name + ".")]
    places = [*own, *(problem.n_shared + 2 + i for i in range(len(problem.extra)))]
    moves = torch.zeros(len(places) + 1, problem.n_shared + len(problem.local), dtype=torch.float64)
    moves[range(1, len(moves)), places] = DIFFERENCE
    shared, moved = moves[:, : problem.n_shared], states + moves[:, None, problem.n_shared :]
    found = problem.predict(shared, moved) * problem.weights
    slopes = ((found[1:] - found[0]) / DIFFERENCE).permute(1, 2, 0).unsqueeze(0)
    flat = full_jacobian(slopes, len(own))[0]
    return torch.nn.functional.pad(flat, (0, 0, 0, len(project.expected)))


def _unseen(candidate: Candidate, n_free: int, samples: int) -> Score:
    nothing = torch.zeros(samples, dtype=torch.float64)
    start = torch.zeros(n_free, dtype=torch.float64)
    return Score(candidate, 0.0, start, nothing, float("inf"), nothing.reshape(-1, 1)[:, :0])


def _unit(candidate: Candidate) -> float:
    """One coordinate of the first strength in its own unit."""
    parameter = candidate.hypothesis.free[candidate.strengths[0]]
    return abs(parameter.start) if candidate.presence else parameter.scale


def _probes(candidate: Candidate, n_free: int) -> tuple[Tensor, Tensor]:
    """Coordinates at which the candidate is tried, and how far each is from switched off."""
    rows, steps = [], []
    for place in candidate.strengths:
        row = torch.zeros(n_free, dtype=torch.float64)
        if candidate.presence:
            return torch.zeros(1, n_free, dtype=torch.float64), torch.ones(1, dtype=torch.float64)
        row[place] = PROBE
        rows.append(row)
        steps.append(PROBE)
        if place in candidate.phases:
            turned = row.clone()
            turned[candidate.phases[place]] = torch.pi / 2
            rows.append(turned)
            steps.append(PROBE)
    return torch.stack(rows), torch.tensor(steps, dtype=torch.float64)


def _start(candidate: Candidate, coefficients: Tensor, n_free: int) -> Tensor:
    """Coordinates of the linearised optimum: amplitudes and phases from their cosine and sine parts."""
    start = torch.zeros(n_free, dtype=torch.float64)
    for place, coordinate in candidate.begun.items():
        start[place] = coordinate
    if candidate.presence:
        return start
    column = 0
    for place in candidate.strengths:
        if place in candidate.phases:
            cosine, sine = coefficients[column], coefficients[column + 1]
            start[place] = torch.hypot(cosine, sine)
            start[candidate.phases[place]] = torch.atan2(sine, cosine)
            column += 2
        else:
            start[place] = coefficients[column]
            column += 1
    return start


def collinearity(first: Score, second: Score) -> float:
    """Largest cosine between what two candidates can do beside the nuisance; 1 means not to be told apart."""
    if not first.columns.shape[1] or not second.columns.shape[1]:
        return 0.0
    one, other = first.direction, second.columns
    return float((other.T @ one).norm())


def contains(larger: Score, smaller: Score) -> bool:
    """Whether one candidate can do what the other would, with more parameters."""
    more = larger.columns.shape[1] > smaller.columns.shape[1] > 0
    return more and collinearity(smaller, larger) > CONTAINED
