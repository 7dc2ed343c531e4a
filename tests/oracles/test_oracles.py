"""The oracles check each other: the paper's numbers, closed forms against the event-located reference."""

import math
from dataclasses import replace

import closed_forms as exact
import numpy as np
import pytest
from gear_reference import GearCase, Ripple, sampled, simulate, trajectory
from gear_terms import rectangular_stiffness, stiffness_coefficients
from scipy.integrate import quad

PAIR = GearCase()
PLAIN = replace(PAIR, n_harmonics=0)  # constant mean stiffness
M, K, OMEGA, STATIC = PAIR.mass, PAIR.mean_stiffness, PAIR.natural_frequency, PAIR.static_deflection
TIMES = np.linspace(0.0, 2e-3, 81)


def same(actual, expected, relative=1e-10):
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=relative * np.max(np.abs(expected)))


def test_numbers_of_the_paper():
    assert PAIR.base_radii == pytest.approx((28.19e-3, 56.38e-3), abs=5e-6)
    assert pytest.approx(0.2657, abs=5e-5) == M
    assert pytest.approx(3.2e8) == K
    assert exact.natural_frequency(M, K) / (2 * math.pi) == pytest.approx(5523, abs=0.5)
    assert PAIR.mean_load == pytest.approx(5321, abs=0.5)
    assert exact.static_deflection(PAIR.mean_load, K) == pytest.approx(16.63e-6, abs=5e-9)
    assert pytest.approx(0.577, abs=5e-4) == STATIC * OMEGA
    assert 2 * 0.01 * math.sqrt(K * M) == pytest.approx(184, abs=0.5)


def test_load_per_torque_with_balanced_and_with_held_gear():
    assert PAIR.load_of(151.0) - PAIR.load_of(150.0) == pytest.approx(35.47, abs=5e-3)
    held = replace(PAIR, gear_torque=PAIR.balanced_gear_torque)
    assert held.mean_load == pytest.approx(150.0 / PAIR.base_radii[0])
    assert held.load_of(151.0) - held.load_of(150.0) == pytest.approx(28.81, abs=5e-3)


def test_stiffness_series_and_contact_ratio_by_quadrature_of_the_wave():
    edge = 2 * math.pi * (PAIR.contact_ratio - 1)
    plain, lanczos = stiffness_coefficients(PAIR), stiffness_coefficients(replace(PAIR, weighting="lanczos"))
    for h in range(PAIR.n_harmonics + 1):
        parts = [
            sum(
                quad(lambda u, h=h, f=f: rectangular_stiffness(PAIR, u) * f(h * u), *side, epsabs=1e-3)[0]
                for side in ((0.0, edge), (edge, 2 * math.pi - 1e-15))
            )
            for f in (math.cos, math.sin)
        ]
        assert plain[h] == pytest.approx(complex(parts[0], -parts[1]) / (2 * math.pi), abs=1e-3)
        assert lanczos[h] == pytest.approx(plain[h] * np.sinc(h / 9), rel=1e-13)
        if h:
            size = 2 * (PAIR.k_max - PAIR.k_min) / (h * math.pi) * abs(math.sin(h * math.pi * 0.6))
            assert abs(2 * plain[h]) == pytest.approx(size, abs=1e-3)
        else:
            share = (parts[0] / (2 * math.pi) - PAIR.k_min) / (PAIR.k_max - PAIR.k_min)
            assert 1 + share == pytest.approx(PAIR.contact_ratio, rel=1e-12)
    assert sampled(PAIR, "stiffness", [0.3 * PAIR.mesh_period])[0] > 3.7e8  # two pairs carry on [0, 0.6)
    assert sampled(PAIR, "stiffness", [0.8 * PAIR.mesh_period])[0] < 2.3e8
    rectangular = replace(PAIR, stiffness_form="rectangular", mesh_phase=-1.0, pinion_speed=-300.0)
    many = replace(rectangular, stiffness_form="fourier", n_harmonics=4000)
    at = np.linspace(0.013, 0.989, 13) * PAIR.mesh_period
    same(sampled(many, "stiffness", at), sampled(rectangular, "stiffness", at), 3e-3)


@pytest.mark.parametrize("ratio", [0.0, 0.0035, 0.17, 1.0, 1.7])
def test_free_decay(ratio):
    c = 2 * ratio * math.sqrt(K * M)
    case = replace(PLAIN, torque=0.0, viscous=c, x0=1e-5, v0=0.2)
    x, v = exact.free_decay(TIMES, M, c, K, 1e-5, 0.2)
    same(simulate(case, TIMES)[0], x)
    same(simulate(case, TIMES)[1], v)


def test_transient_and_steady_state_under_load_sine_and_ripple():
    case = replace(
        PLAIN,
        viscous=300.0,
        torque_sine=(20.0, 5000.0, 0.4),
        x0=1e-5,
        v0=0.1,
        ripple=(Ripple(50.0, 4.0, 0.2), Ripple(70.0, 3.0, 0.5, "gear")),
        gear_angle_0=0.3,
        pinion_angle_0=0.1,
    )
    r1 = case.base_radii[0]
    forces = (
        (case.mean_load, 0.0, 0.0),
        (20.0 / r1, 2 * math.pi * 5000.0, 0.4 - math.pi / 2),
        (50.0, 4 * case.pinion_speed, 0.4 + 0.2),
        (70.0, 1.5 * case.pinion_speed, 3 * (0.05 + 0.3) + 0.5),
    )
    expected = exact.forced_response(TIMES, M, 300.0, K, 1e-5, 0.1, forces)
    for actual, wanted in zip(simulate(case, TIMES), expected, strict=True):
        same(actual, wanted)


