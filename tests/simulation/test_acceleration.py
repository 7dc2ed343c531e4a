"""The acceleration is the right-hand side of the equation of motion at the outputs."""

import closed_forms
import numpy as np
import pytest
import torch

from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

KEPT = Solver(acceleration=True)

RATE = 2 * np.pi * 70


@pytest.mark.parametrize("ratio", [0.0, 0.05])
def test_free_decay(free_oscillator, ratio):
    """x'' = -c x' - k x, first sample included, with only 3 samples a period."""
    model, values = free_oscillator(ratio, RATE)
    runs = simulate(model, values, sampling_rate=210, n_samples=200, solver=Solver(accuracy=1e-8, acceleration=True))
    damping = 2 * ratio * RATE
    x, v = closed_forms.free_decay(runs.time.numpy(), 1.0, damping, RATE**2, 1e-3, 0.2e-3 * RATE)
    expected = -damping * v - RATE**2 * x
    np.testing.assert_allclose(runs.states["acceleration"][0], expected, atol=1e-7 * 1e-3 * RATE**2)


def test_forced_response():
    """Steady state under a tone: x'' = -w^2 x."""
    frequency, ratio, n = 2 * np.pi * 55, 0.05, 4000
    model = Model(Oscillator(), [effect_class("viscous_damping")()])
    times = np.arange(n) / 2000
    damping = {"viscous_damping.damping_coefficient": 2 * ratio * RATE}
    values = model.values(1, stiffness=RATE**2, amplitude=1e-5, **damping)
    force = torch.as_tensor(np.sin(frequency * times)).unsqueeze(0)
    runs = simulate(model, values, sampling_rate=2000, n_samples=n, inputs={"force": force}, solver=KEPT)
    response = -(frequency**2) / (RATE**2 - frequency**2 + 2j * ratio * RATE * frequency)
    expected = np.imag(response * np.exp(1j * frequency * times))
    settled = slice(n // 2, n - 100)
    assert np.abs(runs.channel("acceleration")[0].numpy()[settled] - expected[settled]).max() < 1e-5 * abs(response)


def loose_pair(name):
    """A gear pair that loses contact, with one more effect that switches or has states of its own."""
    names = dict.fromkeys(("power_law_damping", "backlash", name))
    if not name.endswith("mesh_stiffness"):
        names = {"fourier_mesh_stiffness": None, **names}
    model = Model(GearPair(), [effect_class(name)() for name in names])
    start = torch.tensor([1e-6, 2.5e-5, 5e-5], dtype=torch.float64)
    return model, model.values(3, initial_displacement=start, pinion_torque=60.0)


@pytest.mark.usefixtures("compiler")
@pytest.mark.parametrize("name", ["backlash", "rectangular_mesh_stiffness", "tooth_friction", "bearing_flexibility"])
def test_native_equals_torch(name):
    model, values = loose_pair(name)
    torque = 60 + 40 * torch.sin(torch.arange(30, dtype=torch.float64) / 7).unsqueeze(0)
    run = {"sampling_rate": 40e3, "n_samples": 30, "inputs": {"pinion_torque": torque}}
    solvers = [Solver(substeps=3, engine=engine, acceleration=True) for engine in ("native", "eager")]
    native, eager = (simulate(model, values, solver=solver, **run) for solver in solvers)
    assert (native.response < 0).any()
    for state in eager.states:
        scale = float(eager.states[state].abs().max())
        torch.testing.assert_close(native.states[state], eager.states[state], rtol=1e-8, atol=1e-10 * scale)


def test_members_of_other_steps_keep_their_own(bench_model):
    """More members than a vector has lanes, in two groups of sub-steps and several blocks of outputs."""
    model, values = bench_model
    given = values(21)
    given["inertia_pinion"] = given["inertia_pinion"] * torch.tensor([1.0, 0.02, 1.0]).repeat(7)
    run = {"sampling_rate": 40e3, "n_samples": 150, "solver": KEPT}
    together = simulate(model, given, **run).states["acceleration"]
    for i in (0, 1, 20):
        alone = simulate(model, {k: v[..., i : i + 1] for k, v in given.items()}, **run).states["acceleration"]
        torch.testing.assert_close(together[i], alone[0], rtol=1e-7, atol=1e-9 * float(alone.abs().max()))


@pytest.mark.parametrize("name", ["backlash", "rectangular_mesh_stiffness", "torque_variation", "shaft_torsion"])
def test_the_velocity_of_a_fine_run_has_this_slope(name):
    """Central differences of four points at 2 MHz, away from the few samples at which a branch changes."""
    rate = 2e6
    model, values = loose_pair(name)
    runs = simulate(model, values, sampling_rate=rate, n_samples=2000, solver=Solver(substeps=1, acceleration=True))
    v, found = runs.states["velocity"], runs.states["acceleration"]
    slope = (8 * (v[:, 3:-1] - v[:, 1:-3]) - (v[:, 4:] - v[:, :-4])) * rate / 12
    error = (slope - found[:, 2:-2]).abs() / found.std()
    assert float(error.quantile(0.9)) < 1e-6
    assert float(error.mean()) < 1e-3


def test_the_first_sample_is_on_the_branch_of_the_start():
    """In the gap only the load accelerates; in contact the mesh pushes back."""
    model, values = loose_pair("backlash")
    values["initial_displacement"] = torch.tensor([-1e-5, 1e-6, 2e-5], dtype=torch.float64)
    runs = simulate(model, values, sampling_rate=40e3, n_samples=2, solver=KEPT)
    first = runs.states["acceleration"][:, 0] * runs.derived["equivalent_mass"] / runs.derived["mean_load"]
    assert float(first[0]) == pytest.approx(1, rel=1e-9)
    assert float(first[1]) < 1
    assert float(first[2]) < -1


def test_it_is_not_there_unless_asked(bench_model):
    model, values = bench_model
    run = {"sampling_rate": 40e3, "n_samples": 30}
    without, asked = (simulate(model, values(3), solver=Solver(acceleration=wish), **run) for wish in (False, True))
    assert "acceleration" not in without.states
    assert torch.equal(without.response, asked.response)
    assert torch.equal(asked.keep(asked.good).states["acceleration"], asked.states["acceleration"])
