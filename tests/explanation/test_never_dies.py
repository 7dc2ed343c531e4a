"""Motions under a load that nobody recorded are told from ring-downs; made-up records."""

from types import SimpleNamespace

import numpy as np
import pytest
import torch
from scipy.signal import lfilter

from gear_damping.explanation.steps.never_dies import never_dies
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.segments import WHOLE, Segments

RATE, RATIO, TURN = 50.0, 0.02, 0.5  # Hz; of critical; rad from sample to sample
POLE = np.exp((-RATIO + 1j) * TURN)
CUT = Segments(2.0)
DENOMINATOR = [1, -2 * POLE.real, abs(POLE) ** 2]


def record(kind, inputs=()):
    kick = np.zeros(4000)
    kick[0] = 1.0
    load = {"ambient": np.random.default_rng(3).standard_normal(4000), "ring-down": kick}[kind]
    values = lfilter([0, 1.0], DENOMINATOR, load)
    values += 1e-4 * values.std() * np.random.default_rng(4).standard_normal(4000)
    series = {name: torch.arange(4000, dtype=torch.float64) for name in inputs}
    return FitRecord(kind, torch.as_tensor(values), RATE, series)


def state_of(records, segments=CUT, stated=WHOLE, spring=True):
    evidence = SimpleNamespace(fit=records, segments=segments, stated_segments=stated, has_spring=spring)
    return SimpleNamespace(bench=SimpleNamespace(evidence=evidence), accepted=())


def test_a_random_load_that_no_channel_holds_is_said():
    said = never_dies(state_of([record("ambient")]))
    assert "no channel holds what drives it" in said
    assert "model=ambient_spectrum" in said


@pytest.mark.parametrize(
    "state",
    [
        state_of([record("ring-down")]),
        state_of([record("ambient"), record("ring-down")]),
        state_of([record("ambient", ("force",))]),
        state_of([record("ambient")], segments=WHOLE),
        state_of([record("ambient")], stated=CUT),
        state_of([record("ambient")], spring=False),
    ],
    ids=["it dies away", "one does", "the force is known", "it is followed", "cut as stated", "nothing pulls it back"],
)
def test_nothing_is_said_of_anything_else(state):
    assert never_dies(state) == ""


def test_nothing_is_said_where_a_second_mode_gives_back_what_it_took(monkeypatch):
    state = state_of([record("ambient")])
    state.accepted, state.outcome = (SimpleNamespace(effect=None),), None
    for gives, said in ((True, False), (False, True)):
        monkeypatch.setattr("gear_damping.explanation.steps.never_dies.gives_back", lambda *_, gives=gives: gives)
        assert bool(never_dies(state)) == said
