"""What is free when a simulation is fitted again: above all of one that `explain` wrote."""

import pytest

import gear_damping as gd
from gear_damping.interface.free_parameters import free_parameters, given_numbers

SHAPE = {"in_phase": [0.0, 0.03], "quadrature": [0.01, 0.0]}
MESH = {"maximum": 4e8, "minimum": 2e8, "contact_ratio": 1.6, "edge": 0.1}


def model(*more, shape=True):
    mesh = [gd.FourierMeshStiffness(**MESH), *([gd.MeshStiffnessShape(**SHAPE)] if shape else [])]
    return gd.Model(gd.GearPair(), [*mesh, gd.ViscousDamping(damping_coefficient=300.0), *more])


def free(of, names=(), stated=(), uncertainty=()):
    found = free_parameters(of, dict(stated) | of.given, names or given_numbers(of), dict(stated), dict(uncertainty))
    return {one.name: one for one in found}


def test_the_harmonics_of_the_mesh_are_free_and_not_what_they_contain():
    found = free(model(gd.PinionStiffnessModulation(amplitude=0.01, phase=0.2)))
    shape = {f"mesh_stiffness_shape.{part}[{h}]" for part in SHAPE for h in range(2)}
    of_cause = {f"pinion_stiffness_modulation.{name}" for name in ("amplitude", "phase")}
    assert set(found) == shape | of_cause | {"fourier_mesh_stiffness.maximum", "viscous_damping.damping_coefficient"}
    one = found["mesh_stiffness_shape.in_phase[1]"]
    assert (one.start, one.deviation, one.expected) == (0.03, pytest.approx(0.05), None)  # expected about zero


def test_without_a_shape_what_was_given_is_free():
    assert {f"fourier_mesh_stiffness.{name}" for name in MESH} <= set(free(model(shape=False)))


def test_errors_of_single_teeth_are_free_and_times_are_not():
    teeth = gd.PitchError(values=[1e-6, -2e-6, *18 * [0.0]])
    steps = gd.TorqueVariation(step_times=[0.01, 0.02], step_changes=[3.0, -4.0])
    found = free(model(teeth, steps))
    assert found["pitch_error.values[2]"].scale == pytest.approx(2e-6)
    assert found["torque_variation.step_changes[1]"].start == -4.0
    assert not any(name.startswith("torque_variation.step_times") for name in found)


def test_what_the_file_is_unsure_of_is_free_about_what_it_states():
    stated = {"inertia_pinion": 2.6e-4, "fourier_mesh_stiffness.maximum": 4.2e8}
    uncertainty = {"inertia_pinion": 0.02, "mesh_stiffness_max": 0.1}
    found = free(model(), ["damping_ratio"], stated, uncertainty)
    assert set(found) == {"viscous_damping.damping_coefficient", "inertia_pinion", "fourier_mesh_stiffness.maximum"}
    inertia, mesh = found["inertia_pinion"], found["fourier_mesh_stiffness.maximum"]
    assert (inertia.deviation, inertia.expected) == (pytest.approx(0.02), 2.6e-4)
    assert (mesh.start, mesh.deviation, mesh.expected) == (4e8, pytest.approx(0.1), 4.2e8)


def test_a_list_without_any_size_cannot_be_free():
    with pytest.raises(gd.InputError, match="begins at zero"):
        free(model(gd.PitchError(values=20 * [0.0])), ["pitch_error.values"])


def test_a_damping_ratio_of_two_laws_names_their_coefficients():
    law = gd.PowerLawDamping(coefficient=240, exponent=2)
    with pytest.raises(
        gd.InputError, match=r"name viscous_damping.damping_coefficient or power_law_damping.coefficient"
    ):
        free(model(law), ["damping_ratio"])
    bare = gd.Model(gd.GearPair(), [gd.FourierMeshStiffness(**MESH)])
    with pytest.raises(gd.InputError, match=r"the model has no damping laws.*; remedy: add ViscousDamping"):
        free(bare, ["damping_ratio"])
