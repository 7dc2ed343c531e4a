"""Step 5b: what each candidate could explain, by its sensitivity with the nuisance projected out (score test)."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf

import torch
from torch import Tensor

from gear_damping.explanation.model.candidates import Candidate
from gear_damping.explanation.model.fitting import initial_states_from, own_from
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.own_phases import (
    reach_of_records,
    start_by_record,
    start_of_teeth,
    teeth_of,
    turn_own_phases,
)
from gear_damping.explanation.statistics.projector import Projector
from gear_damping.explanation.statistics.tall import tall_svd
from gear_damping.identification.output_error.problem import OutputErrorProblem, prepare_predictions
from gear_damping.identification.output_error.records import DIFFERENCE, FreeParameter
from gear_damping.physics.terms import Sensor
from gear_damping.simulation.solver_settings import Solver

PROBE = 0.05  # share of a strength's size that its slope is taken over
NEGLIGIBLE = 1e-3  # of the residual, for what an effect tried as a whole would change
SINGULAR = 1e-9  # of the largest: a direction that columns do not have
MOST_SAMPLES = 4_000_000  # that are predicted at once
CONTAINED = 0.99  # cosine with what another can do, from which it contains this one
WIDE = 12  # columns of a candidate: the teeth of one gear, and of few other effects a tenth of them
VISIBLE = 5.0  # standard deviations at which an effect counts as visible


@dataclass(frozen=True)
class Score:
    """The gain that is predicted of a candidate (score test).

    Args:
        candidate: The candidate.
        gain: Share of the fitted residual's energy that it would take, linearised.
        start: Coordinates of its free parameters at that optimum.
        direction: Unit vector of what it would explain, nuisance projected out.
        smallest: Size of its first strength that would just be visible, in the strength's own unit.
        columns: Orthonormal basis of what it can do, less the nuisance, (samples, n); of an effect that is tried as
            a whole, what it would add, with its sign.
        variants: Of an effect that is tried as a whole, its other sizes.
        failed: Why it could not be scored; empty where it could.
        own: Where phases of single records begin, by name.
    """

    candidate: Candidate
    gain: float
    start: Tensor
    direction: Tensor
    smallest: float
    columns: Tensor
    variants: tuple[Candidate, ...] = ()
    failed: str = ""
    own: Mapping[str, float] = field(default_factory=dict)


def best_by_effect(scores: Iterable[Score]) -> dict[str, Score]:
    """The first score of every effect, which of scores in their order is its best, by the effect's name."""
    best: dict[str, Score] = {}
    for score in scores:
        best.setdefault(score.candidate.name, score)
    return best


def projected(outcome: Outcome) -> tuple[Projector, Tensor]:
    """What takes out all that a model's free parameters could do, and its residual with what is expected of these.

    The residual, (samples + n, 1), is as the fit left it.
    """
    prediction = outcome.fitted.prediction
    expected = outcome.problem.expectation(outcome.fitted.shared, prediction.residual[0])
    project = Projector(prediction.sensitivity[0], *expected)
    return project, torch.cat([prediction.residual[0].reshape(-1, 1), project.expected.unsqueeze(1)])


@dataclass(frozen=True)
class Base:
    """The model beside which candidates are scored.

    Args:
        outcome: The fitted model.
        project: Takes out what its own parameters could do.
        residual: What it leaves of the fitted records, (samples + n,).
        orthogonal: The same without what the model's own parameters could do.
        predicted: What it predicts of them, (samples,).
        noise: Standard deviation of the noise.
        solver: Settings of the solver.
        kept: What effects that tell teeth apart would predict, by what was simulated.
    """

    outcome: Outcome
    project: Projector
    residual: Tensor
    orthogonal: Tensor
    predicted: Tensor
    noise: float
    solver: Solver | None
    kept: dict[tuple[object, ...], Tensor] = field(default_factory=dict)


