"""The oscillator on a base that moves, and its units where there is no spring."""

import numpy as np
import pytest
import torch

from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

RATE, DAMPING = 2 * np.pi * 7, 6.0


def model(*names):
    return Model(Oscillator(), [effect_class(name)() for name in names])


def seismic(engine="auto", **inputs):
    """The relative displacement of a damped mass, (time,), over 8 s at 200 Hz."""
    damped = model("viscous_damping")
    values = damped.values(1, stiffness=RATE**2, amplitude=0.1, force_gain=2.5, **{DAMPER: DAMPING})
    series = {name: torch.as_tensor(value).unsqueeze(0) for name, value in inputs.items()}
    return simulate(damped, values, sampling_rate=200, n_samples=1600, inputs=series, solver=Solver(engine=engine))


DAMPER = "viscous_damping.damping_coefficient"
TIMES = np.arange(1600) / 200
TONE = 2 * np.pi * 5.3


def test_a_base_that_shakes():
    """z'' + c z' + k z = -a_b: the relative motion of a seismometer in its steady state."""
    found = seismic(base_acceleration=np.sin(TONE * TIMES)).response[0].numpy()
    expected = np.imag(-np.exp(1j * TONE * TIMES) / (RATE**2 - TONE**2 + 1j * DAMPING * TONE))
    assert np.abs(found - expected)[800:1500].max() < 1e-5 * np.abs(expected).max()


@pytest.mark.parametrize("engine", ["auto", "eager"])
def test_force_and_base_together_are_one_load(engine):
    force, base = np.sin(TONE * TIMES), np.cos(2.7 * TIMES)
    both = seismic(engine, force=force, base_acceleration=base).response
    as_force = seismic(engine, force=force - base / 2.5).response
    torch.testing.assert_close(both, as_force, rtol=0, atol=1e-12)


@pytest.mark.parametrize("unit", [0.0, 1e-3, 0.04, 1.0, 30.0])
def test_another_unit_of_time_gives_the_same_motion(unit):
    """A free decay of 55 periods: what the solver counts in must not be seen, nor how exact it is."""
    damped = model("viscous_damping")
    given = {"initial_displacement": 0.1, DAMPER: 0.5}
    values = damped.values(1, stiffness=RATE**2, amplitude=0.1, characteristic_time=unit, **given)
    runs = simulate(damped, values, sampling_rate=50, n_samples=400)
    root = -0.25 + 1j * np.sqrt(RATE**2 - 0.25**2)
    expected = 0.1 * np.real((1 + 0.25j / root.imag * -1) * np.exp(root * runs.time.numpy()))
    assert np.linalg.norm(runs.response[0].numpy() - expected) < 1e-5 * np.linalg.norm(expected)


@pytest.mark.parametrize("rate", [1e-2, 3.0, 400.0])
@pytest.mark.parametrize("unit", [0.0, 0.2])
def test_a_body_without_a_spring_coasts_down(rate, unit):
    """v = v0 exp(-c t): fast against the samples, or slow."""
    coasting = model("viscous_damping")
    values = coasting.values(1, stiffness=0.0, characteristic_time=unit, initial_velocity=2.0, **{DAMPER: rate})
    runs = simulate(coasting, values, sampling_rate=50, n_samples=200)
    expected = 2 / rate * -np.expm1(-rate * runs.time.numpy())
    assert np.linalg.norm(runs.response[0].numpy() - expected) < 1e-5 * np.linalg.norm(expected)


@pytest.mark.parametrize("name", ["coulomb_friction", "asymmetric_friction"])
def test_the_width_of_friction_follows_the_unit_of_velocity(name):
    """v' = -F tanh(v / u), u = w amplitude / T: sinh(v / u) = sinh(v0 / u) exp(-F t / u)."""
    force, width, amplitude, unit, start = 0.8, 0.05, 3.0, 0.5, 2.0
    names = ("force",) if name == "coulomb_friction" else ("force_forward", "force_backward")
    own = {f"{name}.{key}": force for key in names} | {f"{name}.width": width}
    rubbing = model(name)
    base = {"stiffness": 0.0, "amplitude": amplitude, "characteristic_time": unit, "initial_velocity": start}
    runs = simulate(rubbing, rubbing.values(1, **base, **own), sampling_rate=100, n_samples=400)
    scale = width * amplitude / unit
    expected = scale * np.arcsinh(np.sinh(start / scale) * np.exp(-force * runs.time.numpy() / scale))
    np.testing.assert_allclose(runs.states["velocity"][0], expected, atol=2e-5 * start)
    assert expected[-1] < 0.05 * scale


def test_reference_velocity():
    given = {"stiffness": torch.tensor([25.0, 0.0, 0.0]), "characteristic_time": torch.tensor([7.0, 0.5, 0.0])}
    free = model()
    runs = simulate(free, free.values(3, amplitude=3.0, **given), sampling_rate=10, n_samples=3)
    assert runs.reference_velocity.tolist() == [15.0, 6.0, 3.0]
