"""Where a descent with secant updates ends, what it costs, and what its sensitivities are worth."""

import math

import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares as scipy_least_squares

from gear_damping.identification.output_error import descent as descent_module
from gear_damping.identification.output_error.descent import Descent, Ends, Lent
from gear_damping.identification.output_error.least_squares import Rounds, fit
from gear_damping.identification.output_error.normal_equations import normal_equations
from gear_damping.identification.output_error.problem import OutputErrorProblem, Prediction
from gear_damping.identification.output_error.records import FitRecord, FreeParameter, Observed
from gear_damping.identification.output_error.step import Points
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator

STIFFNESS, DAMPING, CUBIC = (2 * math.pi * 10) ** 2, 4.0, 3e5
COEFFICIENT = "viscous_damping.damping_coefficient"
MODEL = Model(Oscillator(), [effect_class("viscous_damping")(), effect_class("cubic_stiffness")()])
DESCENT = "gear_damping.identification.output_error.descent"
RATE, SAMPLES, NOISE = 500.0, 300, 1e-3
FREE = [
    FreeParameter("stiffness", STIFFNESS * 1.05, logarithmic=True),
    FreeParameter(COEFFICIENT, DAMPING * 1.5, logarithmic=True),
    FreeParameter("cubic_stiffness.coefficient", 0.0, scale=CUBIC),
]


def decay(name, damping, seed):
    """A noisy free decay of a mass of 1 kg, by scipy."""

    def rates(_, state):
        x, v = state
        return v, -damping * v - STIFFNESS * x - CUBIC * x**3

    times = np.arange(SAMPLES) / RATE
    found = solve_ivp(rates, (0, times[-1]), (0.05, 0.0), t_eval=times, rtol=1e-9, atol=1e-12).y[0]
    noisy = found + NOISE * np.random.default_rng(seed).standard_normal(SAMPLES)
    return FitRecord(name, torch.tensor(noisy), RATE)


def decay_by_power(name, seed):
    """A noisy free decay under c |v|^2.4 sign(v), by scipy."""

    def rates(_, state):
        x, v = state
        return v, -0.4 * v - STIFFNESS * x - 1300.0 * np.sign(v) * abs(v) ** 2.4

    times = np.arange(SAMPLES) / RATE
    found = solve_ivp(rates, (0, times[-1]), (5e-4, 0.0), t_eval=times, rtol=1e-9, atol=1e-12).y[0]
    noisy = found + 1e-2 * NOISE * np.random.default_rng(seed).standard_normal(SAMPLES)
    return FitRecord(name, torch.tensor(noisy), RATE)


def problem_of():
    records = [decay("first", DAMPING, 0), decay("second", 1.1 * DAMPING, 1)]
    return OutputErrorProblem(MODEL, {"amplitude": 0.05}, FREE, records)


@pytest.fixture(autouse=True)
def every_problem_counts_as_large(monkeypatch):
    monkeypatch.setattr(DESCENT + ".AT_ONCE", 0.0)


def begun(problem, starts=1, at_once=False, lent=None, **ends):
    shared = torch.zeros(starts, problem.n_shared, dtype=torch.float64)
    shared[1:, :3] += 0.05
    states = problem.first_states().expand(starts, -1, -1)
    descent = Descent(problem, Points(shared, states), None, Ends(**ends), lent)
    descent.at_once = at_once
    return descent


def by_scipy(problem):
    """The same minimum, from another method that works its slopes out anew at every step."""
    shape = len(problem.records), len(problem.local)

    def residual(z):
        shared = torch.tensor(z[: problem.n_shared]).unsqueeze(0)
        states = torch.tensor(z[problem.n_shared :]).reshape(1, *shape)
        return problem.residuals(shared, states).flatten().numpy()

    first = np.concatenate([np.zeros(problem.n_shared), problem.first_states().flatten().numpy()])
    return scipy_least_squares(residual, first, x_scale="jac", xtol=1e-12, ftol=1e-14, gtol=1e-12)


