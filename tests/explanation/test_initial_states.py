"""Whole records begin where a fit to their segments found that they do; a motion near resonance depends on it."""

from dataclasses import replace

import pytest
import torch

from gear_damping.explanation.model.fitting import initial_states_from
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.identification.output_error.segments import Segments, in_segments, stretch
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator

RATE, SAMPLES = 200.0, 400


@pytest.fixture
def records():
    time = torch.arange(SAMPLES, dtype=torch.float64) / RATE
    return [FitRecord(name, size * torch.cos(9 * time), RATE) for name, size in (("one", 1.0), ("two", 3.0))]


def problem_of(records):
    model = Model(Oscillator(), [ViscousDamping()])
    free = [FreeParameter("stiffness", 80.0, logarithmic=True)]
    return OutputErrorProblem(model, {"stiffness": 80.0, "viscous_damping.damping_coefficient": 0.1}, free, records)


class Found:
    """A fit with made-up states: of segment n, n + 1 in its own natural size."""

    def __init__(self, problem):
        self.problem, self.fitted = problem, self
        number = torch.arange(1.0, len(problem.records) + 1, dtype=torch.float64)
        self.states = (number[:, None] / problem.scales).unsqueeze(0)


def test_a_record_begins_where_its_first_segment_does(records):
    whole, after = problem_of(records), Found(problem_of(in_segments(records, Segments(0.5))))
    assert len(after.problem.records) == 8
    found = initial_states_from(whole, after, 2) * whole.scales
    assert found.shape[:2] == (2, 2)
    assert found[1, :, 0].tolist() == pytest.approx([1.0, 5.0])


def test_a_stretch_that_begins_elsewhere_begins_as_it_was_measured(records):
    later = [records[0], stretch(records[1], slice(33, 300))]
    whole, after = problem_of(later), Found(problem_of(in_segments(records, Segments(0.5))))
    assert torch.equal(initial_states_from(whole, after, 1)[0], whole.first_states())


def test_as_many_records_begin_as_those_before_did(records):
    changed = [replace(record, name=record.name + " again") for record in records]
    whole, after = problem_of(changed), Found(problem_of(records))
    assert (initial_states_from(whole, after, 1) * whole.scales)[0, :, 0].tolist() == pytest.approx([1.0, 2.0])
