"""No gear pair rings for thousands of cycles: a line that folds from beyond the sampling rate would, and is none."""

import pytest
import torch

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.nominal_gear_pair import first_gear_pair
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair

DAMPING = "viscous_damping.damping_coefficient"


@pytest.mark.parametrize("stated", [{}, {"damping_ratio": 0.04}, {"inertia_pinion": 1e-5}])
def test_a_fit_goes_down_to_a_hundredth_of_a_percent_of_critical(stated):
    """At 1 kHz a free ringing at 1018 Hz that never dies away looked like an eccentricity of 12 um at 18 Hz."""
    response = torch.zeros(1000, dtype=torch.float64)
    turned = 113.0 * torch.arange(1000, dtype=torch.float64) / 1000.0
    record = FitRecord("run", response, 1000.0, {"pinion_angle": turned}, {"pinion_speed": 113.0})
    first = first_gear_pair(Evidence("gear_pair", (record,), (), Known(stated, {}, GearPair), None, one_record=False))
    free = next(parameter for parameter in first.free if parameter.name == DAMPING)
    model = Model(first.system, first.effects)
    derived = model.prepare(model.values(1, **first.given)).derived
    critical = 2 * float((derived["mean_stiffness"] * derived["equivalent_mass"])[0]) ** 0.5
    assert free.lower == pytest.approx(1e-4 * critical)
    assert free.start == pytest.approx(stated.get("damping_ratio", 0.01) * critical)