@pytest.mark.parametrize("at_once", [True, False])
def test_it_ends_where_another_method_does_with_fewer_linearisations_than_steps(at_once):
    problem = problem_of()
    descent, other = begun(problem, at_once=at_once), by_scipy(problem)
    trials, advance = [], descent._advance
    descent._advance = lambda left: (trials.append(1), advance(left))
    descent.run(40)
    assert bool(descent.converged[0])
    assert float(descent.cost[0]) == pytest.approx(2 * other.cost, rel=1e-9)
    assert descent.points.shared[0].numpy() == pytest.approx(other.x[: problem.n_shared], rel=1e-4, abs=1e-6)
    assert int(descent.made[0]) == len(trials) if at_once else int(descent.made[0]) < 0.6 * len(trials)


def test_when_time_is_over_a_few_steps_are_all():
    problem = problem_of()
    whole, cut = begun(problem), begun(problem, is_over=lambda: True)
    trials, advance = [], cut._advance
    cut._advance = lambda left: (trials.append(1), advance(left))
    cut.run(40)
    whole.run(40)
    assert 1 <= len(trials) <= 3
    assert not bool(cut.converged[0])
    assert float(cut.cost[0]) > float(whole.cost[0])
    there = problem.linearise(cut.points.shared, cut.points.states)
    assert torch.allclose(cut.linearised.residual, there.residual, rtol=1e-9, atol=1e-12)


def test_every_start_goes_down_by_itself():
    problem = problem_of()
    both = begun(problem, 2)
    both.run(40)
    alone = begun(problem)
    alone.run(40)
    assert bool(both.converged.all())
    assert both.points.shared[0].numpy() == pytest.approx(alone.points.shared[0].numpy(), rel=1e-6)
    assert both.cost.numpy() == pytest.approx([float(alone.cost[0])] * 2, rel=1e-7)


@pytest.mark.parametrize("iterations", [2, 40])
def test_the_sensitivities_at_the_end_are_those_of_the_point(iterations):
    problem = problem_of()
    descent = begun(problem)
    descent.run(iterations)
    there = problem.linearise(descent.points.shared, descent.points.states)
    assert bool(descent.converged[0]) == (iterations == 40)
    assert torch.allclose(descent.linearised.residual, there.residual, rtol=1e-9, atol=1e-12)
    off = (descent.linearised.sensitivity - there.sensitivity).flatten(0, 2).norm(dim=0)
    assert bool((off < 1e-3 * there.sensitivity.flatten(0, 2).norm(dim=0)).all())


def test_sensitivities_that_lead_astray_are_made_anew():
    descent = begun(problem_of())
    descent.linearised.sensitivity[..., 0] *= -1.0
    descent.carried[:] = 1
    descent.run(40)
    right = begun(problem_of())
    right.run(40)
    assert bool(descent.converged[0])
    assert float(descent.cost[0]) == pytest.approx(float(right.cost[0]), rel=1e-7)


def test_a_secant_update_says_what_the_step_has_shown_and_keeps_every_other_direction():
    problem = problem_of()
    descent = begun(problem)
    old = descent.linearised.sensitivity.clone()
    moves = torch.zeros(1, 2, old.shape[-1], dtype=torch.float64)
    moves[:, 0, :2], moves[:, 1, 1] = torch.tensor([0.02, -0.01]), 0.03
    missed = torch.randn(1, 2, old.shape[2], dtype=torch.float64, generator=torch.Generator().manual_seed(3))
    descent._carry(torch.tensor([0]), missed, moves)
    change = descent.linearised.sensitivity - old
    shown = torch.einsum("srtc,src->srt", change, moves)
    assert torch.allclose(shown, missed, atol=1e-12)
    assert not bool(change[0, 1][:, 0].any())  # no step of the second record in its first column
    across = torch.zeros(old.shape[-1], dtype=torch.float64)
    sizes = old[0, 0].square().sum(0)
    across[0], across[1] = 1 / (sizes[0] * 0.02), 1 / (sizes[1] * 0.01)  # at right angles, as the columns weigh it
    assert float((change[0, 0] @ across).norm()) < 1e-9 * float(change[0, 0].norm() * across.norm())


def lent_by(problem, places, factor=1.0):
    columns = begun(problem).linearised.sensitivity[0][..., places]
    return Lent(places, factor * columns)


