"""The same trajectories on a GPU, where there is one."""

import pytest
import torch

from gear_damping.simulation.simulate import simulate

pytestmark = pytest.mark.skipif(not torch.cuda.is_available(), reason="this machine has no GPU")


def test_a_gpu_gives_the_trajectories_of_the_cpu(bench_model):
    model, values = bench_model
    here = values(64)
    there = {name: value.cuda() for name, value in here.items()}
    run = {"sampling_rate": 40e3, "n_samples": 200}
    found, expected = simulate(model, there, **run), simulate(model, here, **run)
    assert found.response.is_cuda
    torch.testing.assert_close(found.response.cpu(), expected.response, rtol=1e-9, atol=1e-15)
