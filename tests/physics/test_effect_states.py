"""Effects with states of their own against the matrices and torques of the bodies they stand for."""

import math

import numpy as np
import pytest
import torch
from effect_bench import Bench
from gear_case import GearCase

from gear_damping.physics.effects.second_mode import SecondMode

CASE = GearCase()
SECOND_MODE = {"stiffness": 9.0, "second_mode.mass_ratio": 0.2, "second_mode.frequency": 1.0}
CONSTANT = {"fourier_mesh_stiffness.maximum": 3e8, "fourier_mesh_stiffness.minimum": 3e8}


def jacobian(bench: Bench) -> np.ndarray:
    """Of the rates by the states, in SI, at the bench's first instant."""
    names = ["displacement", "velocity", *bench.equation.extra_names]
    rest = torch.stack([s[:1] for s in (*bench.random(), *bench.rest_of_state())])
    units = ["m", "m/s"] + [u for e in bench.model.effects if hasattr(e, "states") for u in e.states.values()]
    scale = torch.stack([bench.unit(u) for u in units])

    def rates(state: torch.Tensor) -> torch.Tensor:
        at = bench.kinematics(bench.times()[:1], tuple(state))
        return torch.stack(bench.equation.rates(at, bench.prepared.base, bench.prepared.terms))

    found = torch.func.jacfwd(rates)(rest)[:, 0, :, 0]
    assert found.shape == (len(names),) * 2
    return (found * scale / bench.unit("s")).numpy()


def frequencies(matrix: np.ndarray) -> np.ndarray:
    """Natural frequencies in rad/s, ascending."""
    found = np.linalg.eigvals(matrix)
    return np.sort(found.imag[found.imag > 1])


pytestmark = pytest.mark.filterwarnings("ignore:`torch.jit.script` is deprecated:DeprecationWarning")


def test_the_bearing_couples_as_two_masses_on_two_springs():
    given = CONSTANT | {"bearing_flexibility.damping_ratio": 0.0, "bearing_flexibility.mass": 1.3}
    bench = Bench("bearing_flexibility", {}, given, batch=1)
    k, kb, m, mb = 3e8, 5e8, CASE.mass, 1.3
    matrix = np.array([[k / m, -k / m], [-k / mb, (k + kb) / mb]])
    np.testing.assert_allclose(frequencies(jacobian(bench)), np.sort(np.sqrt(np.linalg.eigvals(matrix))), rtol=1e-9)
    assert (bench.p["fastest_rate"] / bench.unit("s")).item() >= frequencies(jacobian(bench))[-1]


def test_the_bearing_alone_has_its_damping_ratio():
    given = CONSTANT | {"bearing_flexibility.damping_ratio": 0.1}
    bench = Bench("bearing_flexibility", {}, given, batch=1)
    matrix = jacobian(bench)
    assert -matrix[3, 3] == pytest.approx(2 * 0.1 * math.sqrt(5e8 / 2.0), rel=1e-9)


def test_the_bearing_starts_where_the_mean_load_holds_it():
    bench = Bench("bearing_flexibility", {}, CONSTANT, batch=1)
    place, velocity = bench.rest_of_state()
    assert place.item() == pytest.approx(CASE.mean_load / 5e8, rel=1e-12)
    x = torch.tensor([CASE.mean_load / 3e8 + CASE.mean_load / 5e8], dtype=torch.float64)
    at = bench.kinematics(torch.zeros(1, dtype=torch.float64), (x, 0 * x, place, velocity))
    rates = bench.equation.rates(at, bench.prepared.base, bench.prepared.terms)
    assert all(abs(rate.item()) < 1e-12 for rate in rates)


def test_unbalance_presses_on_the_bearing():
    given = CONSTANT | {"unbalance.unbalance": 3e-5, "unbalance.phase": 0.4, "pinion_angle": 0.2}
    bench, without = Bench("unbalance", {}, given), Bench("bearing_flexibility", {}, CONSTANT)
    forces = []
    for here in (bench, without):
        at = here.kinematics(here.times(), (*here.random(), *here.rest_of_state()))
        rate = here.equation.rates(at, here.prepared.base, here.prepared.terms)[3]
        forces.append(rate * here.unit("m/s^2") * 2.0)
    angle = 0.2 + CASE.pinion_speed * bench.times().numpy()
    wanted = 3e-5 * CASE.pinion_speed**2 * np.cos(angle + 0.4)
    np.testing.assert_allclose((forces[0] - forces[1]).numpy(), wanted, atol=1e-6 * np.abs(wanted).max())


