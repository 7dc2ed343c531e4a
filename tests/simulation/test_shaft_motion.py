"""Speeds and accelerations of the shafts against a pair of wheels integrated by scipy without the reduction."""

import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp

from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.observed import shaft_motion
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

I1, I2 = 2.6e-4, 4.5e-3  # kg m^2
R1, R2 = 3e-3 / 2 * np.cos(np.pi / 9) * np.array([20, 40])  # m
K, C = 3e8, 400.0
SAMPLES, SAMPLING, SPEED = 300, 4e4, 4600 * np.pi / 30
TIMES = np.arange(SAMPLES) / SAMPLING
RADIUS_ERROR, PHASE = 2e-5, 0.6  # of the pinion's eccentricity


def drive(t):
    return 150 + 20 * np.sin(2 * np.pi * 900 * t)


def wheels(drive_torque, brake_torque, inertias=(I1, I2), start=2.5e-5):
    """theta1, theta1', theta2, theta2' and the accelerations of two wheels on one mesh, (6, time)."""

    def slope(t, s):
        turned = SPEED * t + PHASE
        delta = R1 * s[0] - R2 * s[2] - RADIUS_ERROR * np.cos(turned)
        rate = R1 * s[1] - R2 * s[3] + RADIUS_ERROR * SPEED * np.sin(turned)
        force = K * delta + C * rate
        first = (drive_torque(t) - R1 * force) / inertias[0]
        return [s[1], first, s[3], (R2 * force - brake_torque(t)) / inertias[1]]

    found = solve_ivp(slope, (0, TIMES[-1]), [start / R1, 0, 0, 0], "DOP853", TIMES, rtol=1e-12, atol=1e-17).y
    return found, np.array([slope(t, s) for t, s in zip(TIMES, found.T, strict=True)]).T


def pair(mode, effects=("viscous_damping", "pinion_eccentricity"), torque=None, **given):
    effects = ("fourier_mesh_stiffness", *effects)
    effects = [effect_class(one)() if isinstance(one, str) else one for one in effects]
    model = Model(GearPair(gear_torque_mode=mode), effects)
    known = {
        "fourier_mesh_stiffness.maximum": K,
        "fourier_mesh_stiffness.minimum": K,
        "viscous_damping.damping_coefficient": C,
        "pinion_eccentricity.amplitude": RADIUS_ERROR,
        "pinion_eccentricity.phase": PHASE,
        "initial_displacement": 2.5e-5,
    }
    known = {name: value for name, value in (known | given).items() if name in model.parameters()}
    inputs = {} if torque is None else {"pinion_torque": torch.as_tensor(torque).unsqueeze(0)}
    run = {"sampling_rate": SAMPLING, "n_samples": SAMPLES, "inputs": inputs}
    return simulate(model, model.values(2, **known), solver=Solver(accuracy=1e-8, acceleration=True), **run)


def agree(runs, states, slopes, speed_tolerance=1e-5):
    found = {name: series[1].numpy() for name, series in shaft_motion(runs).items()}
    inside = slice(20, -20)  # a sampled torque is known less well at its ends
    for name, row in (("pinion_acceleration", 1), ("gear_acceleration", 3)):
        assert np.abs(found[name] - slopes[row])[inside].max() < 1e-5 * np.abs(slopes[row]).max()
    for name, row in (("pinion_speed", 1), ("gear_speed", 3)):
        missed = found[name] - states[row]
        assert np.std(missed[inside]) < speed_tolerance * np.std(states[row])


def test_torques_that_balance():
    """Both shafts keep their mean speed, also while the torque changes."""
    states, slopes = wheels(drive, lambda t: drive(t) * R2 / R1)
    agree(pair("balanced", torque=drive(TIMES)), states, slopes)


@pytest.mark.parametrize("mode", ["balanced", "held"])
def test_both_shafts_speed_up_with_a_ripple_that_the_gear_s_torque_does_not_follow(mode):
    order, size, phase = 3.0, 20.0, 0.4
    ripple = effect_class("torque_ripple")(gear_torque="stays")
    given = {"torque_ripple.amplitude": size, "torque_ripple.order": order, "torque_ripple.phase": phase}
    given |= {"gear_torque": 150.0 * R2 / R1} if mode == "held" else {}
    runs = pair(mode, ("viscous_damping", "pinion_eccentricity", ripple), **given)

    def rippled(t):
        return 150.0 + size * np.cos(order * SPEED * t + phase)

    states, slopes = wheels(rippled, lambda t: 150.0 * R2 / R1)
    agree(runs, states, slopes, speed_tolerance=2e-4)


