"""Forward sensitivities against closed forms and central differences."""

import numpy as np
import pytest
import torch

from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.sensitivities import simulate_sensitivities
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

NAMES = [
    "power_law_damping.coefficient",
    "power_law_damping.exponent",
    "fourier_mesh_stiffness.maximum",
    "mesh_phase",
    "pinion_torque",
    "initial_displacement",
]


def asking(values, names):
    """The values, these of which ask for gradients."""
    return {**values, **{name: values[name].clone().requires_grad_() for name in names}}


def test_an_undamped_oscillator_in_closed_form():
    """x = x0 cos(w t): dx/dk = -x0 t sin(w t) / (2 w), dx/dx0 = cos(w t)."""
    rate = 2 * np.pi * 70
    model = Model(Oscillator(), [])
    values = model.values(2, stiffness=rate**2, amplitude=1e-3, initial_displacement=2e-3)
    asked = asking(values, ["stiffness", "initial_displacement"])
    found = simulate_sensitivities(model, asked, sampling_rate=2000, n_samples=400, solver=Solver(accuracy=1e-9))
    times = torch.arange(400, dtype=torch.float64) / 2000
    by_stiffness = -2e-3 * times * torch.sin(rate * times) / (2 * rate)
    torch.testing.assert_close(found.by_parameter["stiffness"][1], by_stiffness, rtol=1e-6, atol=1e-7 * 2e-3 / rate**2)
    torch.testing.assert_close(
        found.by_parameter["initial_displacement"][0], torch.cos(rate * times), rtol=0, atol=1e-7
    )


@pytest.mark.parametrize("engine", ["auto", pytest.param("eager", marks=pytest.mark.slow)])
@pytest.mark.parametrize("loose", [False, True])
def test_a_gear_pair_against_central_differences(engine, loose):
    """With backlash: elastic forces are continuous where the flanks part, so the derivatives stay exact."""
    names = [*NAMES] if not loose else ["fourier_mesh_stiffness.maximum", "initial_displacement"]
    effects = [effect_class("fourier_mesh_stiffness")()]
    effects += [effect_class("backlash")()] if loose else [effect_class("power_law_damping")()]
    model = Model(GearPair(), effects)
    start = 4.5e-5 if loose else 1.9e-5
    values = model.values(3, initial_displacement=start, pinion_torque=torch.tensor([140.0, 150.0, 160.0]))
    run = {"sampling_rate": 40e3, "n_samples": 40, "solver": Solver(substeps=8, engine=engine)}
    found = simulate_sensitivities(model, asking(values, names), **run)
    torch.testing.assert_close(found.response, simulate(model, values, **run).response, rtol=1e-9, atol=1e-15)
    for name in names:
        step = 1e-5 * values[name].abs().clamp(min=1e-2 if name == "mesh_phase" else 0)
        pair = [simulate(model, {**values, name: values[name] + s * step}, **run).response for s in (1, -1)]
        expected = (pair[0] - pair[1]) / (2 * step.unsqueeze(1))
        scale = float(expected.abs().max())
        torch.testing.assert_close(found.by_parameter[name], expected, rtol=0, atol=(1e-3 if loose else 2e-6) * scale)


def test_measured_inputs_are_differentiated_with_their_units():
    """The natural unit of force moves with the stiffness; the derivative in SI must not notice."""
    model = Model(Oscillator(), [effect_class("viscous_damping")()])
    given = {"viscous_damping.damping_coefficient": 40.0}
    values = model.values(1, stiffness=2e5, force_gain=3.0, amplitude=1e-3, **given)
    force = torch.sin(torch.arange(300, dtype=torch.float64) / 5).unsqueeze(0)
    run = {"sampling_rate": 1000, "n_samples": 300, "inputs": {"force": force}, "solver": Solver(substeps=8)}
    found = simulate_sensitivities(model, asking(values, ["stiffness", "force_gain"]), **run)
    torch.testing.assert_close(found.by_parameter["force_gain"] * 3.0, found.response, rtol=1e-9, atol=1e-18)
    pair = [simulate(model, {**values, "stiffness": values["stiffness"] + s}, **run).response for s in (1.0, -1.0)]
    expected = (pair[0] - pair[1]) / 2
    torch.testing.assert_close(
        found.by_parameter["stiffness"], expected, rtol=0, atol=1e-7 * float(expected.abs().max())
    )


def test_unknown_and_listed_parameters_are_refused(bench_model):
    model, values = bench_model
    grid = {"sampling_rate": 40e3, "n_samples": 5}
    with pytest.raises(ValueError, match="nonsense"):
        simulate_sensitivities(model, asking(values(2) | {"nonsense": torch.zeros(2)}, ["nonsense"]), **grid)
    with pytest.raises(ValueError, match="got none"):
        simulate_sensitivities(model, values(2), **grid)