@pytest.mark.parametrize("factor", [1.0, 0.7, -1.0])
def test_with_lent_sensitivities_it_ends_where_it_does_with_its_own(factor):
    problem = problem_of()
    borrowing, own = begun(problem, lent=lent_by(problem, [0, 2], factor)), begun(problem)
    borrowing.run(40)
    own.run(40)
    assert bool(borrowing.converged[0])
    assert float(borrowing.cost[0]) == pytest.approx(float(own.cost[0]), rel=1e-7)
    there = problem.linearise(borrowing.points.shared, borrowing.points.states)
    off = (borrowing.linearised.sensitivity - there.sensitivity).flatten(0, 2).norm(dim=0)
    assert bool((off < 1e-3 * there.sensitivity.flatten(0, 2).norm(dim=0)).all())


def test_what_is_lent_is_not_worked_out_until_it_is_given_back():
    problem = problem_of()
    asked, linearise = [], problem.linearise
    problem.linearise = lambda *args, **named: (asked.append(args[3]), linearise(*args, **named))[1]
    descent = begun(problem, lent=Lent([0, 2], linearise(*start_of(problem)).sensitivity[0][..., [0, 2]]))
    descent.run(40)
    first = next(i for i, only in enumerate(asked) if only is None)
    assert first > 0
    assert all(only == [1] for only in asked[:first])
    assert all(only is None for only in asked[first:])


def start_of(problem):
    return torch.zeros(1, problem.n_shared, dtype=torch.float64), problem.first_states().unsqueeze(0)


def test_a_fit_that_will_not_reach_a_cost_is_given_up():
    problem = problem_of()
    whole = begun(problem)
    whole.run(40)
    least = float(whole.cost[0])
    given_up, goes_on = begun(problem, reach=0.5 * least), begun(problem, reach=1.5 * least)
    given_up.run(40)
    goes_on.run(40)
    assert not bool(given_up.converged[0])
    assert int(given_up.made[0]) < int(whole.made[0])
    assert bool(goes_on.converged[0])
    assert float(goes_on.cost[0]) == pytest.approx(least, rel=1e-7)


@pytest.mark.parametrize(("noise", "crawls"), [(NOISE / 100, True), (100 * NOISE, False)])
def test_a_start_that_crawls_far_above_the_noise_is_given_up(noise, crawls, monkeypatch):
    """Every step is cut to a hundred thousandth; beside noise of the larger size any place is near enough to go on."""
    step = descent_module.newton_step

    def shortened(problem, points, *others):
        end = step(problem, points, *others)
        parts = zip((points.shared, points.states), (end.shared, end.states), strict=True)
        return Points(*(begin + 1e-5 * (whole - begin) for begin, whole in parts))

    monkeypatch.setattr(DESCENT + ".newton_step", shortened)
    records = [decay("first", DAMPING, 0), decay("second", 1.1 * DAMPING, 1)]
    problem = OutputErrorProblem(MODEL, {"amplitude": 0.05}, FREE, records, noise=noise)
    descent, patient = begun(problem, crawl=0.003), begun(problem)
    descent.run(12)
    patient.run(12)
    assert bool(descent.is_promising[0]) is not crawls
    assert (int(descent.made[0]) < 6) is crawls
    assert int(patient.made[0]) >= 8


def test_a_start_that_falls_behind_another_is_given_up():
    """The second start has half the frequency: it settles in a minimum of its own, and more steps do not help."""
    problem = problem_of()
    descent, alone = (begun(problem, starts=starts) for starts in (2, 1))
    away = descent.points.shared.clone()
    away[1, 0] = math.log(0.25)
    descent = Descent(problem, Points(away, descent.points.states), None)
    descent.run(40)
    alone.run(40)
    assert bool(descent.converged[0])
    assert not bool(descent.is_promising[1])
    assert int(descent.made[1]) < 10
    assert float(descent.cost[0]) == pytest.approx(float(alone.cost[0]), rel=1e-6)


