"""The same trajectories for values on a GPU, where there is one."""

import pytest
import torch

from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

pytestmark = pytest.mark.skipif(not torch.cuda.is_available(), reason="this machine has no GPU")


def test_a_gpu_gives_the_trajectories_of_the_cpu(bench_model):
    model, values = bench_model
    here = values(64)
    there = {name: value.cuda() for name, value in here.items()}
    torque = here["pinion_torque"].unsqueeze(1).expand(64, 200).clone()
    run = {"sampling_rate": 40e3, "n_samples": 200, "solver": Solver(acceleration=True)}
    found = simulate(model, there, inputs={"pinion_torque": torque.cuda()}, **run)
    expected = simulate(model, here, inputs={"pinion_torque": torque}, **run)
    assert found.response.is_cuda
    for name, states in expected.states.items():
        assert (found.states[name].cpu() - states).abs().amax() < 1e-9 * states.abs().amax(), name
