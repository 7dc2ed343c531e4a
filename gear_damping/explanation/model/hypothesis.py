"""A simulation as a hypothesis: base system, effects, what is known, what is free, and its fit to the evidence."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any

import torch
from torch import Tensor

from gear_damping.explanation.evidence.noise import Scatter
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.cross_fit import CrossFit, cross_fitted
from gear_damping.identification.output_error.descent import Lent
from gear_damping.identification.output_error.least_squares import Fitted, fit
from gear_damping.identification.output_error.problem import OutputErrorProblem, growth
from gear_damping.identification.output_error.records import SEPARATOR, FitRecord, FreeParameter
from gear_damping.identification.output_error.segments import Segments, in_segments, joined
from gear_damping.identification.output_error.unknowns import GAIN, is_of_model
from gear_damping.identification.time_scale import characteristic_time
from gear_damping.physics.model import Model
from gear_damping.physics.systems.base import System
from gear_damping.physics.terms import Contact, Effect
from gear_damping.simulation.solver_settings import Solver

SEGMENT_TIMES = 5.0  # characteristic times of a segment of a record that cannot be predicted for longer
ITERATIONS_NEAR = 20  # to get near enough for the whole records
Given = dict[str, float | tuple[float, ...]]


@dataclass(frozen=True)
class Hypothesis:
    """A simulator with free parameters.

    Args:
        system: The base.
        effects: Its effects.
        given: Known values by flat name.
        free: What is fitted.
        causes: Names of the effects beyond the nominal model.
        gains: Of channels whose gain is known with an uncertainty only, as fitted.
        replaced: Free parameters that causes took the place of, by cause.
    """

    system: System
    effects: tuple[Effect, ...]
    given: Given
    free: tuple[FreeParameter, ...]
    causes: tuple[str, ...] = ()
    gains: Mapping[str, float] = field(default_factory=dict)
    replaced: Mapping[str, tuple[FreeParameter, ...]] = field(default_factory=dict)

    @property
    def common(self) -> tuple[FreeParameter, ...]:
        """Free parameters that all records share, in the order of the fit's coordinates."""
        return tuple(parameter for parameter in self.free if not parameter.per_record)

    @property
    def model(self) -> Model:
        """The simulator."""
        return Model(self.system, self.effects)

    def with_effect(
        self, effects: Sequence[Effect], given: Given, free: Sequence[FreeParameter], cause: str
    ) -> "Hypothesis":
        """The same with an effect more."""
        return replace(
            self,
            effects=(*self.effects, *effects),
            given=self.given | given,
            free=(*self.free, *free),
            causes=(*self.causes, cause),
        )


@dataclass(frozen=True)
class Outcome:
    """A fitted hypothesis and what it leaves.

    Args:
        hypothesis: With the fitted values as the starts of its free parameters.
        problem: The fit's statement.
        fitted: The fit.
        values: Fitted values by flat name.
        left_out: Residuals of fitted records, each operating condition by parameters fitted to the others, the channels
            of a record one after another: by these, models are compared. Where held-out records are not sealed they
            are those of these.
        fit_residuals: Residuals of fitted records.
        scatter: What errors of the parameters add to the residuals that are left out.
        growth: How much an error of the initial state grows over a record, in the one where it grows most.
        holdout: Residuals of held-out records; empty until they are opened.
        own: What held-out records have of their own, by name.
    """

    hypothesis: Hypothesis
    problem: OutputErrorProblem
    fitted: Fitted
    values: dict[str, float]
    left_out: list[Tensor] = field(repr=False)
    fit_residuals: list[Tensor] = field(repr=False)
    scatter: Scatter = field(default_factory=Scatter)
    growth: float = 0.0
    holdout: list[Tensor] = field(default_factory=list, repr=False)
    own: dict[str, float] = field(default_factory=dict, repr=False)

    @property
    def left_out_cost(self) -> float:
        """Sum of squares of what is left of conditions that are left out."""
        return sum(float(r.square().sum()) for r in self.left_out)

    def flat_given(self) -> Given:
        """Every value of the model by flat name, lists as tuples."""
        return placed(self.hypothesis.given, self.values)


