"""Values of the configuration as the tasks receive them."""

import pytest

from gear_damping.config.settings import read_settings
from gear_damping.tasks.composed import composed


def settings(*overrides):
    return read_settings(*composed(list(overrides)))


def test_units_cross_the_door_once():
    found = settings("experiment=backlash").simulator
    assert found.given["backlash.gap"] == pytest.approx(1e-4)
    assert found.given["pinion_speed"] == pytest.approx(4600 * 3.14159265 / 30)
    assert found.given["module"] == pytest.approx(3e-3)
    assert found.sampling_rate == pytest.approx(40e3)
    other = settings("++simulator.backlash.gap_um=80").simulator
    assert other.given["backlash.gap"] == pytest.approx(8e-5)


def test_the_command_line_beats_the_experiment_and_the_family():
    found = settings("experiment=backlash", "family=paper", "++simulator.pinion_speed_rpm=1000").simulator
    assert found.given["pinion_speed"] == pytest.approx(1000 * 3.14159265 / 30)
    assert found.family.start == "rest"


def test_an_effect_that_is_off_is_switched_on_by_one_of_its_parameters():
    names = [effect.name for effect in settings("++simulator.load_noise.snr_db=10").simulator.model.effects]
    assert "load_noise" in names
    off = settings("experiment=noise", "++simulator.load_noise=null").simulator.model.effects
    assert "load_noise" not in [effect.name for effect in off]


def test_distributions_have_units():
    field = settings("family=field").simulator.family.distributions["pinion_speed"]
    assert field.low == pytest.approx(157.08, rel=1e-4)
    assert settings().simulator.family.distributions["pinion_torque"].relative


def test_seeds_count_up():
    assert settings("++seed=4", "++seeds=3").all_seeds == [4, 5, 6]


def test_sensor_noise_is_known_to_the_learner():
    assert settings().simulator.sensor_noise_db is None
    assert settings("++simulator.sensor_noise.snr_db=10").simulator.sensor_noise_db == 10
    assert settings("++simulator.sensor_noise={}").simulator.sensor_noise_db == 30


@pytest.mark.parametrize(("override", "value"), [("80um", 8e-5), ("'0.08 mm'", 8e-5), ("{value:80,unit:um}", 8e-5)])
def test_a_quantity_may_be_written_as_it_is_said(override, value):
    found = settings("experiment=backlash", f"++simulator.backlash.gap={override}").simulator
    assert found.given["backlash.gap"] == pytest.approx(value)
