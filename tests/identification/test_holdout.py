"""Held-out records: only their start is found, and what an error of it leaves is kept apart from the model's."""

import math

import pytest
import torch

from gear_damping.identification.output_error.holdout import predict_holdout
from gear_damping.identification.output_error.problem import FitRecord
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator

FREQUENCY, RATIO, RATE, NOISE = 10.0, 0.001, 200.0, 1e-3
OMEGA = 2 * math.pi * FREQUENCY
MODEL = Model(Oscillator(), [effect_class("viscous_damping")()])


def record(seed):
    """The closed form of a free decay, with noise."""
    time = torch.arange(800, dtype=torch.float64) / RATE
    damped = OMEGA * math.sqrt(1 - RATIO**2)
    noise = NOISE * torch.randn(800, generator=torch.Generator().manual_seed(seed), dtype=torch.float64)
    return FitRecord("decay", 0.05 * torch.exp(-RATIO * OMEGA * time) * torch.cos(damped * time) + noise, RATE)


def held_out(damping_ratio):
    records = [record(seed) for seed in range(8)]
    given = {"stiffness": OMEGA**2, "viscous_damping.damping_coefficient": 2 * damping_ratio * OMEGA}
    found = predict_holdout(MODEL, given, 0.0, records, FREQUENCY)
    whole = torch.stack([r.response - p for r, p in zip(records, found.predictions, strict=True)])
    return whole, torch.stack(found.beside_start)


def test_the_right_model_leaves_the_noise_beside_the_error_of_its_start():
    whole, beside = held_out(RATIO)
    assert float(beside.std()) == pytest.approx(NOISE, rel=0.02)
    assert float(whole.square().mean()) > 1.04 * NOISE**2  # few samples tell the start, and it goes on


def test_what_is_wrong_with_the_model_stays():
    whole, beside = held_out(4 * RATIO)
    assert float(whole.square().mean()) > float(beside.square().mean()) > 10 * NOISE**2


def test_a_prediction_that_runs_away_stays_what_it_is():
    with torch.no_grad():
        given = {"stiffness": -(OMEGA**2) * 1e4, "viscous_damping.damping_coefficient": -50.0}
        found = predict_holdout(MODEL, given, 0.0, [record(0)], FREQUENCY)
    assert len(found.beside_start) == 1
    assert not bool(found.beside_start[0].isfinite().all()) or float(found.beside_start[0].abs().max()) > 1e3
