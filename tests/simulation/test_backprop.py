"""Gradients by backpropagation: beside differences, through a network, in bounded memory."""

from dataclasses import replace
from typing import ClassVar

import pytest
import torch
from torch import Tensor

from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.physics.terms import ElasticForce
from gear_damping.simulation.backprop import simulate_with_gradient
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver


class NetworkForce(ElasticForce):
    """A restoring force that a small network says, from the deflection in natural units."""

    name = "network_force"
    equation = "F = network(delta)"
    reference = "a test"
    parameters: ClassVar = ()

    def __init__(self, seed: int) -> None:
        super().__init__()
        with torch.random.fork_rng():
            torch.manual_seed(seed)
            layers = (torch.nn.Linear(1, 8), torch.nn.Tanh(), torch.nn.Linear(8, 1, bias=False))
            self.network = torch.nn.Sequential(*layers).double()

    def elastic_force(self, at, p) -> Tensor:
        rest = self.network(torch.zeros(1, 1, dtype=torch.float64))
        return (self.network(at.deflection.unsqueeze(-1)) - rest).squeeze(-1)


def oscillator(*effects):
    model = Model(Oscillator(), [effect_class("viscous_damping")(), *effects])
    given = {"viscous_damping.damping_coefficient": 20.0, "initial_displacement": torch.tensor([1e-3, 2e-3])}
    return model, model.values(2, stiffness=2e5, amplitude=1e-3, **given)


NAMES = ("fourier_mesh_stiffness.maximum", "initial_displacement", "mesh_phase")


def gear_pair(*effects):
    model = Model(GearPair(), [effect_class("fourier_mesh_stiffness")(), *effects])
    start = torch.tensor([4.5e-5, 1.9e-5, 6e-5])
    return model, model.values(3, initial_displacement=start, pinion_torque=torch.tensor([140.0, 150.0, 160.0]))


def gradients(model, values, run, weights):
    given = {**values, **{name: values[name].clone().requires_grad_() for name in NAMES}}
    solver = replace(run.get("solver", Solver()), block=7)
    response = simulate_with_gradient(model, given, **run | {"solver": solver})
    torch.testing.assert_close(response.detach(), simulate(model, values, **run).response, rtol=1e-8, atol=1e-15)
    found = torch.autograd.grad((response * weights).sum(), [given[name] for name in NAMES])
    return dict(zip(NAMES, found, strict=True))


@pytest.mark.parametrize("damping", ["viscous_damping", "power_law_damping"])
def test_the_same_as_differences_of_fourth_order(damping):
    """Of a smooth equation to seven digits; a power of the speed bends at rest, where differences blur it."""
    model, values = gear_pair(effect_class(damping)())
    run = {"sampling_rate": 40e3, "n_samples": 40, "solver": Solver(substeps=2)}
    weights = torch.cos(torch.arange(40, dtype=torch.float64))

    def moved(name: str, by: Tensor) -> Tensor:
        return simulate(model, {**values, name: values[name] + by}, **run).response

    for name, found in gradients(model, values, run, weights).items():
        step = 1e-4 * values[name].abs().clamp(min=1e-1 if name == "mesh_phase" else 0)
        near, far = (moved(name, k * step) - moved(name, -k * step) for k in (1, 2))
        expected = ((8 * near - far) * weights).sum(1) / (12 * step)
        near_enough = 1e-7 if damping == "viscous_damping" else 1e-5
        torch.testing.assert_close(found, expected, rtol=near_enough, atol=near_enough * float(expected.abs().max()))


@pytest.mark.slow
def test_contact_loss_against_central_differences():
    model, values = gear_pair(effect_class("backlash")())
    run = {"sampling_rate": 40e3, "n_samples": 40, "solver": Solver(substeps=8, engine="eager")}
    weights = torch.cos(torch.arange(40, dtype=torch.float64))
    for name, found in gradients(model, values, run, weights).items():
        step = 1e-6 * values[name].abs().clamp(min=1e-1 if name == "mesh_phase" else 0)
        pair = [simulate(model, {**values, name: values[name] + s * step}, **run).response for s in (1, -1)]
        expected = ((pair[0] - pair[1]) * weights).sum(1) / (2 * step)
        torch.testing.assert_close(found, expected, rtol=1e-3, atol=1e-3 * float(expected.abs().max()))


def test_weights_of_a_network_against_central_differences():
    force = NetworkForce(seed=3)
    model, values = oscillator(force)
    run = {"sampling_rate": 2000, "n_samples": 90, "solver": Solver(substeps=2, block=10)}
    response = simulate_with_gradient(model, values, **run)
    torch.testing.assert_close(response.detach(), simulate(model, values, **run).response, rtol=1e-10, atol=1e-16)
    weight = force.network[2].weight
    (found,) = torch.autograd.grad((1e3 * response).square().sum(), weight)
    for k in (0, 5):
        sums = []
        for step in (1e-5, -1e-5):
            with torch.no_grad():
                weight[0, k] += step
                sums.append(float((1e3 * simulate(model, values, **run).response).square().sum()))
                weight[0, k] -= step
        assert float(found[0, k]) == pytest.approx((sums[0] - sums[1]) / 2e-5, rel=1e-6)


def test_two_networks_of_one_class_are_two_models():
    run = {"sampling_rate": 2000, "n_samples": 30}
    first, second = (simulate(*oscillator(NetworkForce(seed)), **run).response for seed in (0, 1))
    assert not torch.allclose(first, second)


@pytest.mark.slow
def test_a_network_learns_a_cubic_force():
    """Trained on the response alone, the network takes the place of a hidden cubic stiffness."""
    truth, values = oscillator(effect_class("cubic_stiffness")())
    stiffening = {**values, "cubic_stiffness.coefficient": torch.full((2,), 3e10, dtype=torch.float64)}
    run = {"sampling_rate": 1500, "n_samples": 60, "solver": Solver(substeps=2)}
    wanted = simulate(truth, stiffening, **run).response
    force = NetworkForce(seed=0)
    model, values = oscillator(force)
    optimiser = torch.optim.LBFGS(force.network.parameters(), max_iter=35, line_search_fn="strong_wolfe")
    losses = []

    def closure() -> Tensor:
        optimiser.zero_grad()
        loss = ((simulate_with_gradient(model, values, **run) - wanted) / wanted.std()).square().mean()
        loss.backward()
        losses.append(loss.item())
        return loss

    optimiser.step(closure)
    assert losses[-1] < 1e-2 * losses[0]


def test_a_block_bounds_what_the_graph_keeps():
    model, values = oscillator(NetworkForce(seed=0))

    def kept(block: int) -> int:
        count = 0

        def pack(tensor: Tensor) -> Tensor:
            nonlocal count
            count += 1
            return tensor

        with torch.autograd.graph.saved_tensors_hooks(pack, lambda tensor: tensor):
            simulate_with_gradient(model, values, sampling_rate=2000, n_samples=129, solver=Solver(block=block))
        return count

    assert kept(16) < 0.2 * kept(1)