@pytest.mark.parametrize("mode", ["balanced", "held"])
def test_shaft_torsion_is_three_inertias_in_a_row(mode):
    given = CONSTANT | {"shaft_torsion.damping_ratio": 0.0, "shaft_torsion.motor_inertia": 3e-3, "gear_torque": 300.0}
    bench = Bench("shaft_torsion", {}, given, system_options={"gear_torque_mode": mode}, batch=1)
    k, ks, r1, r2 = 3e8, 2000.0, *CASE.base_radii
    i0, i1, i2 = 3e-3, CASE.inertia_pinion, CASE.inertia_gear
    stiffness = np.array([[ks, -ks, 0], [-ks, ks + k * r1 * r1, -k * r1 * r2], [0, -k * r1 * r2, k * r2 * r2]])
    squares = np.sort(np.linalg.eigvals(np.diag([1 / i0, 1 / i1, 1 / i2]) @ stiffness).real)
    np.testing.assert_allclose(frequencies(jacobian(bench)), np.sqrt(squares[1:]), rtol=1e-8)
    assert (bench.p["fastest_rate"] / bench.unit("s")).item() >= np.sqrt(squares[-1])


@pytest.mark.parametrize("mode", ["balanced", "held"])
def test_shaft_torsion_follows_the_torques_on_the_three_bodies(mode):
    given = {"gear_torque": 280.0, "shaft_torsion.damping_ratio": 0.05, "torque_variation.step_times": [0.004, 0.01]}
    given |= {"torque_variation.step_changes": [30.0, -60.0]}
    options = {"gear_torque_mode": mode}
    bench = Bench("shaft_torsion", {}, given, others=("torque_variation",), system_options=options)
    source = np.random.default_rng(2)
    twist, rate = 0.07 + 0.02 * source.standard_normal(bench.batch), 5 * source.standard_normal(bench.batch)
    at = bench.kinematics(bench.times(), (*bench.random(), torch.as_tensor(twist), torch.as_tensor(rate)))
    rates = bench.equation.rates(at, bench.prepared.base, bench.prepared.terms)
    time, force = bench.times().numpy(), (at.mesh_force * bench.unit("N")).numpy()
    r1, r2 = CASE.base_radii
    i1, i2, motor = CASE.inertia_pinion, CASE.inertia_gear, 0.01
    reflected = i1 + i2 * (r1 / r2) ** 2
    damping = 2 * 0.05 * math.sqrt(2000.0 / (1 / motor + 1 / reflected))
    torque_1 = 150.0 + 30.0 * (time > 0.004) - 60.0 * (time > 0.01)
    torque_2 = torque_1 * r2 / r1 if mode == "balanced" else 280.0
    shaft = 2000.0 * twist + damping * rate
    pinion = (shaft - r1 * force) / i1
    gear = (r2 * force - torque_2) / i2
    acceleration = (rates[1] * bench.unit("m/s^2")).numpy()
    np.testing.assert_allclose(acceleration, r1 * pinion - r2 * gear, rtol=1e-8, atol=1e-6 * np.abs(pinion).max() * r1)
    turn = (rates[3] * bench.unit("rad/s^2")).numpy()
    np.testing.assert_allclose(turn, (torque_1 - shaft) / motor - pinion, rtol=1e-8)