def placed(given: Given, values: dict[str, float]) -> Given:
    """Known values with the fitted ones in their places."""
    merged: Given = dict(given)
    for name, value in values.items():
        flat, _, index = name.partition("[")
        if SEPARATOR in name:
            continue
        if index:
            listed = list(merged[flat])
            listed[int(index.rstrip("]"))] = value
            merged[flat] = tuple(listed)
        elif is_of_model(name):
            merged[name] = value
    return merged


def fit_hypothesis(
    hypothesis: Hypothesis,
    evidence: Evidence,
    starts: Tensor | None = None,
    after: Outcome | None = None,
    *,
    iterations: int | Sequence[int] = 30,
    horizons: Sequence[float | None] | None = None,
    solver: Solver | None = None,
    kept: float = 0.5,
    enough: float = 0.0,
    reach: float = inf,
    own: Mapping[str, float] | None = None,
) -> Outcome:
    """Fit to the records to fit.

    Args:
        hypothesis: What is fitted; its free parameters start where they say.
        evidence: The records.
        starts: Coordinates of several starts, (starts, n_free); at the parameters' own starts where absent.
        after: A fit from whose initial states of the records to fit this one starts.
        iterations: At most so many in each round, or in each of the rounds.
        horizons: Seconds of growing rounds; None for all.
        solver: Settings of the solver.
        kept: Share of the starts that goes on from round to round.
        enough: Fall of the cost, in noise variances, below which the fit has converged.
        reach: Cost of the whole records; a fit that will not get below it is given up.
        own: Where parameters of single records begin, by name.
    """
    if not evidence.segments and any(isinstance(effect, Contact) for effect in hypothesis.effects):
        near = _fit_in_segments(hypothesis, evidence, starts, solver=solver, kept=kept, enough=enough)
        if near.growth > evidence.settings.most_growth:
            return near
        hypothesis, starts, after = near.hypothesis, None, near
    pieces = in_segments(evidence.fit, evidence.segments)
    problem = OutputErrorProblem(hypothesis.model, hypothesis.given, hypothesis.free, pieces, solver, evidence.noise)
    begun, shared = _begin(problem, hypothesis, starts, after, own or {})
    if evidence.segments:  # short already, and begun from what was measured: another model's states lead astray
        begun, horizons = None, horizons and [None] * len(horizons)
    ends = {"enough": enough * evidence.noise**2, "is_over": evidence.is_over, "reach": reach}
    ends["lent"] = None if after is None else lent_from(problem, after)
    fitted = fit(problem, shared, horizons, iterations, begun, kept=kept, **ends)
    values = {name: float(value) for name, value in problem.unknowns.parameters(fitted.shared).items()}
    given = placed(hypothesis.given, values)
    free = tuple(_settled(p, values.get(p.name, p.start)) for p in hypothesis.free)
    gains = {name: value for name, value in values.items() if name.startswith(f"{GAIN}.")}
    settled = replace(hypothesis, free=free, given=given, gains=gains)
    found = _outcome(settled, Fit(problem, fitted, values), evidence)
    if evidence.sealed or not evidence.holdout:
        return found
    from gear_damping.explanation.model.opened import opened  # it needs what is declared here

    found = opened(found, evidence, solver, None if after is None else after.own)
    return replace(found, left_out=found.holdout, scatter=Scatter())


def _begin(
    problem: OutputErrorProblem,
    hypothesis: Hypothesis,
    starts: Tensor | None,
    after: Outcome | None,
    own: Mapping[str, float],
) -> tuple[Tensor | None, Tensor]:
    """Initial states (None: from the records) and coordinates, those of single records among them."""
    if starts is None:
        starts = torch.zeros(1, len(hypothesis.common), dtype=torch.float64)
    begun = None if after is None else begun_from(problem, after, len(starts))
    shared = problem.unknowns.completed(starts)
    if after is not None:
        shared = shared + own_from(problem, after)
    for place, parameter in enumerate(problem.free):
        if parameter.name in own:
            shared[:, place] = parameter.coordinate(own[parameter.name])
    return begun, shared


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
        for whole in [joined(series, evidence.fitted, evidence.segments, len(problem.response.channels))]
    ]
    grown = growth(fitted.prediction, problem.n_shared)
    return Outcome(settled, problem, fitted, found.values, *left, crossed.scatter, grown)


