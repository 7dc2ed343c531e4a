"""A record that was started before the motion was free is taken from there."""

import numpy as np
import pytest
import torch

from gear_damping.explanation.evidence.release import released_at
from gear_damping.identification.output_error.records import FitRecord

RATE, FREQUENCY, RATIO, NOISE = 200.0, 2.0, 0.01, 2e-3


def decay(seconds, turn=0.0):
    time = np.arange(round(RATE * seconds)) / RATE
    rate = 2 * np.pi * FREQUENCY
    return np.exp(-RATIO * rate * time) * np.cos(rate * time + turn)


def record(*parts, seed=1, noise=NOISE, offset=0.7, **inputs):
    values = np.concatenate(parts) + offset
    values += noise * np.random.default_rng(seed).standard_normal(len(values))
    return FitRecord("decay", torch.tensor(values), RATE, inputs={n: torch.tensor(f) for n, f in inputs.items()})


@pytest.mark.parametrize("wait", [2.0, 9.0])
def test_held_away_it_is_free_where_it_moves(wait):
    found = released_at(record(np.ones(round(RATE * wait)), decay(20.0))) / RATE
    assert wait - 0.2 < found < wait + 0.2 / FREQUENCY


@pytest.mark.parametrize("wait", [2.0, 9.0])
def test_pushed_out_of_its_rest_it_is_free_where_it_turns_back(wait):
    push = np.linspace(0, 1, round(RATE * 0.3))
    found = released_at(record(np.zeros(round(RATE * wait)), push, decay(20.0))) / RATE
    assert wait + 0.25 < found < wait + 0.35


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("turn", [0.0, 1.2, np.pi])
def test_one_that_is_free_from_the_start_is_taken_whole(turn, seed):
    assert released_at(record(decay(20.0, turn), seed=seed)) == 0
    assert released_at(record(decay(20.0, turn), seed=seed, noise=0.1)) == 0


def test_what_is_driven_or_never_moves_is_taken_whole():
    values = np.zeros(2000), decay(20.0)
    assert released_at(record(*values, force=np.ones(6000))) == 0
    assert released_at(record(np.zeros(4000))) == 0
