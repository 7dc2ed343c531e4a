"""A member's trajectory is its own, whatever its batch-mates; bad members are named, not spread."""

import pytest
import torch

from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

RUN = {"sampling_rate": 40e3, "n_samples": 300}


def pick(values, index):
    return {name: value[..., index] for name, value in values.items()}


@pytest.mark.parametrize("engine", ["auto", "eager"])
def test_identical_alone_permuted_and_together(bench_model, engine):
    model, values = bench_model
    given = values(11)
    samples = RUN if engine == "auto" else RUN | {"n_samples": 60}
    solver = Solver(engine=engine)
    together = simulate(model, given, solver=solver, **samples).response
    order = torch.tensor([7, 3, 0, 10, 5, 1, 9, 2, 8, 6, 4])
    permuted = simulate(model, pick(given, order), solver=solver, **samples).response
    alone = simulate(model, pick(given, torch.tensor([4])), solver=solver, **samples).response
    torch.testing.assert_close(permuted, together[order], rtol=0, atol=0)
    torch.testing.assert_close(alone[0], together[4], rtol=0, atol=0)


def test_members_with_other_rates_get_their_own_steps(bench_model):
    """Sub-steps follow from each member's own parameters."""
    model, values = bench_model
    given = values(4)
    given["inertia_pinion"] = given["inertia_pinion"] * torch.tensor([1.0, 0.02, 1.0, 0.02], dtype=torch.float64)
    together = simulate(model, given, **RUN).response
    for i in range(4):
        alone = simulate(model, pick(given, torch.tensor([i])), **RUN).response[0]
        torch.testing.assert_close(alone, together[i], rtol=0, atol=0)


def test_chunks_change_nothing(bench_model):
    model, values = bench_model
    whole = simulate(model, values(9), **RUN).response
    chunked = simulate(model, values(9), solver=Solver(chunk=2), **RUN).response
    torch.testing.assert_close(chunked, whole, rtol=0, atol=0)


def test_a_diverged_member_is_counted_and_harms_nobody(bench_model):
    model, values = bench_model
    given = values(5)
    clean = simulate(model, given, **RUN).response
    given["power_law_damping.coefficient"] = given["power_law_damping.coefficient"].clone()
    given["power_law_damping.coefficient"][2] = -1e6
    runs = simulate(model, given, **RUN)
    assert runs.n_diverged == 1
    assert runs.good.tolist() == [True, True, False, True, True]
    kept = runs.keep(runs.good)
    torch.testing.assert_close(kept.response, clean[runs.good], rtol=0, atol=0)
    assert len(kept.values["pinion_torque"]) == 4
