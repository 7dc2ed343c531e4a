"""The size of a gear pair's motion follows from the torques that were recorded, whatever its default is."""

import pytest
import torch

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.nominal_gear_pair import first_gear_pair, typical_torques
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair


def evidence(torques, stated=None, name="pinion_torque"):
    zeros = torch.zeros(64, dtype=torch.float64)
    records = [FitRecord(f"run_{k}", zeros, 1e3, {}, {"pinion_speed": 50.0, name: t}) for k, t in enumerate(torques)]
    return Evidence("gear_pair", tuple(records), (), Known(stated or {}, {}, GearPair), None, one_record=False)


@pytest.mark.parametrize(
    ("torques", "typical"), [((0.3, 0.4), 0.125**0.5), ((-3.0, -4.0), -(12.5**0.5)), ((0.0, 2.0), 2**0.5)]
)
def test_it_is_the_root_mean_square_with_the_sign_of_most(torques, typical):
    assert typical_torques(evidence(torques)) == {"pinion_torque": pytest.approx(typical)}


def test_without_a_torque_the_default_stays():
    assert typical_torques(evidence((0.0, 0.0))) == {}
    assert "pinion_torque" not in first_gear_pair(evidence((0.0, 0.0))).given


def test_what_the_file_states_of_the_rig_goes_first():
    assert first_gear_pair(evidence((0.3, 0.4), {"pinion_torque": 5.0})).given["pinion_torque"] == 5.0


def test_the_static_deflection_of_a_small_rig_is_a_small_one():
    """Of a default of 300 N*m a motor of .3 N*m had a length of a thousand times its motion, and 249 % of damping."""
    first = first_gear_pair(evidence((0.3,)))
    model = Model(first.system, first.effects)
    prepared = model.prepare(model.values(1, **first.given))
    radius = float(prepared.derived["base_radius_pinion"][0])
    expected = 0.3 / radius / float(prepared.derived["mean_stiffness"][0])
    assert float(prepared.scales.length[0]) == pytest.approx(expected, rel=1e-9)