@dataclass(frozen=True)
class Scoring:
    """How candidates are scored.

    Args:
        solver: Settings of the solver.
        enough: Share of the residual's energy; where one candidate promises it, those of many columns, as of an error
            of every tooth, are left out: what that leaves is asked about in the next round, by all of them.
        refuses: Whether there is no time for an effect.
    """

    solver: Solver | None = None
    enough: float = inf
    refuses: Callable[[str], bool] = lambda name: False


def scores(
    outcome: Outcome, candidates: Sequence[Candidate], noise: float, scoring: Scoring = Scoring()
) -> list[Score]:
    """Every candidate's score, the most promising first."""
    if not bool(outcome.fitted.prediction.sensitivity.isfinite().all()):
        return []  # beside a model that runs away nothing can be told
    project, residual = projected(outcome)
    orthogonal, residual = project(residual)[:, 0], residual[:, 0]
    base = Base(outcome, project, residual, orthogonal, _predicted(outcome), noise, scoring.solver)
    found: list[Score] = []
    groups = sorted(_alike(candidates, len(residual)), key=_is_wide)
    hypotheses = [group[0].hypothesis for group in groups]
    prepare_predictions([(h.model, h.given) for h in hypotheses], outcome.problem.records, scoring.solver)
    for group in groups:
        is_spared = max((score.gain for score in found), default=0.0) >= scoring.enough and _is_wide(group)
        if not is_spared and not scoring.refuses(group[0].name):
            found += _score_together(group, base)
    return with_other_sizes(sorted(found, key=lambda score: -score.gain))


def with_other_sizes(ranked: Sequence[Score]) -> list[Score]:
    """The scores, those of an effect that is tried as a whole with the other sizes of its form, the best first.

    It is far from linear between them, so a full fit begins at each.
    """
    sizes: dict[tuple, list[Candidate]] = {}
    for candidate in (score.candidate for score in ranked):
        if candidate.non_nested:
            sizes.setdefault((candidate.name, *candidate.options), []).append(candidate)

    def others(candidate: Candidate) -> tuple[Candidate, ...]:
        found = sizes.get((candidate.name, *candidate.options), ())
        return tuple(other for other in found if other is not candidate)

    return [replace(score, variants=others(score.candidate)) for score in ranked]


