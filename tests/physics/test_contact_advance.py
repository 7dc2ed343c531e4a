"""Which teeth carry, by the pinion's own angle: both rotations by scipy, the mesh at the angle of the one shaft."""

from math import pi, sin

import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp

import gear_damping as gd
from gear_damping.simulation.driven import Driven
from gear_damping.simulation.simulate import simulate

TEETH, MODULE, PRESSURE = (23, 57), 2e-3, pi / 9
INERTIA, TORQUE, SPEED = (2e-4, 6e-3), 140.0, 310.0
HIGH, LOW, RATIO, DAMPING = 1.2e7, 0.5e7, 1.6, 60.0  # soft, so that the teeth give by a good part of their pitch
RATE, SAMPLES = 40e3, 400
RADII = [z * MODULE * np.cos(PRESSURE) / 2 for z in TEETH]
MASSES = [inertia / radius**2 for inertia, radius in zip(INERTIA, RADII, strict=True)]


def _stiffness(mesh):
    mean = LOW + (HIGH - LOW) * (RATIO - 1)
    return mean + 2 / pi * (HIGH - LOW) * sin(pi * (RATIO - 1)) * np.cos(mesh - pi * (RATIO - 1))


def _both_rotations(torque=TORQUE, samples=SAMPLES):
    """The transmission error by the angles of both shafts, which begin as one body at x = 0, and the pinion's angle."""
    r1, r2 = RADII

    def rates(t, state):
        theta_1, theta_2, omega_1, omega_2 = state
        x, v = r1 * theta_1 - r2 * theta_2, r1 * omega_1 - r2 * omega_2
        force = _stiffness(TEETH[0] * theta_1) * x + DAMPING * v
        return omega_1, omega_2, (torque - r1 * force) / INERTIA[0], (-torque * r2 / r1 + r2 * force) / INERTIA[1]

    time = np.arange(samples) / RATE
    start = [0.0, 0.0, SPEED, SPEED * r1 / r2]
    found = solve_ivp(rates, (0, time[-1]), start, "DOP853", time, rtol=1e-11, atol=1e-14)
    return r1 * found.y[0] - r2 * found.y[1], found.y[0]


@pytest.mark.parametrize(("share", "is_right"), [(MASSES[1] / sum(MASSES), True), (0.0, False)])
def test_the_pinions_own_angle_says_which_teeth_carry(share, is_right):
    pair = gd.GearPair(
        n_teeth_pinion=TEETH[0], n_teeth_gear=TEETH[1], module=MODULE, pressure_angle=PRESSURE,
        inertia_pinion=INERTIA[0], inertia_gear=INERTIA[1], contact_advance=share,
    )  # fmt: skip
    mesh = gd.FourierMeshStiffness(maximum=HIGH, minimum=LOW, contact_ratio=RATIO, n_harmonics=1)
    model = gd.Model(pair, [mesh, gd.ViscousDamping(damping_coefficient=DAMPING)])
    runs = gd.simulate(
        model, sampling_rate=RATE, n_samples=SAMPLES, pinion_speed=SPEED, pinion_torque=TORQUE, batch=1,
        initial_displacement=0.0, initial_velocity=0.0,
    )  # fmt: skip
    wanted, _ = _both_rotations()
    apart = np.abs(runs.transmission_error[0] - wanted).max() / wanted.std()
    assert (apart < 1e-3) == is_right, apart


SETTLED = 4000  # samples in which the start has died away


@pytest.mark.parametrize("torque", [0.5 * TORQUE, TORQUE])
def test_a_measured_angle_has_its_mean_deflection_in_it(torque):
    """The mean rotation as an encoder of the pinion shows it: one mark then holds for every load."""
    wanted, angle = _both_rotations(torque, 2 * SETTLED)
    wanted, time = wanted[SETTLED:], np.arange(SETTLED, 2 * SETTLED) / RATE
    line = np.polyval(np.polyfit(time, angle[SETTLED:], 1), time)
    pair = gd.GearPair(
        n_teeth_pinion=TEETH[0], n_teeth_gear=TEETH[1], module=MODULE, pressure_angle=PRESSURE,
        inertia_pinion=INERTIA[0], inertia_gear=INERTIA[1], contact_advance=MASSES[1] / sum(MASSES),
    )  # fmt: skip
    mesh = gd.FourierMeshStiffness(maximum=HIGH, minimum=LOW, contact_ratio=RATIO, n_harmonics=1)
    model = gd.Model(pair, [mesh, gd.ViscousDamping(damping_coefficient=DAMPING)])
    values = model.values(
        1, pinion_torque=torque, initial_displacement=wanted[0], initial_velocity=np.gradient(wanted[:9], 1 / RATE)[0]
    )
    inputs = Driven({"pinion_angle": torch.tensor(line)[None]})
    found = simulate(model, values, sampling_rate=RATE, n_samples=SETTLED, inputs=inputs).response[0].numpy()
    half = SETTLED // 2
    apart = np.abs(found[half:] - wanted[half:]).max() / wanted.std()
    assert apart < 0.12, apart  # 0.4 and 0.8 where the deflection counts twice; x is not quite load over mean stiffness
