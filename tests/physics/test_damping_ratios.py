"""Equivalent damping ratios against energy integrals and the decay of an exact solution."""

import numpy as np
import pytest
import torch
from effect_bench import EFFECTS
from scipy.integrate import quad, solve_ivp

from gear_damping.physics import damping_ratio as ratios
from gear_damping.physics.terms import DampingLaw

MASS, STIFFNESS = 0.2657, 3.2e8


def tensor(value: float) -> torch.Tensor:
    return torch.tensor([value], dtype=torch.float64)


@pytest.mark.parametrize("exponent", [0.5, 1.0, 1.7, 2.0, 3.0])
def test_the_equivalent_coefficient_dissipates_as_much_per_cycle(exponent):
    alpha, speed = 131.8, 0.577
    lost, _ = quad(lambda a: alpha * abs(speed * np.cos(a)) ** (exponent + 1), 0, 2 * np.pi, points=[np.pi / 2])
    viscous = lost / (np.pi * speed**2)
    found = ratios.equivalent_damping_coefficient(tensor(alpha), tensor(exponent), tensor(speed))
    assert found.item() == pytest.approx(viscous, rel=1e-7)


def test_gamma_factor_has_its_closed_forms():
    found = ratios.gamma_factor(torch.tensor([0.0, 1.0, 2.0, 3.0], dtype=torch.float64))
    assert found.tolist() == pytest.approx([4 / np.pi, 1.0, 8 / (3 * np.pi), 0.75], rel=1e-12)


def test_the_ratio_and_the_coefficient_are_each_others_inverse():
    zeta, exponent = tensor(0.0035), tensor(2.3)
    about = (exponent, tensor(0.577), tensor(MASS), tensor(STIFFNESS))
    alpha = ratios.power_law_coefficient(zeta, *about)
    assert ratios.equivalent_damping_ratio(alpha, *about).item() == pytest.approx(0.0035, rel=1e-12)


def test_log_decrement_is_the_ratio_of_successive_peaks():
    zeta = 0.1
    rate = np.sqrt(1 - zeta**2)
    times = 2 * np.pi / rate * np.array([0.0, 1.0])
    peaks = np.exp(-zeta * times)
    assert ratios.log_decrement(tensor(zeta)).item() == pytest.approx(np.log(peaks[0] / peaks[1]), rel=1e-12)


def test_a_quadratic_force_decays_as_its_ratio_says():
    zeta, omega = 0.003, np.sqrt(STIFFNESS / MASS)
    speed = 0.5
    alpha = ratios.power_law_coefficient(*(tensor(v) for v in (zeta, 2.0, speed, MASS, STIFFNESS))).item()

    def rates(t: float, y: np.ndarray) -> list[float]:
        return [y[1], -(STIFFNESS * y[0] + alpha * abs(y[1]) * y[1]) / MASS]

    period = 2 * np.pi / omega
    run = solve_ivp(rates, (0, period), [speed / omega, 0.0], rtol=1e-10, atol=1e-16)
    # amplitude falls as X / (1 + X q) with q = zeta omega t / X0
    assert run.y[0, -1] * omega / speed == pytest.approx(1 / (1 + 2 * np.pi * zeta), rel=2e-4)


def test_reference_velocity_of_the_default_pair():
    found = ratios.reference_velocity(tensor(5321.0), tensor(STIFFNESS), tensor(MASS))
    assert found.item() == pytest.approx(0.577, abs=5e-4)


@pytest.mark.parametrize("name", [n for n, c in EFFECTS.items() if issubclass(c, DampingLaw)])
def test_a_damping_law_finds_the_coefficient_of_a_ratio(name):
    law = EFFECTS[name]()
    values = {p.name: tensor(p.default) for p in law.parameters}
    about = (tensor(MASS), tensor(STIFFNESS), tensor(0.4))
    assert law.damping_ratio(values, *about).item() == pytest.approx(0.0035, rel=0.5)
    found = values | law.coefficient_for(tensor(0.012), values, *about)
    assert law.damping_ratio(found, *about).item() == pytest.approx(0.012, rel=1e-12)
