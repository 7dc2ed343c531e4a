"""Information of planned tests against closed forms, and against the inverse over all that is unknown at once."""

import math

import numpy as np
import pytest
import torch
from closed_forms import free_decay

import gear_damping as gd
from gear_damping.identification.test_plan.information import QUANTILE, half_intervals, inverse, shared_information
from gear_damping.identification.test_plan.survey import is_regular

STIFFNESS, DAMPING, RATE, NOISE, STARTS = (2 * math.pi * 15) ** 2, 4.0, 500.0, 2e-4, (0.01, 0.025)
LENGTHS = (150, 400)
RATIO = 100 * DAMPING / (2 * math.sqrt(STIFFNESS))


def of_decay(start, length, channel=0):
    """Slopes of a decay by (damping, stiffness, x0, v0), by differences of the closed form."""
    time = np.arange(length) / RATE
    truth, steps = np.array([DAMPING, STIFFNESS, start, 0.0]), np.array([1e-4, 1e-2, 1e-7, 1e-6])

    def at(values):
        return free_decay(time, 1.0, *values)[channel]

    return np.stack([(at(truth + e) - at(truth - e)) / (2 * e.sum()) for e in np.diag(steps)], 1)


def expected_percent(tests, known=(), channel=0, noise=NOISE):
    """Half interval of the ratio in % of it, by the inverse over the shared unknowns and every start at once."""
    size = 2 + 2 * len(tests)
    whole = np.zeros((size, size))
    for number, (start, length) in enumerate(tests):
        place = [0, 1, 2 + 2 * number, 3 + 2 * number]
        slopes = of_decay(start, length, channel) / noise
        whole[np.ix_(place, place)] += slopes.T @ slopes
    for place, deviation in known:
        whole[place, place] += deviation**-2
    gradient = np.zeros(size)  # zeta = c / (2 sqrt k)
    gradient[:2] = RATIO / DAMPING, -RATIO / (2 * STIFFNESS)
    scale = np.sqrt(np.diag(whole))
    covariance = np.linalg.inv(whole / np.outer(scale, scale)) / np.outer(scale, scale)
    return 100 * QUANTILE * math.sqrt(gradient @ covariance @ gradient) / RATIO


def planned(sensors=None, unknown=("stiffness",), **goal):
    rig = gd.Model(gd.Oscillator(stiffness=STIFFNESS, amplitude=0.01), [gd.ViscousDamping(damping_coefficient=DAMPING)])
    tests = gd.PlannedTests(tuple(n / RATE for n in LENGTHS), RATE, amplitudes=STARTS)
    sensors = sensors or [gd.PlannedSensor("displacement", noise=NOISE)]
    solver = gd.Solver(accuracy=1e-8)
    return gd.plan(rig, tests, sensors, unknown=unknown, goal=gd.PlanGoal(**goal), solver=solver)


@pytest.fixture(scope="module")
def plan():
    return planned()


def test_each_test_is_that_of_a_damped_cosine(plan):
    for one in plan.tests:
        ((setting, length),) = one.tests
        expected = expected_percent([(STARTS[setting], LENGTHS[length])])
        assert one.alone.percent == pytest.approx(expected, rel=1e-3)
        assert one.alone.damping_ratio == pytest.approx(expected * RATIO / 100, rel=1e-3)
        assert one.joint is None


def test_a_set_is_the_inverse_over_all_starts(plan):
    both = plan.found.told([(0, 0), (1, 1)])
    assert both.alone.percent == pytest.approx(expected_percent([(STARTS[0], 150), (STARTS[1], 400)]), rel=1e-3)
    twice = plan.found.told([(0, 0), (0, 0)])
    assert twice.alone.percent == pytest.approx(plan.found.told([(0, 0)]).alone.percent / math.sqrt(2), rel=1e-6)


