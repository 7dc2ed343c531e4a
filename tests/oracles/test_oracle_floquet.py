"""The Floquet oracle against exact products of exponentials, Liouville's formula and the known tongues."""

import math
from dataclasses import replace

import numpy as np
import pytest
from floquet import floquet_multipliers, mesh_multipliers, stepwise_multipliers
from gear_reference import GearCase, simulate

PAIR = GearCase()
M, K = PAIR.mass, PAIR.mean_stiffness


def turning(rpm, **changes):
    return replace(PAIR, pinion_speed=rpm * 2 * math.pi / 60, **changes)


def test_constant_stiffness_gives_the_free_decay():
    period, c = 3.3e-4, 184.0
    root = -c / (2 * M) + 1j * math.sqrt(K / M - (c / (2 * M)) ** 2)
    values = floquet_multipliers(M, c, lambda t: K, period)
    wanted = np.exp(root * period)
    np.testing.assert_allclose(sorted(values.imag), sorted([wanted.imag, -wanted.imag]), rtol=1e-9)
    np.testing.assert_allclose(values.real, wanted.real, rtol=1e-9)


@pytest.mark.parametrize("rpm", [4600, 15500, 16400])
def test_rectangular_wave_equals_the_product_of_exponentials(rpm):
    case = turning(rpm, stiffness_form="rectangular")
    damping = 2 * 0.0035 * math.sqrt(K * M)
    period = case.mesh_period
    wanted = stepwise_multipliers(M, damping, [(0.6 * period, 4e8), (0.4 * period, 2e8)])
    np.testing.assert_allclose(np.abs(mesh_multipliers(case, 0.0035)), np.abs(wanted), rtol=1e-9)


def test_product_of_the_multipliers_is_liouvilles():
    damping = 2 * 0.006 * math.sqrt(K * M)
    for rpm in (4200, 4680, 6550):
        case = turning(rpm)
        product = np.prod(mesh_multipliers(case, 0.006))
        assert product == pytest.approx(math.exp(-damping / M * case.mesh_period), rel=1e-10)


@pytest.mark.parametrize(
    ("rpm", "weighting", "ratio", "grows"),
    [
        (4600, "plain", 0.0035, False),
        (4650, "plain", 0.0035, True),
        (4090, "plain", 0.006, True),
        (6550, "plain", 0.006, True),
        (6350, "plain", 0.001, False),
        (6550, "lanczos", 0.006, True),
        (4680, "lanczos", 0.0035, False),
        (4090, "lanczos", 0.0035, False),
        (5450, "plain", 0.001, True),
        (5450, "plain", 0.006, False),
    ],
)
def test_known_tongues(rpm, weighting, ratio, grows):
    assert (abs(mesh_multipliers(turning(rpm, weighting=weighting), ratio)[0]) > 1) == grows


def test_the_reference_obeys_the_recurrence_of_the_multipliers_from_period_to_period():
    case = turning(4680, torque=0.0, viscous=2 * 0.0035 * math.sqrt(K * M), x0=1e-6)
    multipliers = mesh_multipliers(case, 0.0035)
    x, _ = simulate(case, np.arange(6) * case.mesh_period)
    wanted = np.sum(multipliers).real * x[1:-1] - np.prod(multipliers).real * x[:-2]
    np.testing.assert_allclose(x[2:], wanted, rtol=0, atol=1e-10 * np.abs(x).max())


def test_shaft_order_modulation_is_refused():
    with pytest.raises(ValueError, match="shaft-order"):
        mesh_multipliers(replace(PAIR, gear_stiffness_modulation=(0.01, 0.0)), 0.01)
