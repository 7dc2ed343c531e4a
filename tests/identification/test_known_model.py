"""Estimators that know the equation: against least squares on closed forms, and against the bound."""

import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from closed_forms import free_decay
from scipy.optimize import least_squares
from scipy.stats import truncnorm

from gear_damping.identification.cramer_rao import cramer_rao
from gear_damping.identification.evaluation import is_repeatable, scores, with_prior
from gear_damping.identification.known_model.estimate import Estimates, within
from gear_damping.identification.known_model.known_runs import KnownRuns, range_of, start_of
from gear_damping.identification.known_model.multiple_shooting import multiple_shooting
from gear_damping.identification.known_model.output_error import misfit, output_error
from gear_damping.identification.known_model.unscented_kalman import smoothed_states, unscented_kalman
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.plan import SimulationPlan, run_plan
from gear_damping.simulation.prior import DAMPING_RATIO, Prior, Uniform
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

OMEGA, RATE, SAMPLES, NOISE = 2 * math.pi * 10, 400.0, 300, 2e-3
RATIOS = torch.tensor([0.8, 1.5, 2.6, 3.7], dtype=torch.float64)
STARTS = np.array([[0.05, 0.1], [0.045, -0.4], [0.055, 0.3], [0.06, 0.0]])
CENTRE, DEVIATION = np.array([0.05, 0.0]), np.array([0.005, 0.3])


@pytest.fixture(scope="module")
def decays():
    """Linear decays in closed form behind noise, for estimators that know all but damping and start."""
    model, time = Model(Oscillator(), [effect_class("viscous_damping")()]), np.arange(SAMPLES) / RATE
    series = [
        free_decay(time, 1.0, 2 * ratio / 100 * OMEGA, OMEGA**2, *start)[0]
        for ratio, start in zip(RATIOS.tolist(), STARTS, strict=True)
    ]
    noise = np.random.default_rng(3).standard_normal((4, SAMPLES)) * NOISE
    values = model.values(4, stiffness=OMEGA**2)
    runs = simulate(model, values, sampling_rate=RATE, n_samples=SAMPLES)
    return KnownRuns(
        runs,
        "viscous_damping",
        (0.5, 4.5),
        torch.as_tensor(np.tile(CENTRE, (4, 1))),
        torch.as_tensor(np.tile(DEVIATION, (4, 1))),
        torch.as_tensor(np.array(series) + noise),
        torch.full((4,), NOISE, dtype=torch.float64),
        Solver(),
    )


def direct(record):
    """The same posterior by scipy from closed forms: place and deviation of the damping ratio in %."""
    found = direct_fit(record)
    return found.x[0], np.sqrt(np.linalg.inv(found.jac.T @ found.jac)[0, 0])


def direct_fit(record):
    """Damping ratio in % and start in deviations, by scipy."""
    time = np.arange(SAMPLES) / RATE

    def left(p):
        x = free_decay(time, 1.0, 2 * p[0] / 100 * OMEGA, OMEGA**2, *(CENTRE + DEVIATION * p[1:]))[0]
        return np.concatenate([(x - record) / NOISE, p[1:]])

    return least_squares(left, [2.0, 0.0, 0.0], x_scale=[1, 1, 1], xtol=1e-12, ftol=1e-12)


def test_output_error_finds_what_scipy_finds_in_closed_forms(decays):
    said = output_error(decays)
    for number, record in enumerate(decays.records.numpy()):
        place, deviation = direct(record)
        assert float(said.ratio[number]) == pytest.approx(place, abs=0.02 * deviation)
        half = float(said.high[number] - said.low[number]) / 2
        assert half == pytest.approx(1.6449 * deviation, rel=0.03)


def test_the_filter_finds_the_same_within_its_deviation(decays):
    said = unscented_kalman(decays)
    for number, record in enumerate(decays.records.numpy()):
        place, deviation = direct(record)
        assert float(said.ratio[number]) == pytest.approx(place, abs=deviation)  # it linearises each sample once
        half = float(said.high[number] - said.low[number]) / 2
        assert half == pytest.approx(1.6449 * deviation, rel=0.15)


def test_the_smoothed_motion_is_that_of_the_fit_to_all_samples(decays):
    ratio, states = smoothed_states(decays)
    for number, record in enumerate(decays.records.numpy()):
        place, *start = direct_fit(record).x
        motion = np.stack(free_decay(np.arange(SAMPLES) / RATE, 1.0, 2 * place / 100 * OMEGA, OMEGA**2,
                                     *(CENTRE + DEVIATION * start)))  # fmt: skip
        found = (CENTRE + DEVIATION * states[number].numpy()).T
        error = np.abs(found - motion).max(1)
        assert float(ratio[number]) == pytest.approx(place, rel=0.05)
        assert error[0] < NOISE / 2  # the filter's are several times that at the start, where it knows no damping
        assert error[1] < OMEGA * NOISE / 2


def test_segments_meet_where_scipy_finds_the_whole_record(decays):
    """Begun at what was measured, with no velocity at all and a wrong damping."""
    begun = torch.stack([decays.records - CENTRE[0], torch.zeros_like(decays.records)], -1) / decays.units[:, None]
    found = multiple_shooting(decays, torch.full((4,), 0.9, dtype=torch.float64), begun)
    for number, record in enumerate(decays.records.numpy()):
        place, *start = direct_fit(record).x
        assert 0.5 + 4.0 * float(found[number, 0]) == pytest.approx(place, rel=2e-3)
        np.testing.assert_allclose(found[number, 1:], start, atol=0.02)