def test_a_gear_whose_torque_is_held():
    """The pair as one body follows the torque that nothing holds."""
    states, slopes = wheels(drive, lambda t: 250.0)
    runs = pair("held", torque=drive(TIMES), gear_torque=250.0)
    agree(runs, states, slopes, speed_tolerance=2e-4)
    speed = shaft_motion(runs)["gear_speed"][1].numpy()
    assert np.abs(speed - (states[3] - states[3].mean())).max() < 0.02 * np.std(states[3])


@pytest.mark.parametrize("given", [{"inertia_error.share": 0.3}, {"equivalent_mass": 1.3 / (R1**2 / I1 + R2**2 / I2)}])
def test_inertias_that_are_both_larger(given):
    states, slopes = wheels(lambda t: 150.0, lambda t: 250.0, (1.3 * I1, 1.3 * I2))
    effects = ["viscous_damping", "pinion_eccentricity", *(["inertia_error"] if "inertia_error.share" in given else [])]
    agree(pair("held", effects, gear_torque=250.0, **given), states, slopes)


def test_behind_a_shaft_that_twists():
    """Three inertias: a motor, its shaft, and the pair; the shaft turns the pair as a whole."""
    stiffness, motor = 2000.0, 0.01
    radii, inertias = np.array([R1, R2]), np.array([I1, I2])
    runs = pair(
        "balanced",
        ["shaft_torsion"],
        **{"shaft_torsion.stiffness": stiffness, "shaft_torsion.motor_inertia": motor},
        **{"shaft_torsion.damping_ratio": 0.0, "initial_displacement": 3e-5},
    )

    def slope(t, s):
        force, shaft = K * (radii[0] * s[2] - radii[1] * s[4]), stiffness * (s[0] - s[2])
        accelerations = (150 - shaft) / motor, (shaft - R1 * force) / inertias[0], (R2 * force - 300) / inertias[1]
        return [s[1], accelerations[0], s[3], accelerations[1], s[5], accelerations[2]]

    start = [150 / stiffness + 3e-5 / R1, 0, 3e-5 / R1, 0, 0, 0]
    states = solve_ivp(slope, (0, TIMES[-1]), start, "DOP853", TIMES, rtol=1e-12, atol=1e-17).y
    slopes = np.array([slope(t, s) for t, s in zip(TIMES, states.T, strict=True)]).T
    agree(runs, states[2:], slopes[2:], speed_tolerance=1e-3)


@pytest.mark.parametrize("mode", ["balanced", "held"])
def test_before_a_brake_whose_shaft_twists(mode):
    """Three inertias: the pair, a shaft behind the gear, and a brake."""
    stiffness, brake, held = 8000.0, 0.02, 300.0
    given = {"gear_torque": held, "initial_displacement": 3e-5} if mode == "held" else {"initial_displacement": 3e-5}
    known = {"shaft_torsion.stiffness": stiffness, "shaft_torsion.motor_inertia": brake}
    path = effect_class("shaft_torsion")(shaft="gear")
    runs = pair(mode, [path], drive(TIMES), **known, **given, **{"shaft_torsion.damping_ratio": 0.0})
    twist = float(runs.states["shaft_torsion.twist"][1, 0])

    def slope(t, s):
        force, shaft = K * (R1 * s[0] - R2 * s[2]), stiffness * (s[2] - s[4])
        braked = held if mode == "held" else drive(t) * R2 / R1
        accelerations = (drive(t) - R1 * force) / I1, (R2 * force - shaft) / I2, (shaft - braked) / brake
        return [s[1], accelerations[0], s[3], accelerations[1], s[5], accelerations[2]]

    start = [3e-5 / R1, 0, 0, 0, -twist, 0]
    states = solve_ivp(slope, (0, TIMES[-1]), start, "DOP853", TIMES, rtol=1e-12, atol=1e-17).y
    slopes = np.array([slope(t, s) for t, s in zip(TIMES, states.T, strict=True)]).T
    agree(runs, states[:4], slopes[:4], speed_tolerance=2e-3)


