"""Whether angles of several records count from one mark: their phases agree, or lie on the line of a delay."""

from types import SimpleNamespace

import numpy as np
import pytest

from gear_damping.explanation.steps.calibrate import _are_in_line

SPEEDS = (180.0, 182.0, 320.0, 318.0, 480.0, 481.0)


def outcome_of(phases):
    names = [f"run_{i}" for i in range(len(phases))]
    records = [
        SimpleNamespace(name=name, conditions={"pinion_speed": speed})
        for name, speed in zip(names, SPEEDS, strict=False)
    ]
    values = {f"mesh_phase@{name}": phase for name, phase in zip(names, phases, strict=True)}
    beside = {f"offset.transmission_error@{name}": 1e-6 for name in names}  # as any sensor's zero may be
    return SimpleNamespace(values={"mesh_phase": 0.0, **values, **beside}), SimpleNamespace(fit=records)


@pytest.mark.parametrize("delay", [0.0, 3e-5, -2e-4])
def test_phases_of_one_mark_agree_but_for_a_delay(delay):
    noise = 0.03 * np.random.default_rng(3).normal(size=6)
    phases = (1.3 - 20 * delay * np.array(SPEEDS) + noise) % (2 * np.pi)
    assert _are_in_line(*outcome_of(phases.tolist()))


def test_phases_that_begin_anywhere_do_not():
    drawn = np.random.default_rng(4).uniform(0, 2 * np.pi, (200, 6))
    assert not any(_are_in_line(*outcome_of(phases.tolist())) for phases in drawn)


def test_three_records_tell_nothing():
    assert not _are_in_line(*outcome_of([1.0, 1.0, 1.0]))
