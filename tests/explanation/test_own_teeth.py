"""Teeth whose numbers no index tells: which of them is in mesh at the start of each record is found."""

import numpy as np
import pytest
import torch

from gear_damping.explanation.model.own_teeth import every_tooth, one_tooth

TEETH, TURNS = 17, (1.4, 2.3, 0.8)


def pulses(rng, samples=400):
    """What each tooth does in each record, (samples * records, teeth * records), and how the records are turned."""
    turned = rng.integers(0, TEETH, len(TURNS))
    columns = np.zeros((samples * len(TURNS), TEETH, len(TURNS)))
    for record, turns in enumerate(TURNS):
        angle = 2 * np.pi * turns * np.arange(samples) / samples
        for tooth in range(TEETH):
            off = (angle - 2 * np.pi * tooth / TEETH + np.pi) % (2 * np.pi) - np.pi
            columns[record * samples : (record + 1) * samples, tooth, record] = np.exp(-((3 * off) ** 2))
    return columns, turned


def test_a_single_tooth_is_found_in_every_record():
    rng = np.random.default_rng(1)
    columns, turned = pulses(rng)
    seen = sum(0.7 * columns[:, turned[r], r] for r in range(len(TURNS)))
    seen = seen + 0.05 * rng.normal(size=seen.shape)
    found = one_tooth(torch.tensor(columns).flatten(1), torch.tensor(seen), len(TURNS))
    assert found.numbers == turned.tolist()
    assert float(found.strengths) == pytest.approx(0.7, abs=0.02)


def test_a_tooth_is_never_stiffer():
    rng = np.random.default_rng(2)
    columns, turned = pulses(rng)
    seen = -sum(columns[:, turned[r], r] for r in range(len(TURNS)))
    found = one_tooth(torch.tensor(columns).flatten(1), torch.tensor(seen), len(TURNS))
    assert float(found.strengths) < 0.1


def test_errors_of_all_teeth_are_found_beside_how_the_records_are_turned():
    rng = np.random.default_rng(3)
    columns, turned = pulses(rng)
    errors = rng.normal(size=TEETH)
    seen = sum(columns[:, k, r] * errors[(k + turned[r]) % TEETH] for r in range(len(TURNS)) for k in range(TEETH))
    clean, seen = seen, seen + 0.02 * rng.normal(size=seen.shape)
    found = every_tooth(torch.tensor(columns).flatten(1), torch.tensor(seen), len(TURNS))
    differences = (np.array(found.numbers) - turned) % TEETH
    assert len(set(differences.tolist())) == 1  # all that can be known: which tooth is called the first is free
    explained = (found.columns @ found.strengths).numpy()
    assert np.linalg.norm(explained - clean) < 0.05 * np.linalg.norm(clean)