def test_a_start_that_is_known_exactly_is_taken_as_it_is(decays):
    """Of rest, or of any start that a family does not vary."""
    known = replace(decays, centre=torch.as_tensor(STARTS), deviation=torch.zeros(4, 2, dtype=torch.float64))
    for said in (output_error(known), unscented_kalman(known)):
        half = (said.high - said.low) / 2
        assert bool(((said.ratio - RATIOS).abs() < 2 * half).all())
        assert bool((half < 0.1).all())


def test_a_cut_normal_distribution_is_that_of_scipy():
    centre, deviation = torch.tensor([0.3, 0.05, 0.9], dtype=torch.float64), torch.tensor([0.05, 0.1, 0.2]).double()
    said = within(centre, deviation, (0.1, 0.6))
    for number in range(3):
        place, size = float(centre[number]), float(deviation[number])
        cut = truncnorm((0.1 - place) / size, (0.6 - place) / size, place, size)
        assert float(said.ratio[number]) == pytest.approx(cut.mean(), abs=2e-3 * size)
        assert float(said.low[number]) == pytest.approx(cut.ppf(0.05), abs=0.02 * size)
        assert float(said.high[number]) == pytest.approx(cut.ppf(0.95), abs=0.02 * size)


def gears(n_runs=24, gap=None, torque=(0.8, 1.2)):
    effects = [effect_class("fourier_mesh_stiffness")(), effect_class("power_law_damping")(exponent=2)]
    effects += [effect_class("backlash")(gap=gap)] if gap else []
    distributions = {DAMPING_RATIO: Uniform(0.1, 0.6), "pinion_torque": Uniform(*torque, relative=True)}
    return SimulationPlan(
        Model(GearPair(), effects),
        {"pinion_torque": 150.0, "pinion_speed": 4600 * math.pi / 30},
        Prior("bench", distributions),
        n_runs,
        40e3,
        1000,
        3,
        damping_law="power_law_damping",
    )


@pytest.mark.slow
def test_gear_pairs_are_estimated_as_well_as_the_bound_allows():
    plan = replace(gears(), n_samples=500)
    runs = run_plan(plan)
    noise = runs.response.std(-1) * 10 ** (-20 / 20)
    drawn = torch.randn(runs.response.shape, generator=torch.Generator().manual_seed(1), dtype=torch.float64)
    records = runs.response + noise[:, None] * drawn
    centre, deviation = start_of(runs, plan.prior)
    law, ends = plan.damping_law, range_of(plan.prior)
    said = output_error(KnownRuns(runs, law, ends, centre, deviation, records, noise, plan.solver))
    expected = dict(zip(("initial_displacement", "initial_velocity"), deviation.mean(0).tolist(), strict=True))
    bound = cramer_rao(runs, ["damping_ratio"], noise, expected=expected).deviation("damping_ratio")
    found = scores(runs.damping_ratio_percent, said, with_prior(bound, (0.1, 0.6)), 0.35)
    assert found["ratio_to_bound"] == pytest.approx(1.0, abs=3 / math.sqrt(2 * 24))
    assert found["coverage90"] >= 0.7


@pytest.mark.slow
def test_where_flanks_part_the_search_goes_astray_and_the_segments_do_not():
    plan = replace(gears(24, gap=100e-6, torque=(0.6, 0.8)), n_samples=400)
    runs = run_plan(plan)
    noise = runs.response.std(-1) * 10 ** (-30 / 20)
    drawn = torch.randn(runs.response.shape, generator=torch.Generator().manual_seed(1), dtype=torch.float64)
    records, start = runs.response + noise[:, None] * drawn, start_of(runs, plan.prior)
    known = KnownRuns(runs, plan.damping_law, range_of(plan.prior), *start, records, noise, plan.solver)
    astray = misfit(known) > 1.5
    assert 1 <= int(astray.sum()) <= 5
    said = output_error(known.pick(astray))
    error = (said.ratio - runs.damping_ratio_percent[astray]).abs()
    assert bool((error < said.high - said.low).all())  # twice the half: 3.3 deviations


def test_a_motion_that_no_computation_repeats_has_no_bound():
    """Light load and a small gap: flanks part and meet again, and neighbouring motions part without end."""
    plan = gears(40, gap=100e-6)
    runs = run_plan(plan)
    regular = is_repeatable(runs, plan.solver)
    parting = runs.response.min(-1).values < 0
    assert bool(regular[~parting].all())
    calm = run_plan(gears(8))
    assert bool(is_repeatable(calm, Solver()).all())
    rough = Solver(accuracy=0.3)  # a computation that is wrong itself is not repeated either
    coarse = simulate(calm.model, calm.values, sampling_rate=40e3, n_samples=1000, solver=rough)
    assert not bool(is_repeatable(coarse, rough).all())


def test_scores_are_what_they_say():
    true = torch.tensor([1.0, 2.0, 3.0, 4.0], dtype=torch.float64)
    said = Estimates(true + torch.tensor([0.1, -0.1, 0.3, 0.0]), true - 0.05, true + torch.tensor([1.0, 1, -0.01, 1]))
    found = scores(true, said, torch.full_like(true, 0.1), 2.5)
    assert found["rmse_percent"] == pytest.approx(math.sqrt(0.11 / 4))
    assert found["ratio_to_bound"] == pytest.approx(math.sqrt(11 / 4))
    assert found["rmse_to_bound"] == pytest.approx(math.sqrt(0.11 / 4) / 0.1)
    assert found["typical_ratio"] == pytest.approx(1 / 0.67449, rel=1e-4)
    assert found["skill"] == pytest.approx(1 - 0.11 / 5)
    assert found["coverage90"] == 0.75
    nothing = Estimates.without_interval(true)
    assert scores(true, nothing, true, 2.5)["coverage90"] is None
    assert float(with_prior(torch.tensor(math.inf), (0.1, 0.6))) == pytest.approx(0.5 / math.sqrt(12))
