"""Records in segments, and the linear algebra of what every record has of its own, against dense matrices."""

import math

import pytest
import torch

from gear_damping.identification.output_error.normal_equations import normal_equations, nuisance_basis, project_out
from gear_damping.identification.output_error.problem import OutputErrorProblem, Prediction, error_amplification
from gear_damping.identification.output_error.records import FitRecord, Observed
from gear_damping.identification.output_error.segments import WHOLE, Segments, covered, in_segments, joined
from gear_damping.physics.effects.sensor_drift import SensorDrift
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator

STARTS, RECORDS, SAMPLES, SHARED, OWN = 2, 3, 20, 4, 2


@pytest.fixture
def prediction():
    generator = torch.Generator().manual_seed(0)
    residual = torch.randn(STARTS, RECORDS, SAMPLES, generator=generator, dtype=torch.float64)
    sensitivity = torch.randn(*residual.shape, SHARED + OWN, generator=generator, dtype=torch.float64)
    return Prediction(residual, sensitivity)


def dense(sensitivity):
    """Of one start: (records * time, shared + records * own), with zeros where a column is another record's own."""
    blocks = torch.block_diag(*sensitivity[..., SHARED:])
    return torch.cat([sensitivity[..., :SHARED].reshape(-1, SHARED), blocks], 1)


def test_the_step_solves_the_whole_system(prediction):
    damping = torch.tensor([1e-2, 0.3], dtype=torch.float64)
    shared, own = normal_equations(prediction, SHARED).step(damping)
    for i in range(STARTS):
        jacobian = dense(prediction.sensitivity[i])
        matrix = jacobian.T @ jacobian
        ridge = torch.diag(damping[i] * matrix.diagonal())
        step = torch.linalg.solve(matrix + ridge, jacobian.T @ prediction.residual[i].reshape(-1))
        torch.testing.assert_close(torch.cat([shared[i], own[i].reshape(-1)]), step, rtol=1e-9, atol=1e-12)


def test_what_records_have_of_their_own_is_projected_out(prediction):
    sensitivity = prediction.sensitivity[0].clone()
    sensitivity[1, :, -1] = 0.0  # a state that one record does not show
    left = project_out(prediction.residual[0].unsqueeze(-1), nuisance_basis(sensitivity, SHARED)).reshape(-1)
    columns = dense(sensitivity)[:, SHARED:]
    signal = prediction.residual[0].reshape(-1)
    best = torch.linalg.lstsq(columns, signal.unsqueeze(1), driver="gelsd").solution
    torch.testing.assert_close(left, signal - (columns @ best)[:, 0], rtol=1e-9, atol=1e-12)


def test_segments_hold_every_sample_once_and_say_when_they_begin():
    records = [
        FitRecord(name, samples, 100.0, {"pinion_torque": -samples}, {"pinion_speed": 3.0})
        for name, samples in (("a", torch.arange(103.0)), ("b", torch.arange(50.0)))
    ]
    segments = Segments(0.25)
    segmented = in_segments(records, segments)
    assert [len(segment.response) for segment in segmented] == [26, 26, 25, 26, 25, 25]
    assert all(torch.equal(segment.inputs["pinion_torque"], -segment.response) for segment in segmented)
    # the record counts its own samples, so that a segment's first sample says how many went before
    assert [segment.begins for segment in segmented] == pytest.approx(
        [float(segment.response[0]) / 100.0 for segment in segmented]
    )
    padded = torch.nn.utils.rnn.pad_sequence([segment.response for segment in segmented], batch_first=True)
    for found, record in zip(joined(padded, records, segments), records, strict=True):
        assert torch.equal(found, record.response)


def test_a_segment_of_uneven_samples_is_driven_by_the_load_of_its_own_time():
    """Of a clock that slows down: in the middle its samples are 25 ahead of the even grid."""
    place = torch.linspace(0, 1, 1001, dtype=torch.float64)
    stamps, even = 1000 * (place - 0.1 * place * (1 - place)), torch.arange(1001, dtype=torch.float64)
    whole = FitRecord("a", stamps, 100.0, {"force": 7 + 3 * even}, stamps=stamps)
    segmented = in_segments([whole], Segments(2.0))
    assert len(segmented) == 5
    for segment in segmented:
        assert segment.begins * 100 + segment.instants == pytest.approx(segment.response, abs=1e-9)
        inside = segment.instants <= len(segment.response) - 1  # what lies behind the grid does not count
        assert segment.at_samples("force")[inside] == pytest.approx((7 + 3 * segment.response)[inside], abs=1e-9)
        assert inside.double().mean() > 0.9


def test_stated_segments_are_exact_and_a_shorter_end_is_left_out():
    record, segments = FitRecord("a", torch.arange(103.0), 100.0), Segments(0.25, exact=True)
    segmented = in_segments([record], segments)
    assert [len(segment.response) for segment in segmented] == [25, 25, 25, 25]
    assert torch.equal(covered([record], segments)[0].response, record.response[:100])


def test_segments_of_several_channels_are_put_together_by_the_channels_of_each_record():
    samples, names, segments = torch.arange(60.0), ["displacement", "velocity"], Segments(0.3)
    speed = Observed("velocity")
    both = FitRecord("a", samples, 100.0, others=((speed, -samples),))
    second = FitRecord("b", samples, 100.0, observed=speed)  # has no row of displacement
    ends = segments.ends(both)
    segmented = [torch.cat([samples[a:b], -samples[a:b]]) for _ in range(2) for a, b in ends]
    found = joined(segmented, [both, second], segments, names)
    assert torch.equal(found[0], torch.cat([samples, -samples]))
    assert torch.equal(found[1], -samples)


def test_records_stay_whole_without_a_length():
    record = FitRecord("a", torch.arange(10.0), 100.0)
    assert in_segments([record], WHOLE) == [record]
    assert torch.equal(joined([record.response], [record], WHOLE)[0], record.response)


@pytest.mark.parametrize(("rate", "expected"), [(-3.0, 1.0), (2.0, math.exp(2.0 * 7 / 8))])
def test_error_amplification_is_that_of_the_record_with_the_most(rate, expected):
    time = torch.linspace(0, 1, 8001, dtype=torch.float64)[:-1]
    errors = torch.stack([torch.exp(-time), torch.exp(rate * time)])
    shared = torch.full_like(errors, 1e6)
    sensitivity = torch.stack([shared, errors], -1).unsqueeze(0)
    assert error_amplification(Prediction(errors.unsqueeze(0), sensitivity), 1) == pytest.approx(expected, rel=1e-6)


def test_a_drift_goes_on_from_segment_to_segment():
    """The zero of a segment has wandered since its record began."""
    time = torch.arange(400, dtype=torch.float64) / 100
    whole = FitRecord("a", 0.3 * time, 100.0)
    model = Model(Oscillator(), [SensorDrift()])
    problem = OutputErrorProblem(model, {"sensor_drift.rate": 0.3}, (), in_segments([whole], Segments(1.0)))
    none = torch.zeros(1, len(problem.records), len(problem.local), dtype=torch.float64)
    shown = problem.predict(torch.zeros(1, problem.n_shared, dtype=torch.float64), none)
    assert shown[0].flatten() == pytest.approx(whole.response, abs=1e-9)