def test_displacement_errors_excite_through_spring_and_damper():
    case = replace(
        PLAIN,
        viscous=400.0,
        mesh_phase=0.6,
        pinion_angle_0=0.2,
        gear_angle_0=0.9,
        x0=STATIC,
        pinion_eccentricity=(2e-5, 0.4),
        gear_eccentricity=(1e-5, 1.0),
        profile_error=((2, 3e-6, 0.3),),
    )
    speed, waves = case.pinion_speed, []
    errors = ((2e-5, 1, 0.2 + 0.4), (1e-5, 0.5, 0.1 + 0.9 + 1.0), (3e-6, 40, 2 * (4 + 0.6) + 0.3))
    for size, rate, angle in errors:
        phasor = size * (K + 400j * rate * speed) * np.exp(1j * angle)
        waves.append((abs(phasor), rate * speed, float(np.angle(phasor))))
    waves.append((case.mean_load, 0.0, 0.0))
    expected = exact.forced_response(TIMES, M, 400.0, K, STATIC, 0.0, tuple(waves))
    same(simulate(case, TIMES)[0], expected[0])


def chained(changes, case, stiffness=lambda t: K):
    """x at TIMES for loads and stiffnesses constant by pieces: closed forms joined at `changes` (t, load)."""
    x, state = np.empty_like(TIMES), (case.x0, case.v0)
    for (start, load), stop in zip(changes, [*(t for t, _ in changes[1:]), np.inf], strict=True):
        k = stiffness(start)
        piece = (start <= TIMES) & (stop >= TIMES)
        at = np.append(TIMES[piece], min(stop, TIMES[-1])) - start
        path = exact.forced_response(at, M, case.viscous, k, *state, ((load, 0.0, 0.0),))
        x[piece], state = path[0][:-1], (path[0][-1], path[1][-1])
    return x


def test_torque_steps_and_held_loads_switch_at_their_exact_times():
    case = replace(PLAIN, viscous=200.0, x0=STATIC, torque_steps=((3.123e-4, 40.0), (1.2345e-3, -70.0)))
    loads = [(0.0, case.load_of(150.0)), (3.123e-4, case.load_of(190.0)), (1.2345e-3, case.load_of(120.0))]
    same(simulate(case, TIMES)[0], chained(loads, case))
    held = replace(PLAIN, viscous=200.0, x0=STATIC, held_load=(300.0, -900.0, 200.0), held_load_step=2.9e-4)
    loads = [(j * 2.9e-4, held.mean_load + extra) for j, extra in enumerate((300.0, -900.0, 200.0, 0.0))]
    same(simulate(held, TIMES)[0], chained(loads, held))


def test_rectangular_stiffness_switches_at_its_exact_times():
    case = replace(PAIR, stiffness_form="rectangular", mesh_phase=0.7, viscous=200.0, x0=STATIC)
    rate = 20 * case.pinion_speed
    edges = sorted((2 * math.pi * (j + part) - 0.7) / rate for j in range(5) for part in (0.0, 0.6))
    changes = [(0.0, case.mean_load), *((t, case.mean_load) for t in edges if 0 < t < TIMES[-1])]

    def stiffness_behind(t):
        return 4e8 if math.fmod(rate * (t + 1e-9) + 0.7, 2 * math.pi) < 1.2 * math.pi else 2e8

    same(simulate(case, TIMES)[0], chained(changes, case, stiffness_behind))


def test_ramp_equals_the_same_ramp_given_as_a_measured_torque():
    ramp = replace(PAIR, x0=STATIC, torque_ramp=(3e-4, 1.1e-3, -80.0))
    measured = replace(PAIR, x0=STATIC, torque=1.0, measured_torque=((3e-4, 1.1e-3), (150.0, 70.0)))
    x, _ = simulate(ramp, TIMES)
    same(simulate(replace(measured, torque=150.0), TIMES)[0], x)
    for case in (ramp, measured):
        loads = sampled(case, "load", [0.0, 7e-4, 1.5e-3])
        assert loads == pytest.approx([PAIR.load_of(torque) for torque in (150, 110, 70)])


def test_stiffness_modulation_multiplies():
    case = replace(
        PAIR,
        pinion_stiffness_modulation=(0.02, 0.5),
        gear_stiffness_modulation=(0.03, 0.7),
        pinion_angle_0=0.3,
        gear_angle_0=0.4,
    )
    bare = replace(case, pinion_stiffness_modulation=(0, 0), gear_stiffness_modulation=(0, 0))
    share = sampled(case, "stiffness", TIMES) / sampled(bare, "stiffness", TIMES)
    turn = 0.3 + case.pinion_speed * TIMES
    same(share, (1 + 0.02 * np.cos(turn + 0.5)) * (1 + 0.03 * np.cos(turn / 2 + 0.4 + 0.7)), 1e-13)


def test_proportional_ripple_multiplies_the_load():
    case = replace(PAIR, ripple=(Ripple(0.1, 2.0, 0.3, proportional=True),))
    share = 1 + 0.1 * np.cos(2 * case.pinion_speed * TIMES + 0.3)
    same(sampled(case, "load", TIMES), case.mean_load * share)


def test_bouncing_leaves_and_meets_the_flank_at_the_exact_times():
    exit_speed = 0.7
    case = replace(PLAIN, gap=1e-3, x0=0.0, v0=exit_speed)
    contact, flight = exact.bouncing_times(M, K, case.mean_load, exit_speed)
    run = trajectory(case, TIMES)
    expected = [j // 2 * (contact + flight) + contact + (j % 2) * flight for j in range(len(run.switches))]
    assert len(expected) > 10
    same([t for t, _ in run.switches], expected, 1e-11)
    assert [kind for _, kind in run.switches[:2]] == ["leaves drive flank", "meets drive flank"]
