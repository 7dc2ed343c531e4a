"""A number that is stated with an uncertainty begins there, and one that may have either sign can change it."""

from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.answer import report_fields
from gear_damping.explanation.evidence.noise import NoiseLevel
from gear_damping.explanation.model import contradicted
from gear_damping.explanation.model.contradicted import contradicts_stated, noise_above
from gear_damping.identification.observation import Known
from gear_damping.identification.oscillator.linear_model import uncertain_parameter
from gear_damping.identification.output_error.records import FreeParameter
from gear_damping.physics.systems.gear_pair import GearPair

DECLARED = {parameter.name: parameter for parameter in GearPair.parameters}


def test_an_offset_can_change_its_sign():
    found = uncertain_parameter(DECLARED["torque_offset"], 2.0, 5.0)
    assert not found.logarithmic
    assert (found.start, found.expected, found.deviation, found.scale) == (2.0, 2.0, 10.0, 10.0)


def test_a_size_is_fitted_by_its_logarithm():
    found = uncertain_parameter(DECLARED["inertia_gear"], 1e-3, 0.1)
    assert found.logarithmic
    assert (found.expected, found.deviation) == (1e-3, pytest.approx(0.1))


@pytest.mark.parametrize("stands", [True, False])
def test_what_standing_shafts_do_not_use_is_said(stands, monkeypatch):
    monkeypatch.setattr(report_fields, "is_standing", lambda evidence: stands)
    evidence = SimpleNamespace(parameters={"contact_ratio": 1.3, "module": 3e-3}, has=lambda trait: True)
    said = report_fields._of_standing_shafts(evidence)
    assert said == (
        ["The shafts stand, so that one stiffness is fitted: contact_ratio of the file is not used."] * stands
    )


@pytest.mark.parametrize(("coordinate", "is_said"), [(0.2, True), (0.04, False)])
def test_what_a_calibration_moved_far_from_what_is_stated_is_said_by_the_key_of_the_file(coordinate, is_said):
    stiffness = "fourier_mesh_stiffness.maximum"
    free = [FreeParameter(stiffness, 3e8, logarithmic=True, deviation=0.02, expected=3e8)]
    outcome = SimpleNamespace(
        problem=SimpleNamespace(free=free), fitted=SimpleNamespace(shared=torch.tensor([coordinate]))
    )
    evidence = SimpleNamespace(known=SimpleNamespace(uncertainty={"mesh_stiffness_max": 0.02}))
    said = contradicts_stated(outcome, evidence)
    assert said.startswith("mesh_stiffness_max lies 10 of its stated uncertainties away") is is_said
    assert bool(said) is is_said


@pytest.mark.parametrize(("mean", "is_said"), [(3.2e8, False), (4.2e8, True)])
def test_beside_a_free_shape_the_mean_of_the_stiffness_is_held_against_what_is_stated(mean, is_said, monkeypatch):
    monkeypatch.setattr(contradicted, "linear_of", lambda _: (1.0, 0.0, mean))
    maximum = FreeParameter("fourier_mesh_stiffness.maximum", 4e8, logarithmic=True, deviation=0.05, expected=4e8)
    shape = FreeParameter("mesh_stiffness_shape.in_phase[0]", 0.0)
    fitted = SimpleNamespace(shared=torch.tensor([0.3, 0.0]))
    outcome = SimpleNamespace(problem=SimpleNamespace(free=[maximum, shape]), fitted=fitted)
    values = {"mesh_stiffness_max": 4e8, "mesh_stiffness_min": 2e8, "contact_ratio": 1.5}  # 3e8 on average
    evidence = SimpleNamespace(known=Known(values, {"mesh_stiffness_max": 0.05}, GearPair))
    assert bool(contradicts_stated(outcome, evidence)) is is_said


@pytest.mark.parametrize(
    ("method", "stated", "is_said"),
    [("declared", 5e-4, True), ("declared", 1e-5, False), ("spectral floor above the signal", 5e-4, False)],
)
def test_a_noise_that_is_stated_far_above_all_that_is_left_is_said(method, stated, is_said):
    channel = SimpleNamespace(declared_unit="mm", declared_factor=1e-3)
    said = noise_above(NoiseLevel({"run": stated}, method, 1e9, True), 5e-6, channel)
    assert (said is not None) is is_said
    assert not is_said or said.startswith(
        "noise is stated as 0.5 mm, and the simulation follows the records within 0.005"
    )
