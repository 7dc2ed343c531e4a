"""What simulated tests show of plans, and that wrong promises would be seen."""

from dataclasses import replace

import numpy as np
import pytest
from closed_forms import free_decay
from scipy.optimize import least_squares

import gear_damping as gd
from gear_damping.errors import InputError
from gear_damping.identification.test_plan.repeated import repeat

STIFFNESS, DAMPING, START, RATE = 1e4, 2.0, 0.01, 500.0

VISCOUS, QUADRATIC = gd.ViscousDamping(damping_coefficient=DAMPING), gd.PowerLawDamping(coefficient=2.0, exponent=2)


@pytest.fixture(scope="module")
def decay():
    rig = gd.Model(gd.Oscillator(stiffness=STIFFNESS, amplitude=START), [VISCOUS])
    tests = gd.PlannedTests((0.6,), RATE, amplitudes=(START, 2 * START))
    sensors = [gd.PlannedSensor("displacement", noise=4e-4, offset=True), gd.PlannedSensor("velocity", noise=0.1)]
    return gd.plan(rig, tests, sensors, unknown=[gd.Unknown("stiffness", percent=2.0)])


def test_promised_is_shown_by_a_set_with_two_sensors(decay):
    """Of 400 the deviation is known within 3.5 %, the coverage within 1.1 points."""
    both = decay.found.told([(0, 0), (1, 0)])
    shown = decay.simulated(both, count=400, seed=5)
    assert shown.lost == 0
    assert shown.exponent is None
    assert shown.damping_ratio.promised == pytest.approx(both.alone.damping_ratio / 1.959964)
    assert shown.damping_ratio.deviation == pytest.approx(shown.damping_ratio.promised, rel=0.1)
    assert abs(shown.damping_ratio.bias) < 0.2 * shown.damping_ratio.promised
    assert 0.92 < shown.damping_ratio.covered < 0.98


def test_half_the_noise_by_mistake_would_be_seen(decay):
    wrong = replace(decay.found, survey=replace(decay.found.survey, noise=2 * decay.found.survey.noise))
    one = decay.found.told([(1, 0)])
    shown = repeat(wrong, one, 200, seed=2).damping_ratio
    assert shown.deviation > 1.7 * shown.promised
    assert shown.covered < 0.8


def test_fits_by_scipy_of_the_closed_form_scatter_alike(decay):
    """Another estimator, another simulator: scipy on the damped cosine."""
    one = decay.found.told([(1, 0)], [1])
    random, time = np.random.default_rng(0), np.arange(300) / RATE
    clean = free_decay(time, 1, DAMPING, STIFFNESS, 2 * START, 0)[1]
    scale, ratios = np.array([DAMPING, STIFFNESS, 2 * START, 1.0]), []
    for _ in range(250):
        seen, known = clean + 0.1 * random.normal(size=300), 1 + 0.02 * random.normal()

        def left(z, seen=seen, known=known):
            c, k, x, v = scale * z
            return np.append((free_decay(time, 1, c, k, x, v)[1] - seen) / 0.1, (z[1] - known) / 0.02)

        c, k, *_ = scale * least_squares(left, [1, 1, 1, 0]).x
        ratios.append(100 * c / (2 * np.sqrt(k)))
    assert np.std(ratios) == pytest.approx(one.alone.damping_ratio / 1.959964, rel=0.13)
    shown = decay.simulated(one, count=300)
    assert np.std(ratios) == pytest.approx(shown.damping_ratio.deviation, rel=0.2)


def test_an_exponent_beside_the_ratio():
    rig = gd.Model(gd.Oscillator(stiffness=STIFFNESS, amplitude=START), [QUADRATIC])
    tests = gd.PlannedTests((1.0,), RATE, amplitudes=(START / 2, 2 * START))
    found = gd.plan(rig, tests, [gd.PlannedSensor("displacement", snr_db=25)], unknown=["stiffness"])
    both = found.found.told([(0, 0), (1, 0)])
    assert both.joint.percent > both.alone.percent
    assert both.alone.exponent is None
    assert both.joint.exponent < min(one.joint.exponent for one in found.tests)
    shown = found.simulated(both, count=300, joint=True)
    for one in (shown.damping_ratio, shown.exponent):
        assert one.deviation == pytest.approx(one.promised, rel=0.13)
        assert 0.91 < one.covered < 0.985


def test_gears_that_part():
    """A steady record with impacts: 60 fits of it, the deviation known within a tenth."""
    rig = gd.Model(gd.GearPair(pinion_speed=366.5, pinion_torque=300.0),
                   [gd.FourierMeshStiffness(), gd.PowerLawDamping(), gd.Backlash(gap=1e-4)])  # fmt: skip
    tests = gd.PlannedTests((0.01,), 40e3)
    unknown = ["fourier_mesh_stiffness.maximum", gd.Unknown("pinion_torque", percent=1, each=True)]
    found = gd.plan(rig, tests, [gd.PlannedSensor("transmission_error", snr_db=20)], unknown=unknown)
    shown = found.simulated(count=60).damping_ratio
    assert shown.deviation == pytest.approx(shown.promised, rel=0.3)
    assert shown.covered > 0.86


def test_nothing_is_shown_where_nothing_is_promised(decay):
    with pytest.raises(InputError, match="2 or more"):
        decay.simulated(count=1)
    with pytest.raises(InputError, match="tells something"):
        decay.simulated(joint=True)
