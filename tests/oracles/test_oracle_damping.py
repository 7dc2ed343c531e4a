"""Damping in the oracles: friction that sticks, power laws, equivalent ratios, energy balance."""

import math
from dataclasses import replace

import closed_forms as exact
import numpy as np
import pytest
from gear_reference import GearCase, sampled, simulate, trajectory

PAIR = GearCase()
FREE = replace(PAIR, n_harmonics=0, torque=0.0)
M, K, OMEGA = PAIR.mass, PAIR.mean_stiffness, PAIR.natural_frequency
HALF = math.pi / OMEGA


@pytest.mark.parametrize("law", [{"coulomb_force": 300.0}, {"power_alpha": 300.0, "power_n": 0.0}])
def test_coulomb_turning_points_and_sticking(law):
    points = exact.coulomb_turning_points(1e-5, 300.0, K)
    times = np.arange(len(points) + 3) * HALF
    x, v = simulate(replace(FREE, x0=1e-5, **law), times)
    np.testing.assert_allclose(x, [*points, *[points[-1]] * 3], rtol=0, atol=1e-15)
    assert np.abs(v[-3:]).max() < 1e-12
    assert exact.power_law_amplitude(times[:3], 1e-5, M, K, 300.0, 0.0) == pytest.approx(np.abs(points[:3]))


def test_stuck_mesh_breaks_loose_when_the_load_exceeds_the_friction():
    case = replace(FREE, coulomb_force=300.0, torque_ramp=(0.0, 1e-3, 20.0))
    switches = trajectory(case, np.array([1e-3])).switches
    assert switches[0] == (pytest.approx(1e-3 * 300.0 / FREE.load_of(20.0), rel=1e-9), "breaks loose")


def test_quadratic_damping_turning_points():
    alpha, x = 4000.0, 2e-5
    run = trajectory(replace(FREE, power_alpha=alpha, power_n=2.0, x0=x), np.linspace(0, 1e-3, 101))
    reversals = np.array([t for t, kind in run.switches if kind == "reverses"])
    assert len(reversals) > 9
    turning, _ = simulate(replace(FREE, power_alpha=alpha, power_n=2.0, x0=x), reversals)
    for actual in turning:
        x = exact.quadratic_turning_point(x, alpha, M, K)
        assert actual == pytest.approx(x, rel=1e-11)


@pytest.mark.parametrize("n", [0.0, 0.5, 1.0, 1.7, 2.0, 3.0])
def test_averaged_amplitude_laws_hold_to_the_order_of_the_damping_ratio(n):
    ratio, x0 = 2e-3, 1e-5
    alpha = exact.power_law_coefficient(ratio, n, OMEGA * x0, M, K)
    times = np.arange(1, 31) * 2 * HALF
    x, v = simulate(replace(FREE, power_alpha=alpha, power_n=n, x0=x0), times)
    amplitude = np.hypot(x, v / OMEGA)
    wanted = exact.power_law_amplitude(times, x0, M, K, alpha, n)
    np.testing.assert_allclose(amplitude, wanted, rtol=0, atol=0.5 * ratio * x0)
    assert amplitude[-1] < 0.8 * x0


@pytest.mark.parametrize(("n", "factor"), [(0.0, 4 / math.pi), (1.0, 1.0), (2.0, 8 / (3 * math.pi)), (3.0, 0.75)])
def test_equivalent_damping_ratio_at_the_known_exponents(n, factor):
    ratio = exact.equivalent_damping_ratio(130.0, n, 0.577, M, K)
    assert ratio == pytest.approx(130.0 * 0.577 ** (n - 1) * factor / (2 * math.sqrt(K * M)), rel=1e-12)
    assert exact.power_law_coefficient(ratio, n, 0.577, M, K) == pytest.approx(130.0, rel=1e-12)


def test_smooth_coulomb_friction_tends_to_the_sharp_one():
    times = np.linspace(0, 6 * HALF, 61)
    sharp, _ = simulate(replace(FREE, coulomb_force=200.0, x0=1e-5), times)
    gaps = []
    for width in (2e-2, 5e-3):
        smooth, _ = simulate(replace(FREE, coulomb_force=200.0, coulomb_smoothing=width, x0=1e-5), times)
        gaps.append(np.abs(smooth - sharp).max())
    assert gaps[1] < gaps[0] / 3 < 1e-7


def gauss_nodes(edges, count=12):
    """Times (pieces * count,) and weights of Gauss-Legendre quadrature on every piece between the edges."""
    node, weight = np.polynomial.legendre.leggauss(count)
    half = 0.5 * np.diff(edges)[:, None]
    return (np.asarray(edges)[:-1, None] + half * (1 + node)).ravel(), (half * weight).ravel()


@pytest.mark.parametrize(
    "effects",
    [
        {},
        {"viscous": 300.0},
        {"power_alpha": 3000.0, "power_n": 2.0},
        {"power_alpha": 500.0, "power_n": 1.0, "coulomb_force": 40.0},
    ],
)
def test_energy_balance_through_losses_of_contact(effects):
    case = replace(PAIR, gap=60e-6, x0=3.0 * PAIR.static_deflection, **effects)
    end = 1e-3
    switches = [t for t, _ in trajectory(case, np.array([end])).switches]
    edges = np.unique([*np.linspace(0, end, 201), *switches])
    times, weights = gauss_nodes(edges)
    x, v = simulate(case, np.append(times, end))
    h = 1e-9
    slope = (sampled(case, "stiffness", times + h) - sampled(case, "stiffness", times - h)) / (2 * h)
    stretch = np.maximum(x[:-1], 0) + np.minimum(x[:-1] + case.gap, 0)
    rate, loss = v[:-1], case.viscous * v[:-1] ** 2
    loss = loss + rate * exact.power_law_force(rate, case.power_alpha, case.power_n)
    loss = loss + case.coulomb_force * abs(rate)
    work = weights @ (0.5 * slope * stretch**2 + case.mean_load * rate - loss * (stretch != 0))
    k = sampled(case, "stiffness", [0.0, end])
    energies = exact.energy([case.x0, x[-1]], [0.0, v[-1]], M, k, case.gap)
    assert len(switches) >= 2
    assert (stretch == 0).any()
    assert energies[1] - energies[0] == pytest.approx(work, abs=1e-8 * energies[0])