def test_speeds_need_no_acceleration(bench_model):
    model, values = bench_model
    run = {"sampling_rate": 40e3, "n_samples": 40}
    solvers = [Solver(acceleration=wish) for wish in (False, True)]
    without, asked = (shaft_motion(simulate(model, values(2), solver=solver, **run)) for solver in solvers)
    assert without.keys() == {"pinion_speed", "gear_speed"}
    assert torch.equal(without["gear_speed"], asked["gear_speed"])


def test_an_oscillator_has_no_shafts():
    model = Model(Oscillator(), [])
    runs = simulate(model, model.values(1), sampling_rate=10, n_samples=3)
    with pytest.raises(ValueError, match="gear_pair"):
        shaft_motion(runs)


@pytest.mark.parametrize("mode", ["balanced", "held"])
def test_friction_of_the_teeth_pushes_one_shaft_more_than_it_holds_the_other_off_the_pitch_point(mode):
    """Each pair's friction on its own arms, from the tangent points of the base circles: half the force a pair."""
    friction, ratio, teeth, size = 0.02, 1.6, 20, 3e-3
    pitch_of_base, tangent = 2 * np.pi * R1 / teeth, np.tan(np.pi / 9)
    tip = size * (40 / 2 + 1)
    approach = np.sqrt(tip**2 - R2**2) - R2 * tangent  # from where a pair meets to the pitch point, m

    def slope(t, s):
        force = K * (R1 * s[0] - R2 * s[2]) + C * (R1 * s[1] - R2 * s[3])
        front = teeth * SPEED * t / (2 * np.pi) % 1
        pairs = [(front, 0.5), (front + 1, 0.5)] if front < ratio - 1 else [(front, 1.0)]
        twist = np.zeros(2)
        for place, share in pairs:
            off = place * pitch_of_base - approach
            rubs = friction * share * force * (1 if off < 0 else -1)
            twist += rubs * np.array([R1 * tangent + off, -(R2 * tangent - off)])
        brake = 150.0 * R2 / R1
        return [s[1], (150.0 - R1 * force + twist[0]) / I1, s[3], (R2 * force - brake + twist[1]) / I2]

    found = solve_ivp(
        slope, (0, TIMES[-1]), [2.5e-5 / R1, 0, 0, 0], "RK45", TIMES, rtol=1e-8, atol=1e-13, max_step=1e-6
    )
    slopes = np.array([slope(t, s) for t, s in zip(TIMES, found.y.T, strict=True)]).T
    given = {"tooth_friction.friction_coefficient": friction, "fourier_mesh_stiffness.contact_ratio": ratio}
    given |= {"gear_torque": 150.0 * R2 / R1} if mode == "held" else {}
    runs = pair(mode, ("viscous_damping", "tooth_friction"), **given)
    seen, plain = shaft_motion(runs), shaft_motion(pair(mode, ("viscous_damping",), **given))
    for name, row in (("pinion_acceleration", 1), ("gear_acceleration", 3)):
        rubbed = np.std(slopes[row] - plain[name][1].numpy())
        assert np.std(seen[name][1].numpy() - slopes[row]) < 2e-3 * rubbed
    if mode == "held":
        assert np.abs(seen["gear_acceleration"][1].numpy() - slopes[3]).max() < 1e-4 * np.abs(slopes[3]).max()
    if mode == "balanced":  # what friction takes on average the brake gives way to
        for name, row in (("pinion_speed", 1), ("gear_speed", 3)):
            swings, true = (
                series - np.polyval(np.polyfit(TIMES, series, 1), TIMES)
                for series in (seen[name][1].numpy(), found.y[row])
            )
            assert np.std(swings - true) < 0.03 * np.std(true)
            assert abs(np.polyfit(TIMES, seen[name][1].numpy(), 1)[0]) < 0.2 * abs(
                np.polyfit(TIMES, found.y[row], 1)[0]
            )
