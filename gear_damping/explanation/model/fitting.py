"""The fit of a hypothesis to the evidence."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import torch
from torch import Tensor

from gear_damping.explanation.evidence.noise import Scatter
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.cross_fit import CrossFit, cross_fitted
from gear_damping.explanation.model.hypothesis import Hypothesis, Outcome, mean_free_places, segments_of, settled_at
from gear_damping.explanation.model.opened import opened
from gear_damping.identification.output_error.descent import Lent
from gear_damping.identification.output_error.least_squares import TO_THE_END, Ends, Fitted, Rounds, fit
from gear_damping.identification.output_error.problem import OutputErrorProblem, error_amplification
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.segments import in_segments, joined
from gear_damping.simulation.solver_settings import Solver

ITERATIONS_NEAR = 20  # to get near enough for the whole records
ROUNDS = Rounds(30)  # linearisations of a fit that begins near its end


@dataclass(frozen=True)
class InitialValues:
    """Where a fit begins.

    Args:
        starts: Coordinates of several starts, (starts, n_free); at the parameters' own starts where absent.
        after: A fit from whose initial states of the records to fit this one starts.
        own: Where parameters of single records begin, by name.
        is_near: Whether it is so near that flanks which part need no segments to lead it there.
    """

    starts: Tensor | None = None
    after: Outcome | None = None
    own: Mapping[str, float] = field(default_factory=dict)
    is_near: bool = False


def fit_hypothesis(
    hypothesis: Hypothesis,
    evidence: Evidence,
    initial: InitialValues = InitialValues(),
    rounds: Rounds = ROUNDS,
    ends: Ends = TO_THE_END,
    solver: Solver | None = None,
) -> Outcome:
    """Fit to the records to fit.

    Args:
        hypothesis: What is fitted; its free parameters start where they say.
        evidence: The records, which also say whether the time for fits is over.
        initial: Where it begins.
        rounds: How far it goes.
        ends: When it stops before; what is enough, in noise variances.
        solver: Settings of the solver.
    """
    parts = hypothesis.model.flanks_may_part
    if parts and not evidence.segments and not initial.is_near:
        near = _fit_in_segments(hypothesis, evidence, initial.starts, rounds.kept, ends.enough, solver)
        if near.error_amplification > evidence.settings.most_growth:
            return near
        hypothesis, initial = near.hypothesis, replace(initial, starts=None, after=near)
    segmented, after = in_segments(evidence.fit, evidence.segments), initial.after
    problem = OutputErrorProblem(hypothesis.model, hypothesis.given, hypothesis.free, segmented, solver, evidence.noise)
    states, shared = _begin(problem, hypothesis, initial)
    if evidence.segments:  # short already, and started from what was measured: another model's states lead astray
        states, rounds = None, replace(rounds, horizons=[None] * len(rounds.horizons))
    ends = replace(ends, enough=ends.enough * evidence.noise**2, is_over=evidence.is_over)
    fitted = fit(problem, shared, rounds, states, ends, None if after is None else lent_from(problem, after))
    fitted = replace(fitted, shared=_without_means(fitted.shared, hypothesis, problem))
    values = {name: float(value) for name, value in problem.unknowns.parameters(fitted.shared).items()}
    found = _outcome(settled_at(hypothesis, values), Fit(problem, fitted, values), evidence)
    if evidence.sealed or not evidence.holdout:
        return found
    found = opened(found, evidence, solver, None if after is None else after.own)
    return replace(found, left_out=found.holdout, scatter=Scatter())


def _without_means(shared: Tensor, hypothesis: Hypothesis, problem: OutputErrorProblem) -> Tensor:
    """Coordinates with the means that act on nothing taken out."""
    found = shared.clone()
    for places in mean_free_places(hypothesis, problem.free):
        found[places] -= found[places].mean()
    return found


def _begin(problem: OutputErrorProblem, hypothesis: Hypothesis, initial: InitialValues) -> tuple[Tensor | None, Tensor]:
    """Initial states (None: from the records) and coordinates, those of single records among them."""
    starts, after = initial.starts, initial.after
    if starts is None:
        starts = torch.zeros(1, len(hypothesis.common), dtype=torch.float64)
    states = None if after is None else initial_states_from(problem, after, len(starts))
    shared = problem.unknowns.completed(starts)
    if after is not None:
        shared = shared + own_from(problem, after)
    for place, parameter in enumerate(problem.free):
        if parameter.name in initial.own:
            shared[:, place] = parameter.coordinate(initial.own[parameter.name])
    return states, shared


@dataclass(frozen=True)
class Fit:
    """A problem with its solution and the fitted values by name."""

    problem: OutputErrorProblem
    fitted: Fitted
    values: dict[str, float]


def _outcome(settled: Hypothesis, found: Fit, evidence: Evidence) -> Outcome:
    """The fit with what it leaves of its records, as they are and with operating conditions left out."""
    problem, fitted = found.problem, found.fitted
    crossed = cross_fitted(problem, fitted) if evidence.sealed else CrossFit(fitted.prediction.residual[0], Scatter())
    left = [
        [part / record.weight for part, record in zip(whole, evidence.fit, strict=True)]
        for series in (crossed.residuals, fitted.prediction.residual[0])
        for whole in [joined(series, evidence.fitted, evidence.segments, problem.response.channels)]
    ]
    amplification = error_amplification(fitted.prediction, problem.n_shared)
    return Outcome(settled, problem, fitted, found.values, *left, crossed.scatter, amplification)


def _fit_in_segments(
    hypothesis: Hypothesis,
    evidence: Evidence,
    starts: Tensor | None,
    kept: float,
    enough: float,
    solver: Solver | None,
) -> Outcome:
    """A fit to segments of the records, with the error amplification over whole ones.

    Where flanks part, the cost over whole records has many minima; over short segments it has few.
    """
    short = replace(evidence, segments=segments_of(hypothesis, evidence))
    rounds = Rounds((ITERATIONS_NEAR, ITERATIONS_NEAR), (None, None), kept)
    near = fit_hypothesis(hypothesis, short, InitialValues(starts), rounds, Ends(enough), solver)
    return replace(near, error_amplification=error_amplification_over(near.hypothesis, evidence.fit, solver))


def error_amplification_over(hypothesis: Hypothesis, records: Sequence[FitRecord], solver: Solver | None) -> float:
    """How much an error of the initial state grows over whole records, in the one where it grows most."""
    problem = OutputErrorProblem(hypothesis.model, hypothesis.given, (), records, solver)
    none = torch.zeros(1, problem.n_shared, dtype=torch.float64)
    return error_amplification(problem.linearise(none, problem.first_states().unsqueeze(0)), problem.n_shared)


def initial_states_from(problem: OutputErrorProblem, after: Outcome, points: int) -> Tensor:
    """Initial states of several points of a problem, (points, records, local), from a fit to the same records.

    From the records themselves where that fit cut them so that some begin elsewhere.
    """
    places = _beginnings(problem.records, after.problem.records)
    if places is None:
        return problem.first_states().repeat(points, 1, 1)
    return problem.states_of(after.problem, after.fitted.states, places).repeat(points, 1, 1)


def _beginnings(records: Sequence[FitRecord], others: Sequence[FitRecord]) -> list[int] | None:
    """For each record the other one that begins with it; None where there is none for one of them."""
    if len(records) == len(others):
        return list(range(len(records)))
    begin = {(other.record, round(other.begins * other.sampling_rate)): place for place, other in enumerate(others)}
    found = [begin.get((record.record, round(record.begins * record.sampling_rate))) for record in records]
    return None if None in found else found


def lent_from(problem: OutputErrorProblem, after: Outcome) -> Lent | None:
    """Sensitivities by elements of lists, as a fit to the same records found them; None where there are none.

    A list has many, as the harmonics of a stiffness, and another effect changes little of what each of them does.
    """
    there = {p.name: place for place, p in enumerate(after.problem.free) if "[" in p.name}
    places = [place for place, p in enumerate(problem.free) if p.name in there]
    columns = after.fitted.prediction.sensitivity[0]
    if not places or columns.shape[:2] != problem.response.values.shape:
        return None
    columns = columns[..., [there[problem.free[place].name] for place in places]]
    return Lent(places, columns) if bool(columns.isfinite().all()) else None


def own_from(problem: OutputErrorProblem, after: Outcome) -> Tensor:
    """Coordinates of a problem, (n_shared,): gains and what single records have of their own as a fit found them."""
    return problem.unknowns.own_of(after.problem.unknowns, after.fitted.shared)
