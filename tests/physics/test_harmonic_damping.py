"""The damping coefficient that stands for a force, by what a harmonic motion loses to it."""

import numpy as np
import pytest
import torch
from scipy.integrate import quad

from gear_damping.physics.damping_ratio import harmonic_damping_coefficient
from gear_damping.physics.effects.asymmetric_friction import AsymmetricFriction
from gear_damping.physics.kinematics import Kinematics

SPEED = torch.tensor([0.3, 2.0], dtype=torch.float64)


def test_a_viscous_force_is_its_own():
    found = harmonic_damping_coefficient(lambda rate: 7.0 * rate, SPEED)
    assert found.tolist() == pytest.approx([7.0, 7.0], rel=1e-12)


def test_dry_friction_is_four_over_pi_of_it():
    found = harmonic_damping_coefficient(lambda rate: 5.0 * torch.sign(rate), SPEED)
    assert found.tolist() == pytest.approx([20 / (np.pi * v) for v in SPEED.tolist()], rel=1e-5)


def test_a_quadratic_force_is_eight_over_three_pi_of_it():
    found = harmonic_damping_coefficient(lambda rate: 4.0 * rate * rate.abs(), SPEED)
    assert found.tolist() == pytest.approx([32 * v / (3 * np.pi) for v in SPEED.tolist()], rel=1e-5)


def test_of_two_directions_the_mean_counts():
    given = {"force_mean": 3.0, "force_half": 1.0, "damping_mean": 6.0, "damping_half": 2.0, "rest_share": 0.3}
    terms = {name: torch.full((2,), value, dtype=torch.float64) for name, value in given.items()}
    terms["steepness"] = torch.full((2,), 1 / 0.05, dtype=torch.float64)

    def force(rate):
        return AsymmetricFriction().damping_force(Kinematics(rate, rate, rate, delta_rate=rate), terms)

    def of_hand(speed):
        dry = quad(lambda a: 3.0 * np.tanh(speed * np.cos(a) / 0.05) * np.cos(a), 0, 2 * np.pi, limit=400)[0]
        return 6.0 + dry / (np.pi * speed)

    found = harmonic_damping_coefficient(force, SPEED)
    assert found.tolist() == pytest.approx([of_hand(v) for v in SPEED.tolist()], rel=1e-6)
