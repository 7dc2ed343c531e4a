"""Simulations against closed forms."""

import closed_forms
import numpy as np
import pytest
import torch

from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.equation import EquationOfMotion
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

RATE = 2 * np.pi * 70


@pytest.mark.parametrize("ratio", [0.0, 0.005, 0.3])
def test_free_decay(free_oscillator, ratio):
    model, values = free_oscillator(ratio, RATE)
    runs = simulate(model, values, sampling_rate=2000, n_samples=600, solver=Solver(accuracy=1e-8))
    times = runs.time.numpy()
    expected, speed = closed_forms.free_decay(times, 1.0, 2 * ratio * RATE, RATE**2, 1e-3, 0.2e-3 * RATE)
    np.testing.assert_allclose(runs.response[0], expected, atol=2e-8 * 1e-3)
    np.testing.assert_allclose(runs.states["velocity"][0], speed, atol=2e-8 * 1e-3 * RATE)


def test_forced_response_to_a_sampled_tone():
    frequency, ratio, n = 2 * np.pi * 55, 0.05, 4000
    model = Model(Oscillator(), [effect_class("viscous_damping")()])
    times = np.arange(n) / 2000
    force = torch.as_tensor(np.sin(frequency * times)).unsqueeze(0)
    damping = {"viscous_damping.damping_coefficient": 2 * ratio * RATE}
    values = model.values(1, stiffness=RATE**2, amplitude=1e-5, **damping)
    runs = simulate(model, values, sampling_rate=2000, n_samples=n, inputs={"force": force})
    response = 1 / (RATE**2 - frequency**2 + 2j * ratio * RATE * frequency)
    expected = np.imag(response * np.exp(1j * frequency * times))
    settled = slice(n // 2, n - 100)
    assert np.abs(runs.response[0].numpy()[settled] - expected[settled]).max() < 1e-5 * abs(response)


def test_energy_balance_of_a_power_law(free_oscillator):
    """What the damping took is the integral of its power."""
    model = Model(Oscillator(), [effect_class("power_law_damping")()])
    power = {"power_law_damping.coefficient": 0.4, "power_law_damping.exponent": 1.7}
    values = model.values(1, stiffness=RATE**2, amplitude=1.0, initial_displacement=1.0, **power)
    runs = simulate(model, values, sampling_rate=40000, n_samples=8001, solver=Solver(substeps=2))
    x, v = runs.response[0].numpy(), runs.states["velocity"][0].numpy()
    energy = v**2 / 2 + RATE**2 * x**2 / 2
    lost = np.trapezoid(0.4 * np.abs(v) ** 2.7, dx=1 / 40000)
    assert lost == pytest.approx(energy[0] - energy[-1], rel=1e-6)
    assert lost > 0.1 * energy[0]


def test_energy_of_the_equation_is_kinetic_plus_elastic(bench_model):
    model, values = bench_model
    given = values(3)
    prepared = model.prepare(given)
    equation = EquationOfMotion(model)
    zero = torch.zeros(3, dtype=torch.float64)
    state = (zero + 0.5, zero + 2.0)
    at = equation.kinematics(zero, state, {}, prepared.base)
    at.active_branch = {name: (g >= 0).double() for name, g in equation.switches(at, prepared.terms).items()}
    found = equation.energy(at, prepared.base, prepared.terms)
    stiffness = at.stiffness * prepared.scales.force / prepared.scales.length
    joule = stiffness * (0.5 * prepared.scales.length) ** 2 / 2
    joule = joule + prepared.derived["equivalent_mass"] * (2 * prepared.scales.velocity) ** 2 / 2
    torch.testing.assert_close(found * prepared.scales.force * prepared.scales.length, joule)


def test_static_deflection_under_constant_load(base_case):
    """A gear pair with a constant stiffness settles at F / k."""
    effects = [effect_class(name)() for name in ("fourier_mesh_stiffness", "viscous_damping")]
    from gear_damping.physics.systems.gear_pair import GearPair

    model = Model(GearPair(), effects)
    stiffness = {"fourier_mesh_stiffness.maximum": 3e8, "fourier_mesh_stiffness.minimum": 3e8}
    values = model.values(1, **stiffness, **{"viscous_damping.damping_coefficient": 9000.0})
    runs = simulate(model, values, sampling_rate=40e3, n_samples=800)
    expected = base_case.load_of(150.0) / 3e8
    assert float(runs.response[0, -1]) == pytest.approx(expected, rel=1e-9)