def test_what_is_known_beforehand_counts_once():
    found = planned(unknown=[gd.Unknown("stiffness", deviation=2.0)])
    expected = expected_percent([(STARTS[0], 150)] * 2, known=[(1, 2.0)])
    assert found.found.told([(0, 0), (0, 0)]).alone.percent == pytest.approx(expected, rel=1e-3)
    same = planned(unknown=[gd.Unknown("stiffness", percent=200 / STIFFNESS)])
    assert same.tests[0].alone.percent == pytest.approx(found.tests[0].alone.percent, rel=1e-9)


def test_sensors_add_and_half_the_noise_is_seen():
    """A plan with half the noise by mistake promises half the interval: the closed form tells it."""
    velocity = gd.PlannedSensor("velocity", noise=100 * NOISE)
    found = planned([gd.PlannedSensor("displacement", noise=NOISE / 2), velocity])
    halved, by_velocity, together = (one.alone.percent for one in found.tests[:3])
    expected = expected_percent([(STARTS[0], 150)])
    assert halved == pytest.approx(expected / 2, rel=1e-3)
    assert halved != pytest.approx(expected, rel=0.1)
    assert by_velocity == pytest.approx(expected_percent([(STARTS[0], 150)], channel=1, noise=100 * NOISE), rel=1e-3)
    assert together < min(halved, by_velocity)


def test_an_unknown_zero_costs_what_a_column_of_ones_takes(plan):
    found = planned([gd.PlannedSensor("displacement", noise=NOISE, offset=True)])
    slopes = np.column_stack([of_decay(STARTS[0], 150), np.ones(150)]) / NOISE
    scale = np.linalg.norm(slopes, axis=0)
    covariance = np.linalg.inv((slopes / scale).T @ (slopes / scale)) / np.outer(scale, scale)
    gradient = np.array([RATIO / DAMPING, -RATIO / (2 * STIFFNESS), 0, 0, 0])
    expected = 100 * QUANTILE * math.sqrt(gradient @ covariance @ gradient) / RATIO
    assert found.tests[0].alone.percent == pytest.approx(expected, rel=1e-3)
    assert found.tests[0].alone.percent > plan.tests[0].alone.percent


def test_a_level_below_the_signal_is_one_of_the_shortest_record():
    found = planned([gd.PlannedSensor("displacement", snr_db=20)])
    levels = [0.1 * free_decay(np.arange(150) / RATE, 1, DAMPING, STIFFNESS, x, 0)[0].std() for x in STARTS]
    np.testing.assert_allclose(found.found.survey.noise[0], levels, rtol=1e-4)


def test_schur_is_the_block_of_the_inverse():
    random = np.random.default_rng(3)
    slopes = torch.tensor(random.normal(size=(40, 6)) * 10.0 ** random.uniform(-6, 6, 6))
    prior = torch.tensor([0.0, 3.0, 0.0, 1e3], dtype=torch.float64)
    whole = slopes.T @ slopes
    found = inverse(shared_information(whole, 2, prior))
    expected = torch.linalg.inv(whole + torch.diag(torch.cat([torch.zeros(2), prior])))[:2, :2]
    torch.testing.assert_close(found, expected, rtol=1e-8, atol=0.0)


def test_what_is_not_told_is_beyond_all_bounds():
    nothing = torch.tensor([[4.0, 0.0], [0.0, 0.0]], dtype=torch.float64)
    assert float(half_intervals(nothing, torch.tensor([1.0, 0.0], dtype=torch.float64))) == pytest.approx(QUANTILE / 2)
    assert float(half_intervals(nothing, torch.tensor([0.0, 1.0], dtype=torch.float64))) > 1e8


def test_motion_in_which_errors_grow_exponentially_is_irregular():
    time = torch.linspace(0, 1, 800, dtype=torch.float64)
    powers = [torch.exp(-9 * time), 1 + 50 * time, 1 + 9 * time**2]
    saturated = 1e6 / (1 + 1e6 * torch.exp(-100 * time))
    slopes = torch.stack([*powers, torch.exp(9 * time), torch.exp(20 * time), saturated])
    found = is_regular(slopes[None, :, None], [200, 800])
    assert found[:, 1].tolist() == [True, True, True, False, False, False]
    assert found[0].all()
    assert found[1].all()