def test_steps_follow_the_bend_of_a_valley_where_slopes_are_fresh(monkeypatch):
    """A coefficient beside its exponent, in a unit far from the motion's: without the bend the fit creeps."""
    model = Model(Oscillator(), [effect_class("viscous_damping")(), effect_class("power_law_damping")()])
    free = [
        FreeParameter("power_law_damping.coefficient", 10.0, scale=10.0),
        FreeParameter("power_law_damping.exponent", 1.2),
    ]
    records = [decay_by_power("first", 0), decay_by_power("second", 1)]
    given = {"amplitude": 5e-4, "stiffness": STIFFNESS, COEFFICIENT: 0.4}
    trials = {}
    for name in ("bent", "straight"):
        if name == "straight":
            monkeypatch.setattr(DESCENT + ".accelerated", lambda *steps: steps[4])
        descent = begun(OutputErrorProblem(model, given, free, records))
        descent.run(60)
        trials[name] = int(descent.made[0])
    assert 2 * trials["bent"] < trials["straight"]


def test_an_offset_of_one_record_is_left_alone_by_the_others():
    found = problem_of().unknowns.reach
    assert found.shape == (2, len(FREE))
    problem = problem_of()
    own = FreeParameter("amplitude", 0.05, per_record=True)
    apart = OutputErrorProblem(MODEL, {}, [*FREE, own], problem.records)
    assert apart.unknowns.reach[:, -2:].tolist() == [[1.0, 0.0], [0.0, 1.0]]
    assert math.isclose(float(apart.unknowns.reach[:, :-2].min()), 1.0)


def test_what_goes_only_so_far_lets_the_others_do_what_is_left():
    draw = torch.Generator().manual_seed(3)
    sensitivity = torch.randn(1, 2, 30, 5, generator=draw, dtype=torch.float64)
    residual = torch.randn(1, 2, 30, generator=draw, dtype=torch.float64)
    equations = normal_equations(Prediction(residual, sensitivity), 3)  # three shared, two of each record
    held = torch.tensor([[0.7, 0.0, 0.0]], dtype=torch.float64)
    free = torch.tensor([[False, True, True]])
    shared, own = equations.beyond(held).only(free).step(torch.zeros(1, dtype=torch.float64))
    dense = np.zeros((60, 7))
    for record in range(2):
        rows = slice(30 * record, 30 * record + 30)
        dense[rows, :3] = sensitivity[0, record, :, :3]
        dense[rows, 3 + 2 * record : 5 + 2 * record] = sensitivity[0, record, :, 3:]
    left = residual.flatten().numpy() - 0.7 * dense[:, 0]
    found = np.linalg.lstsq(dense[:, 1:], left, rcond=None)[0]
    np.testing.assert_allclose(shared[0, 1:], found[:2], rtol=1e-9)
    np.testing.assert_allclose(own.flatten(), found[2:], rtol=1e-9)


def spin_down(friction, quadratic):
    """Speed of a free wheel in rpm, by scipy."""
    times = np.arange(400) / 10.0
    found = solve_ivp(lambda _, v: -friction * v - quadratic * v**2, (0, 40), [2000.0], t_eval=times, rtol=1e-10)
    return FitRecord("coast", torch.tensor(found.y[0]), 10.0, observed=Observed("velocity"))


def test_along_a_bent_valley_a_power_law_in_small_units_is_found(monkeypatch):
    monkeypatch.setattr("gear_damping.identification.output_error.descent.AT_ONCE", 1e9)
    model = Model(Oscillator(), [effect_class("viscous_damping")(), effect_class("power_law_damping")()])
    free = [
        FreeParameter(COEFFICIENT, 0.03, logarithmic=True),
        FreeParameter("power_law_damping.coefficient", 2e-9, logarithmic=True),
        FreeParameter("power_law_damping.exponent", 3.2, lower=0.2, upper=5.0),
    ]
    given = {"stiffness": 0.0, "amplitude": 2000.0, "characteristic_time": 1.0}
    problem = OutputErrorProblem(model, given, free, [spin_down(0.01, 2e-5)])
    found = fit(problem, torch.zeros(1, 3, dtype=torch.float64), Rounds(25))
    values = {name: float(value) for name, value in problem.unknowns.parameters(found.shared).items()}
    assert values["power_law_damping.exponent"] == pytest.approx(2.0, rel=1e-3)
    assert values["power_law_damping.coefficient"] == pytest.approx(2e-5, rel=1e-2)