@pytest.mark.parametrize("mode", ["balanced", "held"])
def test_torsion_of_the_gears_shaft_is_three_inertias_in_a_row(mode):
    given = CONSTANT | {"shaft_torsion.damping_ratio": 0.0, "shaft_torsion.motor_inertia": 7e-3, "gear_torque": 300.0}
    bench = Bench("shaft_torsion", {"shaft": "gear"}, given, system_options={"gear_torque_mode": mode}, batch=1)
    k, ks, r1, r2 = 3e8, 2000.0, *CASE.base_radii
    i1, i2, i3 = CASE.inertia_pinion, CASE.inertia_gear, 7e-3
    stiffness = np.array([[k * r1 * r1, -k * r1 * r2, 0], [-k * r1 * r2, ks + k * r2 * r2, -ks], [0, -ks, ks]])
    squares = np.sort(np.linalg.eigvals(np.diag([1 / i1, 1 / i2, 1 / i3]) @ stiffness).real)
    np.testing.assert_allclose(frequencies(jacobian(bench)), np.sqrt(squares[1:]), rtol=1e-8)
    assert (bench.p["fastest_rate"] / bench.unit("s")).item() >= np.sqrt(squares[-1])


@pytest.mark.parametrize("mode", ["balanced", "held"])
def test_torsion_of_the_gears_shaft_follows_the_torques_on_the_three_bodies(mode):
    given = {"gear_torque": 280.0, "shaft_torsion.damping_ratio": 0.05}
    options = {"gear_torque_mode": mode}
    bench = Bench("shaft_torsion", {"shaft": "gear"}, given, system_options=options)
    source = np.random.default_rng(3)
    twist, rate = 0.14 + 0.04 * source.standard_normal(bench.batch), 5 * source.standard_normal(bench.batch)
    at = bench.kinematics(bench.times(), (*bench.random(), torch.as_tensor(twist), torch.as_tensor(rate)))
    rates = bench.equation.rates(at, bench.prepared.base, bench.prepared.terms)
    force = (at.mesh_force * bench.unit("N")).numpy()
    r1, r2 = CASE.base_radii
    i1, i2, brake = CASE.inertia_pinion, CASE.inertia_gear, 0.01
    damping = 2 * 0.05 * math.sqrt(2000.0 / (1 / brake + 1 / (i2 + i1 * (r2 / r1) ** 2)))
    torque = 150.0 * r2 / r1 if mode == "balanced" else 280.0
    shaft = 2000.0 * twist + damping * rate
    pinion, gear = (150.0 - r1 * force) / i1, (r2 * force - shaft) / i2
    acceleration = (rates[1] * bench.unit("m/s^2")).numpy()
    np.testing.assert_allclose(acceleration, r1 * pinion - r2 * gear, rtol=1e-8, atol=1e-6 * np.abs(pinion).max() * r1)
    turn = (rates[3] * bench.unit("rad/s^2")).numpy()
    np.testing.assert_allclose(turn, gear - (shaft - torque) / brake, rtol=1e-8)
    assert bench.rest_of_state()[0].numpy() == pytest.approx(torque / 2000.0)


def test_the_shaft_starts_twisted_by_the_mean_torque():
    bench = Bench("shaft_torsion", batch=1)
    assert bench.rest_of_state()[0].item() == pytest.approx(150.0 / 2000.0, rel=1e-12)
    at = bench.evaluated()
    assert (at.load * bench.unit("N")).item() == pytest.approx(CASE.mean_load, rel=1e-9)


def hysteresis_cycle(amplitude: float, cycle_time: float, steps: int = 4000) -> tuple[np.ndarray, np.ndarray]:
    """Deflection and force over the second cycle of an imposed harmonic motion (SI, oscillator of k = 1)."""
    bench = Bench("hysteretic_damping", {}, {"hysteretic_damping.yield_deflection": 0.05}, batch=1)
    omega, step = 2 * math.pi / cycle_time, cycle_time / steps
    z = torch.zeros(1, dtype=torch.float64)

    def rate(time: float, z: torch.Tensor) -> torch.Tensor:
        x, v = amplitude * math.sin(omega * time), amplitude * omega * math.cos(omega * time)
        state = (torch.full_like(z, x), torch.full_like(z, v), z)
        at = bench.kinematics(torch.zeros_like(z), state)
        return bench.equation.rates(at, bench.prepared.base, bench.prepared.terms)[2]

    found = []
    for n in range(2 * steps):
        middle = z + step / 2 * rate(n * step, z)
        z = z + step * rate((n + 0.5) * step, middle)
        found.append(z.item())
    return amplitude * np.sin(omega * step * np.arange(steps + 1, 2 * steps + 1)), 0.02 * np.array(found[steps:])


