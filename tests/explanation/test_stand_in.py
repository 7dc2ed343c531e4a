"""A cause that stands in for a force at some frequency, and one that is there beside it; motions by scipy."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp

from gear_damping.explanation.answer.stand_in import (
    StandIn,
    beyond_chance,
    is_untold,
    line_left,
    shape_without_name,
    stand_ins,
)
from gear_damping.explanation.budget import Budget
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.fitting import fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import Accepted, State
from gear_damping.explanation.trials.assess import assessed
from gear_damping.explanation.trials.line import strongest_line
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.identification.output_error.segments import Segments
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.systems.oscillator import Oscillator

RATE, SAMPLES, NOISE = 50.0, 400, 0.003
STIFFNESS, DAMPING, FREQUENCY = 40.0, 0.3, 1.37
COEFFICIENT, CUBIC = "viscous_damping.damping_coefficient", "cubic_stiffness.coefficient"
KINDS, WAYS = ("force", "damping"), ("forward", "backward")
FRICTION = tuple(f"asymmetric_friction.{kind}_{way}" for kind in KINDS for way in WAYS)


def moved(start, cubic, force, phase):
    """Displacement of a decay under a force that no channel shows."""

    def rates(t, y):
        pushed = force * math.cos(2 * math.pi * FREQUENCY * t + phase)
        return [y[1], pushed - DAMPING * y[1] - STIFFNESS * y[0] - cubic * y[0] ** 3]

    time = np.arange(SAMPLES) / RATE
    return solve_ivp(rates, (0, time[-1]), [start, 0.0], t_eval=time, rtol=1e-9, atol=1e-11).y[0]


def searched(cubic, force, count=3, law=(CUBIC,), settings=None):
    """The state of a search that has accepted a law with these parameters."""
    random = np.random.default_rng(5)
    runs = [moved(start, cubic, force, phase) for start, phase in ((1.0, 0.3), (0.7, 2.0), (1.2, 4.0))]
    noisy = [torch.as_tensor(run + NOISE * random.normal(size=SAMPLES)) for run in runs]
    records = tuple(FitRecord(name, one, RATE) for name, one in zip("abc", noisy[:count], strict=False))
    evidence = Evidence(
        "oscillator", records, records[:1], {"stiffness": STIFFNESS}, None, one_record=False, noise=NOISE
    )
    linear = [
        FreeParameter("stiffness", STIFFNESS, logarithmic=True),
        FreeParameter(COEFFICIENT, 0.3, logarithmic=True),
    ]
    known = {"stiffness": STIFFNESS, COEFFICIENT: DAMPING}
    name = law[0].partition(".")[0]
    laws = [effect_class(one)() for one in ("viscous_damping", name)]
    free = [FreeParameter(one, 0.0, 1.0) for one in law]
    nominal = fit_hypothesis(Hypothesis(Oscillator(), (laws[0],), known, tuple(linear)), evidence)
    extended = Hypothesis(Oscillator(), tuple(laws), known | dict.fromkeys(law, 0.0), (*linear, *free))
    outcome = fit_hypothesis(extended, evidence)
    budget = SimpleNamespace(refuses=lambda name: False)
    noise_cost = lambda outcome: NOISE**2 * float(outcome.problem.response.weights.numel())  # noqa: E731
    bench = SimpleNamespace(
        evidence=evidence, settings=settings or SearchSettings(), budget=budget, noise_cost=noise_cost
    )
    accepted = (Accepted(name, SimpleNamespace(outcome=outcome), 0.5, ()),)
    return State(bench, nominal, outcome, accepted, left=SimpleNamespace(visible=True))


@pytest.fixture(scope="module")
def forced():
    return searched(cubic=0.0, force=1.5)


def test_a_law_in_the_place_of_a_force_stands_in_for_it(forced):
    (found,) = stand_ins(forced)
    assert found.cause == "cubic_stiffness"
    assert found.alternative.startswith("a line at 1.3") or found.alternative.startswith("a line at 1.4")
    assert found.takes > 0.9 > found.cause_takes
    assert "times the size" in found.why
    assert found.alternative in found.sentence


@pytest.mark.parametrize(("records", "numbers"), [(1, 3), (3, 7)])
def test_what_takes_less_with_more_numbers_explains_nothing(records, numbers):
    """Four numbers of a friction against two of a line for each record and its place; whatever the sizes say."""
    found = stand_ins(searched(0.0, 1.5, records, FRICTION, SearchSettings(homogeneity_level=1e-300)))
    assert [one.why for one in found] == (["with 3 numbers in the place of 4"] if numbers < 4 else [])


def test_what_takes_less_than_a_cause_must_is_stood_in_for_by_none(forced):
    """The force takes nearly all, and is not what is missing where a cause has to take all but noise."""
    state = searched(0.0, 1.5, settings=SearchSettings(taken_by_one=1.0))
    state.bench.noise_cost = lambda outcome: 0.0
    assert not list(stand_ins(state))


def test_what_there_is_no_time_to_ask_is_noted(forced):
    state, budget = forced, Budget(1.0)
    budget.clock = lambda: math.inf
    friction = replace(state.accepted[0], name="coulomb_friction")
    late = replace(state, bench=SimpleNamespace(**vars(state.bench) | {"budget": budget}))
    assert list(stand_ins(late))  # of a single cause it takes no fit
    assert not is_untold(late)
    late = replace(late, accepted=(*state.accepted, friction))
    assert not list(stand_ins(late))
    assert is_untold(late)


def test_where_the_time_is_over_a_model_that_the_search_fitted_on_its_way_is_asked(forced):
    """Of two causes the one alone was fitted before the other was added: no further fit is needed to tell."""
    state, budget = forced, Budget(1.0)
    budget.clock = lambda: math.inf
    name, other = state.accepted[0].name, "coulomb_friction"
    known = replace(state.nominal, hypothesis=replace(state.nominal.hypothesis, causes=(other,)))
    late = replace(
        state,
        bench=SimpleNamespace(**vars(state.bench) | {"budget": budget}),
        accepted=(*state.accepted, replace(state.accepted[0], name=other)),
        first_fits=(SimpleNamespace(outcome=known),),
    )
    assert [one.cause for one in stand_ins(late)] == [name]
    assert budget.not_tried == [f"whether {other} stands in for something else"]


def test_where_nothing_is_left_nobody_asks(forced):
    seen = SimpleNamespace(visible=False)
    assert not list(stand_ins(State(forced.bench, forced.nominal, forced.outcome, forced.accepted, left=seen)))


@pytest.mark.parametrize(("cubic", "force"), [(4.0, 0.02), (4.0, 0.1), (1.0, 1.5), (0.5, 1.5)])
def test_a_law_that_is_there_keeps_its_size_beside_a_force(cubic, force):
    """Whether this takes less than the law or more."""
    assert not list(stand_ins(searched(cubic, force)))


def test_the_line_is_the_one_that_was_hidden(forced):
    line = strongest_line(forced.nominal, forced.bench.evidence)
    assert line.unit == "Hz"
    assert line.hertz == pytest.approx(line.place)
    assert line.place == pytest.approx(FREQUENCY, abs=0.25 * RATE / SAMPLES)
    assert line.share > 0.9


def test_what_is_visible_without_a_name_is_told_by_its_place(forced):
    seen = assessed(forced.nominal, [], forced.bench.evidence)
    found = State(forced.bench, forced.nominal, forced.nominal, seen=seen)
    assert shape_without_name(found).startswith("a line at 1.3")


def test_a_line_that_is_most_of_what_causes_leave_is_told(forced):
    seen = assessed(forced.nominal, [], forced.bench.evidence)
    beside = State(forced.bench, forced.nominal, forced.nominal, forced.accepted, left=seen)
    assert line_left(beside).startswith("Of what is left, 9")
    assert "is a line at 1.3" in line_left(beside)
    assert not line_left(replace(beside, accepted=()))  # said by the verdict itself
    assert not line_left(replace(beside, left=None))


def test_nothing_is_told_of_noise():
    quiet = searched(cubic=0.0, force=0.0)
    seen = assessed(quiet.nominal, [], quiet.bench.evidence)
    assert not seen.visible
    assert not shape_without_name(State(quiet.bench, quiet.nominal, quiet.nominal, seen=seen))
    cause = SimpleNamespace(name="cubic_stiffness")
    assert not line_left(State(quiet.bench, quiet.nominal, quiet.nominal, (cause,), left=seen))


@pytest.mark.parametrize("samples", [50, 80])
def test_a_record_that_is_too_short_for_a_line_has_none_there(forced, samples):
    """One and two cycles of 1.37 Hz, and of 1.01 Hz, the motion's own."""
    evidence = forced.bench.evidence
    short = tuple(replace(record, response=record.response[:samples]) for record in evidence.fit)
    evidence = replace(evidence, fit=short, holdout=short[:1])
    outcome = fit_hypothesis(forced.nominal.hypothesis, evidence)
    assert outcome.problem.records[0].response.numel() == samples
    line, width = strongest_line(outcome, evidence), RATE / samples
    assert line.place > 1.7 * width
    assert abs(line.place - STIFFNESS**0.5 / (2 * math.pi)) > 1.2 * width