def _alike(candidates: Sequence[Candidate], samples: int) -> list[list[Candidate]]:
    """Candidates that one simulation serves: of one form and switched on alike, with other values (of a phase)."""
    groups: dict[object, list[Candidate]] = {}
    for candidate in candidates:
        lists = tuple((k, v) for k, v in candidate.hypothesis.given.items() if isinstance(v, tuple))
        own = (*candidate.own_phases.items(), candidate.own_tooth)
        alike = (candidate.name, candidate.options, candidate.hypothesis.free, candidate.strengths, lists, own)
        groups.setdefault(id(candidate) if candidate.non_nested else alike, []).append(candidate)
    found = []
    for group in groups.values():
        most = max(1, MOST_SAMPLES // (samples * len(_probes(group[0], len(group[0].hypothesis.common))[0])))
        found += [group[i : i + most] for i in range(0, len(group), most)]
    return found


def _is_wide(group: Sequence[Candidate]) -> bool:
    """Whether each of its candidates has many columns."""
    return len(_probes(group[0], len(group[0].hypothesis.common))[0]) >= WIDE


def _varied(group: Sequence[Candidate]) -> list[FreeParameter]:
    """Values in which candidates of a group differ, beginning at those of the first."""
    first = group[0].hypothesis.given
    names = [name for name, value in first.items() if any(c.hypothesis.given[name] != value for c in group)]
    return [FreeParameter(name, float(first[name])) for name in names]


def _predicted(outcome: Outcome) -> Tensor:
    measured = outcome.problem.response.values * outcome.problem.response.weights
    return (measured - outcome.fitted.prediction.residual[0]).reshape(-1)


def _score_together(group: Sequence[Candidate], base: Base) -> list[Score]:
    """Scores of candidates that one simulation serves."""
    hypothesis, varied = group[0].hypothesis, _varied(group)
    records, free = base.outcome.problem.records, (*hypothesis.free, *varied)
    problem = OutputErrorProblem(hypothesis.model, hypothesis.given, free, records, base.solver)
    probes = [_probes(candidate, len(hypothesis.common)) for candidate in group]
    points = torch.cat([_placed_at(rows, one, varied) for (rows, _), one in zip(probes, group, strict=True)])
    points = problem.unknowns.completed(points) + own_from(problem, base.outcome)
    counts = [len(rows) for rows, _ in probes]
    for candidate, rows in zip(group, points.split(counts), strict=True):
        turn_own_phases(rows, candidate, problem)
    states = initial_states_from(problem, base.outcome, len(points))
    found = _found(group[0], problem, points, states, base)
    columns = (found - base.predicted) / torch.cat([steps for _, steps in probes]).unsqueeze(1)
    orthogonal = _projected(columns, reach_of_records(problem) if _is_apart(group[0]) else None, base.project)
    split = orthogonal.split([count * orthogonal.shape[1] // len(points) for count in counts], 1)
    return [_score(one, part, problem, states[:1], base) for one, part in zip(group, split, strict=True)]


def _found(candidate: Candidate, problem: OutputErrorProblem, points: Tensor, states: Tensor, base: Base) -> Tensor:
    """What is predicted at some points, (points, samples).

    Teeth whose numbers no index tells are simulated as those with numbers are, so what is known of these is kept.
    """

    def simulated() -> Tensor:
        return (problem.predict(points, states) * problem.response.weights).reshape(len(points), -1)

    if not candidate.tells_teeth_apart:
        return simulated()
    values = problem.unknowns.by_record(points)
    for name, value in candidate.hypothesis.given.items():
        if not isinstance(value, tuple) and name not in values:
            values[name] = points.new_full((len(points), len(problem.records)), float(value))
    numbers = torch.stack([values[name] for name in sorted(values)]).float().numpy().tobytes()  # but for rounding
    key = (candidate.name, candidate.options, *sorted(values), numbers, states.numpy().tobytes())
    if key not in base.kept:
        base.kept[key] = simulated()
    return base.kept[key]


def _is_apart(candidate: Candidate) -> bool:
    """Whether what it changes in one record says nothing of another: each has its own phase."""
    return bool(candidate.own_phases or candidate.own_tooth)


def _projected(columns: Tensor, reach: Tensor | None, project: Projector) -> Tensor:
    """Columns (n, samples) with the nuisance projected out, (samples + n, columns), those of single records apart."""
    if reach is None:
        padded = torch.nn.functional.pad(columns, (0, len(project.expected))).T
        orthogonal, sizes = project(padded), columns.norm(dim=1)
    else:
        orthogonal = project.by_record(columns, reach)
        sizes = (columns.unflatten(1, (reach.shape[1], -1)).square().sum(-1) @ reach.T).sqrt().flatten()
    # What the nuisance takes but for rounding is nothing of its own.
    own = orthogonal.norm(dim=0) > 1e-6 * sizes.clamp(min=1e-300)
    return orthogonal if bool(own.all()) else torch.where(own | ~sizes.isfinite(), orthogonal, 0.0)


def _placed_at(rows: Tensor, candidate: Candidate, varied: Sequence[FreeParameter]) -> Tensor:
    """Coordinates of a candidate with those of the values that vary in its group behind them."""
    values = [p.coordinate(float(candidate.hypothesis.given[p.name])) for p in varied]
    return torch.cat([rows, rows.new_tensor(values).expand(len(rows), -1)], 1)


def _score(candidate: Candidate, orthogonal: Tensor, problem: OutputErrorProblem, states: Tensor, base: Base) -> Score:
    """The score of a candidate from what it would change with the nuisance projected out, (samples + n, columns)."""
    residual, n_free = base.residual, len(candidate.hypothesis.common)
    if not bool(orthogonal.isfinite().all()):
        return replace(_unseen(candidate, n_free, len(residual)), failed="its prediction diverged")
    if not bool(orthogonal.any()):
        return _unseen(candidate, n_free, len(residual))
    if candidate.own_levels:  # what all of them do together is the parameter's that they are off
        orthogonal = orthogonal - orthogonal.mean(1, keepdim=True)
    basis, singular_values, turned = tall_svd(orthogonal)
    teeth = teeth_of(candidate, orthogonal, base.orthogonal, problem)
    orthogonal = orthogonal if teeth is None else teeth.columns
    if teeth is None:
        told = singular_values > SINGULAR * singular_values[0]
        coefficients = turned[told].T @ (basis[:, told].T @ residual / singular_values[told])
    else:
        coefficients = teeth.strengths
    explained = orthogonal @ coefficients
    kept = basis[:, singular_values > 1e-6 * singular_values[0]]
    if candidate.non_nested:  # there is no less than nothing of it: the sign counts
        kept = orthogonal[:, :1] / orthogonal[:, :1].norm()
    smallest = VISIBLE * base.noise / float(orthogonal[:, 0].norm().clamp(min=1e-300)) * _unit(candidate)
    if _is_beyond(candidate, coefficients):
        gain = 0.0
    elif teeth is None and not candidate.non_nested:
        gain = _share(base.orthogonal, base.orthogonal - explained, base)
    else:
        gain = _gain(candidate, problem, states, orthogonal, base)
    direction = explained / explained.norm().clamp(min=1e-300)
    if teeth is not None:
        at = own_from(problem, base.outcome)
        start, own = start_of_teeth(candidate, teeth, problem, n_free, at)
    elif candidate.own_phases:
        start, own = start_by_record(candidate, coefficients, problem, n_free)
    else:
        start, own = _start(candidate, coefficients, n_free), {}
    return Score(candidate, gain, start, direction, smallest, kept, own=own)


def _is_beyond(candidate: Candidate, coefficients: Tensor) -> bool:
    """Whether every strength would have to be less than none, of an effect of which there is no less than that."""
    if candidate.non_nested or candidate.phases or candidate.own_phases or candidate.own_tooth:
        return False
    own = [candidate.hypothesis.common[place] for place in candidate.strengths]
    return all(p.lower >= p.start for p in own) and bool((coefficients <= 0).all())


def _coefficients(columns: Tensor, signal: Tensor) -> Tensor:
    return torch.linalg.lstsq(columns, signal.unsqueeze(1), rcond=SINGULAR, driver="gelsd").solution[:, 0]


def _share(before: Tensor, after: Tensor, base: Base) -> float:
    """The fall of the squares as a share of the residual's energy."""
    return float((before.square().sum() - after.square().sum()) / base.residual.square().sum())


def _gain(candidate: Candidate, problem: OutputErrorProblem, states: Tensor, orthogonal: Tensor, base: Base) -> float:
    """Share of the residual's energy that a candidate would take, linearised.

    An effect that is tried as a whole is far from linear: what another size of it would change counts with it, and
    another start of its states; otherwise it would be judged by a size that fits badly.
    """
    project, residual = base.project, base.orthogonal
    if candidate.non_nested:
        own = [i for i, p in enumerate(candidate.hypothesis.common) if p.name.startswith(candidate.name + ".")]
        places = [*own, *range(problem.n_shared + 2, problem.n_shared + len(problem.local))]
        slopes = _slopes(problem, places, states, own_from(problem, base.outcome))
        project = project.with_nuisance(slopes[..., len(own) :])
        sizes = torch.nn.functional.pad(slopes[..., : len(own)].flatten(0, 1), (0, 0, 0, len(project.slope)))
        residual, orthogonal = project(base.residual.unsqueeze(1))[:, 0], project(torch.cat([orthogonal, sizes], 1))
        if _is_filter(candidate) and float(residual @ orthogonal[:, 0]) <= 0:
            return 0.0  # less than nothing of it would help: where another channel is late, a low-pass that leads
        # A difference far below the residual is the integrator's: no size that makes sense would lift it to that.
        orthogonal = orthogonal[:, orthogonal.norm(dim=0) > NEGLIGIBLE * residual.norm()]
    left = residual - orthogonal @ _coefficients(orthogonal, residual)
    return _share(base.orthogonal, left, base)


def _is_filter(candidate: Candidate) -> bool:
    """Whether it is a sensor with a memory, which does the more of the same the more there is of it."""
    effect = candidate.hypothesis.effects[-1]
    return isinstance(effect, Sensor) and effect.start_modes > 0


def _slopes(problem: OutputErrorProblem, places: Sequence[int], states: Tensor, at: Tensor) -> Tensor:
    """Slopes of the prediction at coordinates `at` in these shared and local coordinates, (records, time, n)."""
    moves = torch.zeros(len(places) + 1, problem.n_shared + len(problem.local), dtype=torch.float64)
    moves[range(1, len(moves)), places] = DIFFERENCE
    moved = states + moves[:, None, problem.n_shared :]
    found = problem.predict(at + moves[:, : problem.n_shared], moved) * problem.response.weights
    return ((found[1:] - found[0]) / DIFFERENCE).permute(1, 2, 0)


def _unseen(candidate: Candidate, n_free: int, samples: int) -> Score:
    nothing = torch.zeros(samples, dtype=torch.float64)
    start = torch.zeros(n_free, dtype=torch.float64)
    return Score(candidate, 0.0, start, nothing, float("inf"), nothing.reshape(-1, 1)[:, :0])


def _unit(candidate: Candidate) -> float:
    """One coordinate of the first strength in its own unit."""
    parameter = candidate.hypothesis.common[candidate.strengths[0]]
    return abs(parameter.start) if candidate.non_nested else parameter.scale


def _probes(candidate: Candidate, n_free: int) -> tuple[Tensor, Tensor]:
    """Coordinates at which the candidate is tried, and how far each is from switched off."""
    rows, steps = [], []
    for place in candidate.strengths:
        row = torch.zeros(n_free, dtype=torch.float64)
        if candidate.non_nested:
            return torch.zeros(1, n_free, dtype=torch.float64), torch.ones(1, dtype=torch.float64)
        row[place] = PROBE
        repeats = candidate.teeth if candidate.own_tooth and len(candidate.strengths) == 1 else 1
        rows += [row] * repeats
        steps += [PROBE] * repeats
        if place in candidate.phases or (place in candidate.own_phases and not candidate.own_levels):
            turned = row.clone()
            if place in candidate.phases:
                turned[candidate.phases[place]] = torch.pi / 2
            rows.append(turned)
            steps.append(PROBE)
    return torch.stack(rows), torch.tensor(steps, dtype=torch.float64)


def _start(candidate: Candidate, coefficients: Tensor, n_free: int) -> Tensor:
    """Coordinates of the linearised optimum: amplitudes and phases from their cosine and sine parts."""
    start = torch.zeros(n_free, dtype=torch.float64)
    for place, coordinate in candidate.initial_values.items():
        start[place] = coordinate
    if candidate.non_nested:
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
    """Largest cosine between what two candidates can do, less the nuisance; 1 means not to be told apart.

    One may have been scored beside a model with fewer uncertain parameters, whose rows below the samples are fewer.
    """
    if not first.columns.shape[1] or not second.columns.shape[1]:
        return 0.0
    one, other = first.direction, second.columns
    rows = min(len(one), len(other))
    return float((other[:rows].T @ one[:rows]).norm())


def contains(larger: Score, smaller: Score) -> bool:
    """Whether one candidate can do what the other would, with more parameters."""
    more = larger.columns.shape[1] > smaller.columns.shape[1] > 0
    return more and collinearity(smaller, larger) > CONTAINED
