"""What a fit moves: order, names, bounds and reach of its coordinates."""

from dataclasses import replace

import pytest
import torch

from gear_damping.identification.output_error.records import FitRecord, FreeParameter, Observed
from gear_damping.identification.output_error.unknowns import Unknowns, is_of_model, is_of_simulator

FREQUENCY = FreeParameter("natural_frequency", 10.0, logarithmic=True, lower=5.0, upper=20.0)
PHASE = FreeParameter("mesh_phase", 0.5, per_record=True)
OFFSETS = [FreeParameter("offset.displacement@one", 0.1), FreeParameter("offset.displacement@two", 0.2)]


def record(name: str, **changes: object) -> FitRecord:
    return replace(FitRecord(name, torch.zeros(8, dtype=torch.float64), 100.0), **changes)


@pytest.fixture
def records():
    return [record("a", group="one"), record("b", group="one"), record("two", conditions={"mesh_phase": 2.0})]


def test_parameters_come_first_then_gains_then_what_records_have_of_their_own(records):
    uncertain = [replace(one, observed=Observed(gain_uncertainty=0.05)) for one in records]
    found = Unknowns([FREQUENCY, PHASE], uncertain, offsets=OFFSETS)
    names = [parameter.name for parameter in found.free]
    assert names[:2] == ["natural_frequency", "gain.displacement"]
    assert names[2:4] == ["mesh_phase@one", "mesh_phase@two"]
    assert (found.n_free, found.n_common, len(found)) == (1, 2, 6)
    assert found.free[3].start == 2.0, "what is known of a record is where it begins"


def test_a_gain_that_is_known_is_not_fitted(records):
    uncertain = [replace(records[0], observed=Observed(gain_uncertainty=0.05))]
    assert not Unknowns([], uncertain, known_gains=["gain.displacement"]).free


def test_every_segment_of_a_record_has_its_value_and_no_other_has(records):
    found = Unknowns([FREQUENCY], records, offsets=OFFSETS[:1]).by_record(torch.zeros(2, 2, dtype=torch.float64))
    assert found["natural_frequency"].tolist() == [[10.0] * 3] * 2
    offset = found["offset.displacement"]
    assert offset[:, :2].tolist() == [[0.1, 0.1]] * 2
    assert bool(offset[:, 2].isnan().all())


def test_a_coordinate_reaches_the_records_that_have_it(records):
    assert Unknowns([FREQUENCY], records, offsets=OFFSETS).reach.tolist() == [[1, 1, 0], [1, 1, 0], [1, 0, 1]]


def test_bounds_hold_and_are_told(records):
    found = Unknowns([FREQUENCY], records)
    ends = found.within(torch.tensor([[-9.0], [0.0], [9.0]], dtype=torch.float64))
    values = found.parameters(ends)["natural_frequency"]
    assert values.tolist() == pytest.approx([5.0, 10.0, 20.0], rel=1e-5)
    assert found.at_bound(ends).flatten().tolist() == [-1, 0, 1]


def test_what_another_fit_found_of_single_records_is_taken_over(records):
    first = Unknowns([PHASE], records)
    second = Unknowns([FREQUENCY, PHASE], records)
    moved = second.own_of(first, torch.tensor([0.3, -0.2], dtype=torch.float64))
    assert moved.tolist() == pytest.approx([0.0, 0.3, -0.2])


def test_coordinates_of_one_name_are_moved_together(records):
    found = Unknowns([FREQUENCY, PHASE], records, offsets=OFFSETS)
    assert found.moved_together() == [[0], [1, 2], [3, 4]]
    assert found.moved_together(only=[2, 4]) == [[1, 2], [3, 4]]
    steps, moved = found.steps([2], 2)
    assert moved == [[1, 2]]
    assert (steps != 0).tolist() == [
        [False, True, True, False, False, False, False],
        [False, False, False, False, False, True, False],
        [False, False, False, False, False, False, True],
    ]


@pytest.mark.parametrize(
    ("name", "simulator", "model"),
    [("natural_frequency", True, True), ("mesh_phase@one", True, False), ("offset.velocity@one", False, False),
     ("gain.velocity", False, False)],
)  # fmt: skip
def test_names_say_whose_a_parameter_is(name, simulator, model):
    assert (is_of_simulator(name), is_of_model(name)) == (simulator, model)