def _fit_in_segments(hypothesis: Hypothesis, evidence: Evidence, starts: Tensor | None, **options: Any) -> Outcome:
    """A fit to segments of the records, with the growth over whole ones.

    Where flanks part, the cost over whole records has many minima; over short segments it has few.
    """
    short = replace(evidence, segments=segments_of(hypothesis, evidence))
    rounds = {"horizons": [None] * 2, "iterations": (ITERATIONS_NEAR, ITERATIONS_NEAR)}
    near = fit_hypothesis(hypothesis, short, starts, **rounds, **options)
    return replace(near, growth=growth_over(near.hypothesis, evidence.fit, options["solver"]))


def growth_over(hypothesis: Hypothesis, records: Sequence[FitRecord], solver: Solver | None) -> float:
    """How much an error of the initial state grows over whole records, in the one where it grows most."""
    problem = OutputErrorProblem(hypothesis.model, hypothesis.given, (), records, solver)
    none = torch.zeros(1, problem.n_shared, dtype=torch.float64)
    return growth(problem.linearise(none, problem.first_states().unsqueeze(0)), problem.n_shared)


def begun_from(problem: OutputErrorProblem, after: Outcome, points: int) -> Tensor:
    """Initial states of several points of a problem, (points, records, local), from a fit to the same records.

    From the records themselves where that fit cut them otherwise.
    """
    if len(after.problem.records) != len(problem.records):
        return problem.first_states().repeat(points, 1, 1)
    return problem.states_of(after.problem, after.fitted.states).repeat(points, 1, 1)


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


def _settled(parameter: FreeParameter, value: float) -> FreeParameter:
    expected = parameter.expected if parameter.expected is not None or not parameter.logarithmic else parameter.start
    return replace(parameter, start=value, expected=expected)


def segments_of(hypothesis: Hypothesis, evidence: Evidence) -> Segments:
    """How records are cut where they cannot be predicted from their start: as the file says, else by time scale."""
    return evidence.stated_segments or Segments(SEGMENT_TIMES * time_scale(hypothesis, evidence))


def time_scale(hypothesis: Hypothesis, evidence: Evidence) -> float:
    """Characteristic time of a model on these records in s."""
    frequency = 2 * torch.pi * natural_frequency_hz(hypothesis.model, hypothesis.given)
    damping = hypothesis.given.get("viscous_damping.damping_coefficient", 0.0)
    mass = hypothesis.model.prepare(hypothesis.model.values(1, **hypothesis.given)).derived["equivalent_mass"]
    return characteristic_time(evidence.records, frequency, float(damping) / float(mass[0]))


def slowest_time(hypothesis: Hypothesis, evidence: Evidence) -> float:
    """The same, or the period of a slower mode that one of its effects adds."""
    natural = natural_frequency_hz(hypothesis.model, hypothesis.given)
    slowest = slowest_frequency_hz(hypothesis.model, hypothesis.given)
    return 1 / slowest if slowest < natural else time_scale(hypothesis, evidence)


def natural_frequency_hz(model: Model, given: Given) -> float:
    """Natural frequency of a model in Hz."""
    derived = model.prepare(model.values(1, **given)).derived
    return float(derived["natural_frequency"][0]) / (2 * torch.pi)


def slowest_frequency_hz(model: Model, given: Given) -> float:
    """Natural frequency of a model in Hz, or that of a slower mode which one of its effects adds."""
    prepared = model.prepare(model.values(1, **given))
    rates = [float(term["slowest_rate"][0]) for term in prepared.terms.values() if "slowest_rate" in term]
    added = [rate / (2 * torch.pi * float(prepared.scales.time[0])) for rate in rates]
    return min([natural_frequency_hz(model, given), *added])
