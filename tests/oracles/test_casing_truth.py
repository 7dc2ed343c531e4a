"""The casing oracle against scipy's integrator and the closed forms of its modes."""

from dataclasses import replace

import numpy as np
import pytest
from casing import draw_case
from casing.mesh import mean_stiffness, stiffness_and_drive
from casing.motion import mesh_force
from casing.path import Mode, heard, noise
from scipy.integrate import solve_ivp

CASE = draw_case(1, "pinion", seconds=0.2)
GEARS = CASE.gears


def test_the_propagators_follow_an_adaptive_integrator():
    step, count, speed = 5e-6, 250, 50.0
    half = np.arange(2 * count + 1) * step / 2
    found = mesh_force(GEARS, speed * half, np.full_like(half, GEARS.load), step)
    mean = mean_stiffness(GEARS)
    damping = 2 * GEARS.damping_ratio * np.sqrt(mean * GEARS.mass)

    def rate(time, state):
        stiffness, drive = (one[0] for one in stiffness_and_drive(GEARS, np.array([speed * time])))
        force = GEARS.load + drive - stiffness * state[0] - damping * state[1]
        return state[1], force / GEARS.mass

    exact = solve_ivp(
        rate, (0, half[-1]), (GEARS.load / mean, 0.0), "DOP853", half[::2], rtol=1e-8, atol=1e-14, max_step=step
    )
    expected = [-GEARS.mass * rate(t, y)[1] for t, y in zip(half[::2], exact.y.T, strict=True)]
    assert np.std(found - expected) < 1e-3 * np.std(expected)


def test_a_cracked_tooth_softens_the_mesh_once_a_turn():
    turn = np.arange(4000) / 4000
    sound = stiffness_and_drive(replace(GEARS, crack=0.0), turn)[0]
    soft = stiffness_and_drive(GEARS, turn)[0]
    share = np.mean(soft < sound * (1 - 1e-9))
    assert share == pytest.approx((GEARS.contact_ratio + GEARS.edge) / GEARS.teeth[0], rel=0.05)


def test_a_mode_answers_a_tone_as_its_formula_says():
    rate, mode, frequency = 100e3, Mode(1500.0, 0.03, 2.0), 1300.0
    time = np.arange(20000) / rate
    answer = heard(np.cos(2 * np.pi * frequency * time), (mode,), rate)[10000:]
    s, omega = 2j * np.pi * frequency, 2 * np.pi * mode.frequency
    gain = mode.size * s**2 / (s**2 + 2 * mode.damping_ratio * omega * s + omega**2)
    assert np.sqrt(2) * answer.std() == pytest.approx(abs(gain), rel=0.01)


def test_pulses_cover_the_record_and_noise_has_unit_variance():
    assert CASE.pulses[0] <= 1.0 / CASE.per_turn / (CASE.speed / 2 / np.pi)
    steps = np.diff(CASE.pulses) * CASE.per_turn * CASE.speed / 2 / np.pi
    assert np.abs(steps - 1).max() < 0.05
    assert noise(np.random.default_rng(0), 20000, 0.9).std() == pytest.approx(1, rel=0.1)


def test_runs_of_a_seed_share_the_rig():
    one, other = draw_case(3, "healthy", seconds=0.2), draw_case(3, "healthy", seconds=0.2, run=1)
    assert one.speed == other.speed
    assert np.array_equal(one.gears.pitch[0], other.gears.pitch[0])
    assert not np.array_equal(one.acceleration, other.acceleration)
