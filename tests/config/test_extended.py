"""`simulator.extended`: the file's model under every experiment, with the command line on top."""

import pytest
import yaml

from gear_damping.config.settings import read_settings
from gear_damping.errors import InputError
from gear_damping.tasks.composed import composed

FILE = {
    "system": "gear_pair",
    "module": 0.004,
    "pinion_torque": 99.0,
    "rectangular_mesh_stiffness": {"maximum": 3e8},
    "viscous_damping": {"damping_coefficient": 1234.0},
    "pinion_eccentricity": {"amplitude": 2e-6, "phase": 0.5},
}


@pytest.fixture
def extended(tmp_path):
    path = tmp_path / "extended_simulator.yaml"
    path.write_text(yaml.safe_dump(FILE))
    return path


def simulator(*overrides):
    return read_settings(*composed(list(overrides))).simulator


def test_the_model_of_the_file_replaces_the_chosen_one(extended):
    found = simulator(f"++simulator.extended='{extended}'")
    names = {effect.name for effect in found.model.effects}
    assert names == {"rectangular_mesh_stiffness", "viscous_damping", "pinion_eccentricity"}
    assert found.given["module"] == 0.004
    assert found.given["pinion_eccentricity.amplitude"] == 2e-6
    assert found.damping_law == "viscous_damping"
    assert found.n_runs == 400
    assert extended in found.files


def test_an_experiment_and_the_command_line_come_on_top(extended):
    found = simulator(
        "experiment=backlash", f"++simulator.extended='{extended}'", "++simulator.pinion_eccentricity.amplitude=3e-6"
    )
    assert "backlash" in {effect.name for effect in found.model.effects}
    assert found.given["pinion_eccentricity.amplitude"] == 3e-6
    assert found.given["pinion_eccentricity.phase"] == 0.5


@pytest.mark.parametrize(
    ("content", "said"),
    [("[", "cannot be read"), ("a: 1", "names no system"), ("system: gear_pair\nn_runs: 3", "sets n_runs")],
)
def test_a_file_that_is_no_simulator_is_refused(tmp_path, content, said):
    path = tmp_path / "x.yaml"
    path.write_text(content)
    with pytest.raises(InputError, match=said):
        simulator(f"++simulator.extended='{path}'")


def test_a_wrong_value_in_the_file_names_the_file(extended):
    extended.write_text(yaml.safe_dump(FILE | {"pinion_eccentricity": {"amplitud": 1}}))
    with pytest.raises(InputError, match="did you mean 'amplitude'") as caught:
        simulator(f"++simulator.extended='{extended}'")
    assert str(extended) in str(caught.value)


MILLIMETRES = {
    "system": "oscillator", "unit": "mm", "amplitude": 12.0, "stiffness": 142.5,
    "viscous_damping": {"damping_coefficient": 0.1},
}  # fmt: skip


def oscillator(tmp_path, content, *overrides):
    path = tmp_path / "extended_simulator.yaml"
    path.write_text(yaml.safe_dump(content))
    return simulator(
        "task=simulate", "simulator=oscillator", "family=none", f"++simulator.extended='{path}'", *overrides
    )


def test_what_is_said_in_a_unit_becomes_the_unit_of_the_rig(tmp_path):
    """A centimetre was .01, and simulated as .01 mm."""
    found = oscillator(tmp_path, MILLIMETRES, "++simulator.initial_displacement=1cm", "++simulator.initial_velocity=3")
    assert found.given["initial_displacement"] == pytest.approx(10)
    assert found.given["initial_velocity"] == 3
    assert found.model.system.unit_of("m/s") == "mm/s"
    assert found.model.system.unit_of("N*s/m") == "1/s"


def test_of_a_rig_whose_unit_nobody_knows_none_is_converted(tmp_path):
    unknown = {key: value for key, value in MILLIMETRES.items() if key != "unit"}
    assert oscillator(tmp_path, unknown).model.system.unit_of("m") == ""
    with pytest.raises(InputError, match=r"that of the rig is not known; remedy: add simulator\.unit=m"):
        oscillator(tmp_path, unknown, "++simulator.initial_displacement=1cm")
    with pytest.raises(InputError, match="unknown unit 'qq'"):
        oscillator(tmp_path, MILLIMETRES | {"unit": "qq"})


@pytest.mark.parametrize("unit", [{}, {"unit": "m"}, {"unit": "mm"}])
def test_a_stiffness_in_newtons_is_that_of_a_mass_which_nobody_stated(unit, tmp_path):
    """1579 N/m were taken as 1579 1/s^2, which they are of 1 kg alone."""
    content = {key: value for key, value in MILLIMETRES.items() if key != "unit"} | unit
    with pytest.raises(InputError, match=r"the unit 'N/m' is not one of the kind of '1/s\^2'"):
        oscillator(tmp_path, content, "++simulator.stiffness='1579 N/m'")
