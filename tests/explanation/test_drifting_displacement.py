"""What counts as a signal in the displacement of a drive: what a motion left to itself would not do."""

import pytest
import torch

from gear_damping.explanation.evidence.excess import ac_energy
from gear_damping.identification.output_error.records import FitRecord, Observed
from gear_damping.identification.output_error.segments import Segments, covered

TIME = torch.arange(400, dtype=torch.float64) / 100.0


def record(shown, drifts):
    return FitRecord("drive", shown, 100.0, observed=Observed("displacement", drifts=drifts))


@pytest.mark.parametrize("segments", [Segments(), Segments(1.0)])
def test_a_turning_at_a_steady_speed_is_no_signal(segments):
    (turning,) = covered([record(3.0 + 50.0 * TIME, drifts=True)], segments)
    assert ac_energy(turning) == pytest.approx(0.0, abs=1e-15)


def test_beside_a_spring_all_about_the_mean_is_signal():
    (held,) = covered([record(3.0 + 50.0 * TIME, drifts=False)], Segments(1.0))
    assert ac_energy(held) == pytest.approx(2500.0 * float((TIME - TIME.mean()).square().sum()))


def test_a_slow_swing_counts_within_the_segments_that_begin_anew():
    """Of 1 s of a parabola the straight line leaves a hundred and eightieth of T^4."""
    (slow,) = covered([record(TIME.square(), drifts=True)], Segments(1.0))
    assert ac_energy(slow) / len(TIME) == pytest.approx(1 / 180, rel=0.03)
