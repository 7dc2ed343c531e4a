"""Whether the size of a cause is told from none: of one that is there, of one that is not, of one that stands in."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.evidence.excess import Excess
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.covariance import covariance_of
from gear_damping.explanation.model.fitting import fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import Accepted, State
from gear_damping.explanation.steps.told import is_told
from gear_damping.explanation.steps.told import told as told_of
from gear_damping.explanation.trials.told_size import without_a_figure
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.effects.coulomb_friction import CoulombFriction
from gear_damping.physics.effects.second_mode import SecondMode
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.simulate import simulate

RATE, SAMPLES, NOISE = 50.0, 600, 0.01
DAMPING = "viscous_damping.damping_coefficient"


def fitted(cubic, extra):
    """An oscillator with this much cubic stiffness, fitted with the extra parameters free."""
    names = dict.fromkeys(["viscous_damping", "cubic_stiffness", *(name.partition(".")[0] for name in extra)])
    effects = [effect_class(name)() for name in names]
    model = Model(Oscillator(), effects)
    truth = {"stiffness": 40.0, DAMPING: 0.3, "cubic_stiffness.coefficient": cubic, "initial_displacement": 1.0}
    given = dict.fromkeys(extra, 0.0) | truth
    clean = simulate(model, model.values(1, **given), sampling_rate=RATE, n_samples=SAMPLES).response[0]
    response = clean + NOISE * torch.randn(SAMPLES, generator=torch.Generator().manual_seed(3)).double()
    records = (FitRecord("a", response, RATE),)
    evidence = Evidence("oscillator", records, records, {"stiffness": 40.0}, None, one_record=True, noise=NOISE)
    free = [FreeParameter("stiffness", 40.0, logarithmic=True), FreeParameter(DAMPING, 0.3, logarithmic=True)]
    own = [FreeParameter(name, 0.0, 1.0) for name in extra]
    known = {k: v for k, v in given.items() if not k.startswith("initial")} | {"cubic_stiffness.coefficient": 0.0}
    return fit_hypothesis(Hypothesis(Oscillator(), tuple(effects), known, (*free, *own)), evidence), own, evidence


def told(cubic, extra=("cubic_stiffness.coefficient",)):
    outcome, own, evidence = fitted(cubic, extra)
    candidate = SimpleNamespace(non_nested=False, strengths=range(len(own)), hypothesis=SimpleNamespace(common=own))
    refit = SimpleNamespace(score=SimpleNamespace(candidate=candidate), name=extra[0].partition(".")[0])
    return is_told(outcome, refit, evidence)


@pytest.mark.parametrize(("cubic", "expected"), [(4.0, True), (-4.0, True), (0.0, False)])
def test_what_is_there_is_told_and_what_is_not_is_not(cubic, expected):
    assert told(cubic) is expected


@pytest.mark.parametrize(("cubic", "expected"), [(4.0, False), (0.0, True)])
def test_a_cause_of_which_no_figure_is_known_within_itself_is_any(cubic, expected):
    outcome, _, evidence = fitted(cubic, ("cubic_stiffness.coefficient",))
    known = covariance_of(outcome, evidence)
    assert without_a_figure(outcome, ["cubic_stiffness"], known, evidence) == ("cubic_stiffness" if expected else "")
    assert without_a_figure(outcome, ["backlash"], known, evidence) == ""  # without figures there is nothing to know


def outcome_of(parameters, moved=1e3):
    """A fit that stands at 0, of which every parameter moves a record of four samples as much."""
    sensitivity = torch.full((1, 1, 4, len(parameters)), moved * NOISE, dtype=torch.float64)
    prediction = SimpleNamespace(sensitivity=sensitivity)
    fitted = SimpleNamespace(shared=torch.zeros(len(parameters)).double(), prediction=prediction)
    return SimpleNamespace(problem=SimpleNamespace(free=parameters), fitted=fitted)


@pytest.mark.parametrize(("moved", "expected"), [(1e3, "backlash"), (0.0, "")])
def test_a_size_that_moves_nothing_bends_to_nothing(moved, expected):
    """A gap that flanks part in without ever touching its far side: it is there, however wide it is."""
    outcome = outcome_of([FreeParameter("backlash.gap", 1e-4, logarithmic=True)], moved)
    covariances = torch.full((1, 1), 1e4, dtype=torch.float64)
    assert without_a_figure(outcome, ["backlash"], covariances, SimpleNamespace(noise=NOISE)) == expected


@pytest.mark.parametrize(("phases", "expected"), [((), ""), (("profile_error.phases[0]",), "profile_error")])
def test_from_where_an_angle_counts_is_no_size(phases, expected):
    size, angle = FreeParameter("profile_error.amplitudes[0]", 1e-8), FreeParameter("profile_error.phases[0]", 1.5)
    known, evidence = torch.diag(torch.tensor([1.0, 0.1], dtype=torch.float64)), SimpleNamespace(noise=NOISE)
    assert without_a_figure(outcome_of([size, angle]), ["profile_error"], known, evidence, phases) == expected


@pytest.mark.parametrize(("scatter", "expected"), [(1.0, ""), (1e4, "profile_error")])
def test_a_figure_is_known_as_well_as_it_is_said_to_be(scatter, expected):
    size = FreeParameter("profile_error.amplitudes[0]", 1.0)
    known = scatter * torch.full((1, 1), 0.04, dtype=torch.float64)
    assert without_a_figure(outcome_of([size]), ["profile_error"], known, SimpleNamespace(noise=NOISE)) == expected


def test_what_the_viscous_damping_does_already_is_told_of_no_other_law():
    extra = ("asymmetric_friction.damping_forward", "asymmetric_friction.damping_backward")
    assert not told(0.0, extra)


@pytest.mark.parametrize(("moved", "half", "expected"), [(1e3, 0.2, True), (1e3, 4.0, False), (0.0, 4.0, True)])
def test_what_is_tried_as_a_whole_needs_a_size_where_the_size_does_something(moved, half, expected, monkeypatch):
    """A mass within a factor; one of which nothing is known; a gap whose far flank is never touched."""
    parameter = FreeParameter("second_mode.mass_ratio", 0.01, logarithmic=True)
    sensitivity = torch.full((1, 1, 4, 3), moved * NOISE / 2, dtype=torch.float64)
    outcome = SimpleNamespace(
        problem=SimpleNamespace(free=[parameter]),
        fitted=SimpleNamespace(shared=torch.zeros(1), prediction=SimpleNamespace(sensitivity=sensitivity)),
    )
    covariances = torch.full((1, 1), (half / 1.96) ** 2, dtype=torch.float64)
    monkeypatch.setattr("gear_damping.explanation.trials.told_size.covariance_of", lambda *_: covariances)
    common = SimpleNamespace(common=[parameter])
    candidate = SimpleNamespace(non_nested=True, strengths=[0], hypothesis=common, replaced=())
    refit = SimpleNamespace(score=SimpleNamespace(candidate=candidate), name="second_mode")
    assert is_told(outcome, refit, SimpleNamespace(noise=NOISE)) is expected


@pytest.mark.parametrize(("moved", "half", "expected"), [(1e3, 0.2, True), (1e3, 4.0, False), (0.0, 0.2, False)])
def test_what_took_the_place_of_a_spring_needs_a_shape_of_its_own(moved, half, expected, monkeypatch):
    """A pendulum whose length is known; one of any length; one whose length does nothing: a spring again."""
    free = [FreeParameter(f"sine_restoring.{name}", 1.0, logarithmic=True) for name in ("stiffness", "length")]
    sensitivity = torch.full((1, 1, 4, 4), 1e3 * NOISE, dtype=torch.float64)
    sensitivity[..., 1] = moved * NOISE / 2
    outcome = SimpleNamespace(
        problem=SimpleNamespace(free=free),
        fitted=SimpleNamespace(shared=torch.zeros(2), prediction=SimpleNamespace(sensitivity=sensitivity)),
    )
    covariances = torch.diag(torch.tensor([1e-4, (half / 1.96) ** 2], dtype=torch.float64))
    monkeypatch.setattr("gear_damping.explanation.trials.told_size.covariance_of", lambda *_: covariances)
    candidate = SimpleNamespace(
        non_nested=True, strengths=[0], hypothesis=SimpleNamespace(common=free), replaced=("stiffness",)
    )
    refit = SimpleNamespace(score=SimpleNamespace(candidate=candidate), name="sine_restoring")
    assert is_told(outcome, refit, SimpleNamespace(noise=NOISE)) is expected


def test_a_cause_beside_which_small_changes_run_away_is_dropped():
    outcome, _, evidence = fitted(4.0, ("cubic_stiffness.coefficient",))
    broken = replace(outcome.fitted.prediction, sensitivity=outcome.fitted.prediction.sensitivity * math.nan)
    astray = replace(outcome, fitted=replace(outcome.fitted, prediction=broken))
    assert outcome.is_finite
    assert not astray.is_finite
    said, refit = [], SimpleNamespace(name="cubic_stiffness")
    bench = SimpleNamespace(evidence=evidence, log=said.append, without=lambda *_: outcome)
    state = State(bench, outcome, astray, accepted=(Accepted("cubic_stiffness", refit, 0.5, ()),))
    assert told_of(state).accepted == ()
    assert "its size is not told from none" in said[0]


def excess_of(percent):
    return Excess(percent, threshold=0.01, chance=0.002, misfit=1 + percent, per_record={})


def bench_leaving(left, as_good):
    """A made-up bench, the nominal model, one that leaves this much of an excess of 1 %, and one without a cause."""
    nominal, outcome, without = (SimpleNamespace(is_finite=True, left_out_cost=1.0) for _ in range(3))
    bench = SimpleNamespace(
        evidence=SimpleNamespace(duration=10.0, fit=[None]),
        settings=SearchSettings(),
        log=lambda text: None,
        without=lambda *_: without,
        is_as_good=lambda *_: as_good,
        excess=lambda one: excess_of(1.0 if one is nominal else left),
    )
    return bench, nominal, outcome, without


def made_up(whole, effect=None):
    """A fit of a candidate that is tried as a whole, or not."""
    effects = SimpleNamespace(effects=(effect or CoulombFriction(),))
    score = SimpleNamespace(candidate=SimpleNamespace(non_nested=whole, hypothesis=effects))
    return SimpleNamespace(score=score, outcome=SimpleNamespace(hypothesis=effects), name="made up")


@pytest.mark.parametrize(
    ("left", "as_good", "whole", "kept"),
    [(0.001, False, False, True), (0.5, False, False, False), (0.001, True, False, False), (0.001, False, True, False)],
)
def test_what_explains_all_and_is_missed_is_there_whatever_its_size(left, as_good, whole, kept, monkeypatch):
    """A strength that trades against another parameter has no size of its own. left: of an excess of 1 %.

    Of what is tried as a whole, one that is not known is no cause.
    """
    monkeypatch.setattr("gear_damping.explanation.steps.told.is_told", lambda *_: False)
    monkeypatch.setattr(Accepted, "effect", CoulombFriction())
    bench, nominal, outcome, without = bench_leaving(left, as_good)
    refit = made_up(whole)
    state = State(bench, nominal, outcome, (Accepted("a", refit, 0.5, ()),))
    found = told_of(state)
    assert bool(found.accepted) is kept
    assert found.outcome is (outcome if kept else without)


@pytest.mark.parametrize("order", ["abc", "bca", "cab"])
def test_of_causes_that_trade_against_each_other_the_least_needed_goes_first(order, monkeypatch):
    """Three without a size of their own; without `b` most is left, and beside it alone its size is told."""
    costs = {"a": 2.0, "b": 5.0, "c": 1.0}  # of left-out records without each
    monkeypatch.setattr("gear_damping.explanation.steps.told.is_told", lambda outcome, *_: outcome.alone)
    monkeypatch.setattr(Accepted, "effect", CoulombFriction())
    whole = SimpleNamespace(is_finite=True, left_out_cost=0.5, alone=False, causes=frozenset("abc"))

    def without(outcome, name):
        kept = outcome.causes - {name}
        return SimpleNamespace(is_finite=True, left_out_cost=costs[name], alone=len(kept) == 1, causes=kept)

    bench = SimpleNamespace(evidence=None, settings=SearchSettings(), log=lambda text: None, without=without)
    bench.excess = lambda outcome: SimpleNamespace(percent=1.0)
    refit = made_up(True)
    state = State(bench, None, whole, tuple(Accepted(name, refit, 0.5, ()) for name in order))
    found = told_of(state)
    assert [cause.name for cause in found.accepted] == ["b"]
    assert found.unsized == {"a", "c"}


@pytest.mark.parametrize(
    ("share", "others", "as_good", "whole", "kept"),
    [
        (0.8, 0, False, False, True),
        (0.45, 0, False, False, False),  # as much is another's
        (0.8, 1, False, False, True),  # of two that bend to each other, one
        (0.8, 0, True, False, False),  # not missed
        (0.8, 0, False, True, False),  # an absorber of any mass
    ],
)
def test_what_is_alone_and_takes_most_is_there_whatever_it_leaves(share, others, as_good, whole, kept, monkeypatch):
    """A relief of the tips of another form: a rest of a fifth that hangs together is no reason against it."""
    monkeypatch.setattr("gear_damping.explanation.steps.told.is_told", lambda *_: False)
    monkeypatch.setattr(Accepted, "effect", CoulombFriction())
    bench, nominal, outcome, _ = bench_leaving(0.3, as_good)
    refit = made_up(whole)
    accepted = tuple(Accepted(name, refit, share, ()) for name in ["a", "b"][: 1 + others])
    assert len(told_of(State(bench, nominal, outcome, accepted)).accepted) == (1 if kept else 0)


@pytest.mark.parametrize(("mass_ratio", "swells", "kept"), [(0.0016, 1, True), (0.0001, 1, False), (0.0016, 0, False)])
def test_a_mode_that_gives_back_what_it_took_is_there_whatever_its_size(mass_ratio, swells, kept, monkeypatch):
    """Two poles tell four figures of five; a beat of 5 s within records of 10 s is nothing that a line does."""
    monkeypatch.setattr("gear_damping.explanation.steps.told.is_told", lambda *_: False)
    monkeypatch.setattr("gear_damping.explanation.model.gives_back.natural_frequency_hz", lambda *_: 5.0)
    monkeypatch.setattr("gear_damping.explanation.model.gives_back.swells_again", lambda *_: bool(swells))
    bench, nominal, outcome, _ = bench_leaving(0.3, as_good=False)
    values = {"frequency": 5.0, "mass_ratio": mass_ratio, "damping_ratio": 0.0}
    outcome.values_of, outcome.flat_given = lambda name: values, lambda: {}
    outcome.hypothesis = SimpleNamespace(model=None)
    refit = made_up(True, SecondMode())
    state = State(bench, nominal, outcome, (Accepted("second_mode", refit, 0.8, ()),))
    assert bool(told_of(state).accepted) == kept


@pytest.mark.parametrize(
    ("share", "others", "at_bound", "kept"),
    [(0.04, 1, True, False), (0.04, 1, False, True), (0.4, 1, True, True), (0.04, 0, True, True)],
)
def test_what_takes_little_at_a_bound_beside_others_is_dropped(share, others, at_bound, kept, monkeypatch):
    """A friction as wide as half the motion, which takes a twenty-fifth of what was missing."""
    monkeypatch.setattr("gear_damping.explanation.steps.told.is_told", lambda *_: True)
    monkeypatch.setattr(Accepted, "runs_into_bound", lambda cause, _: at_bound and cause.name == "b")
    monkeypatch.setattr("gear_damping.explanation.steps.told._of_no_figure", lambda state: None)
    bench, nominal, outcome, without = bench_leaving(0.3, as_good=False)
    accepted = (
        *(Accepted("a", made_up(False), 0.7, ()) for _ in range(others)),
        Accepted("b", made_up(False), share, ()),
    )
    found = told_of(State(bench, nominal, outcome, accepted))
    assert ("b" in {cause.name for cause in found.accepted}) is kept
    assert found.outcome is (outcome if kept else without)
    assert found.unsized == (frozenset() if kept else {"b"})


@pytest.mark.parametrize(
    ("left", "scatter", "others", "kept"),
    [(0.5, 1.0, 1, True), (0.5, 1e4, 1, False), (0.001, 1e4, 1, True), (0.5, 1e4, 0, True)],
)
def test_a_law_of_no_figure_beside_others_gives_its_place_to_another_one(left, scatter, others, kept, monkeypatch):
    """As no verdict would name it. Where nothing is left, records need not agree; what is alone stays."""
    covariances = scatter * torch.full((1, 1), 0.04, dtype=torch.float64)
    monkeypatch.setattr("gear_damping.explanation.steps.told.is_told", lambda *_: True)
    monkeypatch.setattr("gear_damping.explanation.state.covariance_of", lambda *_: covariances / scatter)
    monkeypatch.setattr("gear_damping.explanation.state.wider_of_both", lambda *_: covariances)
    monkeypatch.setattr(Accepted, "runs_into_bound", lambda *_: False)
    bench, nominal, outcome, _ = bench_leaving(left, as_good=False)
    bench.evidence.noise = NOISE
    outcome.hypothesis = SimpleNamespace(effects=())
    seen = outcome_of([FreeParameter("b.coefficient", 1.0)])
    outcome.problem, outcome.fitted = seen.problem, seen.fitted
    refit = made_up(False)
    refit.score.candidate.names_of_phases = set()
    accepted = tuple(Accepted(name, refit, 0.4, ()) for name in ["a", "b"][1 - others :])
    found = told_of(State(bench, nominal, outcome, accepted))
    assert ("b" in {cause.name for cause in found.accepted}) is kept
    assert found.unsized == (frozenset() if kept else {"b"})