def test_segments_have_no_line_of_their_own(forced):
    cut = replace(forced.bench.evidence, segments=Segments(2.0))
    assert strongest_line(fit_hypothesis(forced.nominal.hypothesis, cut), cut) is None


@pytest.mark.parametrize(("numbers", "blocks"), [(1, 30), (9, 60), (24, 400)])
def test_numbers_that_mean_nothing_take_nothing_beyond_chance(numbers, blocks):
    """Regressions of noise on columns of noise: the mean share that they take is no more than chance."""
    random = np.random.default_rng(numbers)
    shares = []
    for _ in range(200):
        columns, residual = random.normal(size=(blocks, numbers)), random.normal(size=blocks)
        columns, residual = columns - columns.mean(0), residual - residual.mean()
        left = residual - columns @ np.linalg.lstsq(columns, residual, rcond=None)[0]
        shares.append(beyond_chance(1 - left @ left / (residual @ residual), numbers, blocks))
    assert abs(np.mean(shares)) < 4 * np.std(shares) / 200**0.5


def test_as_many_numbers_as_blocks_tell_nothing():
    assert beyond_chance(0.99, 24, 9.0) == 0.0


@pytest.mark.parametrize(
    ("every", "misfit", "told"),
    [(40, 5.0, True), (40, 2.0, False), (0, 5.0, False), (400, 5.0, False)],
)
def test_bursts_all_along_the_records_are_told_where_they_are_more_than_the_sensor_s_noise(every, misfit, told):
    """Shocks of a damaged bearing passed for coloured noise. One transient, as a decay leaves it, is no series."""
    rng = np.random.default_rng(7)
    left = 0.2 * rng.standard_normal(4000)
    for place in range(20, len(left) - 20, every) if every in (40,) else [20] * bool(every):
        left[place : place + 8] += rng.choice([-3, 3]) * np.exp(-np.arange(8) / 2.0)
    nominal = SimpleNamespace(fit_residuals=[torch.tensor(left)])
    beyond = SimpleNamespace(misfit=misfit, percent=0.2)
    bench = SimpleNamespace(settings=SearchSettings())
    noise = SimpleNamespace(correlation=1.0)
    state = SimpleNamespace(nominal=nominal, bench=bench, noise=noise, beyond_sensor=lambda _: beyond, seen=None)
    assert shape_without_name(state).startswith("bursts") is told


@pytest.mark.parametrize(("takes", "said"), [(0.97, "takes about as much (97 %"), (0.99, "takes more (99 %")])
def test_what_takes_as_much_with_fewer_numbers_is_not_said_to_take_more(takes, said):
    assert said in StandIn("hysteretic_damping", "a line at 3 Hz", takes, 0.98, "with 2 numbers for 3").sentence
