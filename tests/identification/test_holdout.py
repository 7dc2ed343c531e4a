"""Held-out records: only their start is found, and what an error of it leaves is kept apart from the model's."""

import math
from dataclasses import replace

import pytest
import torch

from gear_damping.identification.output_error.holdout import Frozen, _restarted, predict_holdout
from gear_damping.identification.output_error.least_squares import Rounds, fit
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FitRecord, FreeParameter, Observed
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.simulate import simulate

FREQUENCY, RATIO, RATE, NOISE = 10.0, 0.001, 200.0, 1e-3
OMEGA = 2 * math.pi * FREQUENCY
DAMPING = "viscous_damping.damping_coefficient"
MODEL = Model(Oscillator(), [effect_class("viscous_damping")()])


def record(seed):
    """The closed form of a free decay, with noise."""
    time = torch.arange(800, dtype=torch.float64) / RATE
    damped = OMEGA * math.sqrt(1 - RATIO**2)
    noise = NOISE * torch.randn(800, generator=torch.Generator().manual_seed(seed), dtype=torch.float64)
    return FitRecord("decay", 0.05 * torch.exp(-RATIO * OMEGA * time) * torch.cos(damped * time) + noise, RATE)


def held_out(damping_ratio):
    given = {"stiffness": OMEGA**2, DAMPING: 2 * damping_ratio * OMEGA}
    found = predict_holdout(Frozen(MODEL, given), [record(seed) for seed in range(8)], 1 / FREQUENCY)
    return torch.stack(found.residuals)


def test_the_right_model_leaves_the_noise_but_for_what_two_states_take():
    left = held_out(RATIO)
    assert float(left.square().mean()) == pytest.approx(NOISE**2 * (1 - 2 / 800), rel=0.02)
    first = float(left[:, :40].square().mean())  # a start that is found from all of a record is no worse there
    assert first == pytest.approx(NOISE**2, rel=0.15)


def test_what_is_wrong_with_the_model_stays():
    assert float(held_out(4 * RATIO).square().mean()) > 10 * NOISE**2


def test_a_prediction_that_runs_away_stays_what_it_is():
    with torch.no_grad():
        given = {"stiffness": -(OMEGA**2) * 1e4, "viscous_damping.damping_coefficient": -50.0}
        found = predict_holdout(Frozen(MODEL, given), [record(0)], 1 / FREQUENCY)
    assert len(found.residuals) == 1
    assert not bool(found.residuals[0].isfinite().all()) or float(found.residuals[0].abs().max()) > 1e3


def test_a_record_that_runs_away_from_its_first_guess_begins_nearer_to_rest():
    """A softening spring pushes away beyond .03 m; the records begin at .05 m and at .02 m."""
    model = Model(Oscillator(), [effect_class("viscous_damping")(), effect_class("cubic_stiffness")()])
    given = {"stiffness": OMEGA**2, "cubic_stiffness.coefficient": -(OMEGA**2) / 0.03**2, DAMPING: 2 * RATIO * OMEGA}
    far, near = record(0), replace(record(1), response=0.4 * record(1).response)
    problem = OutputErrorProblem(model, given, (), [far, near])
    shared = torch.zeros(problem.n_shared, dtype=torch.float64)
    guess, safe = problem.first_states(), problem.safe_states(shared)
    assert not bool(problem.residuals(shared[None], guess[None])[0, 0].isfinite().all())
    assert bool(problem.residuals(shared[None], safe[None]).isfinite().all())
    torch.testing.assert_close(safe[0], guess[0] / 2)
    torch.testing.assert_close(safe[1], guess[1])


def test_a_record_that_seems_to_start_wrong_is_restarted_from_rest():
    """A strongly damped record whose start is far off forgets it; the other one began right and stays as it is."""
    ratio, time = 0.1, torch.arange(800, dtype=torch.float64) / RATE
    decay = torch.exp(-ratio * OMEGA * time) * torch.cos(OMEGA * math.sqrt(1 - ratio**2) * time)
    noise = NOISE * torch.randn(2, 800, generator=torch.Generator().manual_seed(5), dtype=torch.float64)
    records = [FitRecord(name, 0.05 * decay + one, RATE) for name, one in zip("ab", noise, strict=True)]
    given = {"stiffness": OMEGA**2, DAMPING: 2 * ratio * OMEGA}
    problem = OutputErrorProblem(MODEL, given, (), records)
    shared, states = torch.zeros(1, problem.n_shared, dtype=torch.float64), problem.first_states()
    right = fit(problem, shared, Rounds(20), states.unsqueeze(0))
    off = right.states.clone()
    off[1] += 40.0 * (off[1].abs() + 1)
    wrong = fit(problem, shared, Rounds(0), off.unsqueeze(0))
    assert wrong.cost > 100 * right.cost
    assert _restarted(problem, wrong, 20).cost == pytest.approx(right.cost, rel=1e-6)
    assert _restarted(problem, right, 20) is right


@pytest.mark.parametrize("off", [-0.012, 0.009])
def test_a_gear_pair_whose_speed_is_uncertain_is_followed_from_where_its_mesh_begins(off):
    """Over .1 s the mesh runs ahead by a cycle and the resonance's harmonic by four: no small step leads back."""
    effects = [effect_class("fourier_mesh_stiffness")(), effect_class("viscous_damping")()]
    model, stated = Model(GearPair(), effects), 300.0
    given = {"pinion_torque": 150.0, DAMPING: 3000.0}
    true = given | {"pinion_speed": stated * (1 + off), "mesh_phase": 2.0}
    runs = simulate(model, model.values(1, **true), sampling_rate=50e3, n_samples=5000)
    noise = 1e-7 * torch.randn(5000, generator=torch.Generator().manual_seed(1), dtype=torch.float64)
    observed = Observed("transmission_error")
    own = (FreeParameter("pinion_speed", stated, 0.005 * stated, deviation=0.005 * stated, expected=stated),)
    record = FitRecord("run", runs.response[0] + noise, 50e3, {}, {"pinion_speed": stated}, observed=observed, own=own)
    angle = FreeParameter("mesh_phase", 0.0, per_record=True)
    found = predict_holdout(Frozen(model, given, (angle,), 1e-7), [record], 2e-4)
    assert found.own["pinion_speed@run"] == pytest.approx(true["pinion_speed"], rel=1e-5)
    assert float(found.residuals[0].std()) == pytest.approx(1e-7, rel=0.05)