def test_hysteresis_loses_the_same_at_every_rate():
    losses = []
    for cycle_time in (1.0, 50.0):
        x, force = hysteresis_cycle(1.0, cycle_time, 1500)
        losses.append(np.sum(force * (np.roll(x, -1) - np.roll(x, 1)) / 2))
    assert losses[0] == pytest.approx(losses[1], rel=1e-9)
    # far beyond the yield deflection the loop is a rectangle, its corners rounded over some z_y
    assert losses[0] == pytest.approx(4 * 0.02 * 0.05, rel=0.05)


def test_hysteresis_gives_back_less_than_it_stored():
    source = torch.Generator().manual_seed(4)
    bench = Bench("hysteretic_damping", batch=500)
    z = 2e-6 * (2 * torch.rand(500, generator=source, dtype=torch.float64) - 1)
    at = bench.kinematics(bench.times(), (*bench.random(), z))
    rates = bench.equation.rates(at, bench.prepared.base, bench.prepared.terms)
    stored = bench.effect.damping_force(at, bench.p) * rates[2]  # d/dt of stiffness z^2 / 2
    lost = bench.effect.damping_force(at, bench.p) * at.delta_rate - stored
    assert (lost >= -1e-15).all()
    assert (lost > 0).any()


def test_hysteresis_relaxes_while_the_teeth_are_apart():
    bench = Bench("hysteretic_damping", others=("backlash",), batch=1)
    z = torch.tensor([1.5e-6], dtype=torch.float64)
    at = bench.kinematics(bench.times(), (torch.full_like(z, -3e-5), torch.full_like(z, 0.3), z))
    rate = bench.equation.rates(at, bench.prepared.base, bench.prepared.terms)[2] * bench.unit("m/s")
    assert rate.item() == pytest.approx(-1.5e-6 * CASE.natural_frequency, rel=1e-9)


def test_a_second_mode_couples_as_a_mass_on_the_first_one():
    given = SECOND_MODE | {"second_mode.damping_ratio": 0.0}
    bench = Bench("second_mode", {}, given, batch=1)
    spring = (2 * math.pi) ** 2
    matrix = np.array([[9.0 + 0.2 * spring, -0.2 * spring], [-spring, spring]])
    np.testing.assert_allclose(frequencies(jacobian(bench)), np.sort(np.sqrt(np.linalg.eigvals(matrix))), rtol=1e-9)
    assert (bench.p["fastest_rate"] / bench.unit("s")).item() >= frequencies(jacobian(bench))[-1]


def test_a_second_mode_damps_by_the_rate_between_the_masses():
    matrix = jacobian(Bench("second_mode", {}, SECOND_MODE | {"second_mode.damping_ratio": 0.1}, batch=1))
    damper = 2 * 0.1 * 2 * math.pi
    assert matrix[3, 3] == pytest.approx(-damper, rel=1e-9)
    assert matrix[1, 3] == pytest.approx(0.2 * damper, rel=1e-9)
    assert matrix[3, 1] == pytest.approx(damper, rel=1e-9)


def test_a_second_mass_is_braked_by_the_ground_too():
    given = SECOND_MODE | {"second_mode.damping_ratio": 0.1, "second_mode.drag_rate": 3.0}
    matrix = jacobian(Bench("second_mode", {}, given, batch=1))
    damper = 2 * 0.1 * 2 * math.pi
    assert matrix[3, 3] == pytest.approx(-damper - 3.0, rel=1e-9)
    assert (matrix[1, 3], matrix[3, 1]) == pytest.approx((0.2 * damper, damper), rel=1e-9)
    own = {name.partition(".")[2]: value for name, value in given.items() if "." in name}
    poles = SecondMode.cause.modes(own, 9.0, -matrix[1, 1] - 0.2 * damper)
    both = np.linalg.eigvals(matrix)
    np.testing.assert_allclose(np.sort_complex(poles), np.sort_complex(both[both.imag > 0]), rtol=1e-9)
