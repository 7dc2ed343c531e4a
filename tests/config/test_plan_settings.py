"""The `plan` node as the task receives it, and what is refused of it."""

import math
from pathlib import Path

import pytest

from gear_damping.config.command_line import read_command_line
from gear_damping.config.settings import read_settings
from gear_damping.errors import InputError
from gear_damping.identification.test_plan.asked import PlanCosts, PlannedSensor, Unknown
from gear_damping.tasks.composed import composed

RPM = math.pi / 30
BY = "++plan.sensors.response"


def plan(*overrides):
    return read_settings(*composed(["++task=plan", *overrides])).plan


def test_the_defaults_are_one_test_of_the_configured_rig():
    found = plan()
    assert (found.tests.speeds, found.tests.torques, found.tests.amplitudes) == ((), (), ())
    assert found.tests.durations == (0.05, 0.2)
    assert found.tests.sampling_rate == pytest.approx(40e3)
    assert found.tests.settle is None
    assert found.sensors == (PlannedSensor("response", None, 30, "response", False, 0.0),)
    assert (found.goal.percent, found.goal.joint, found.goal.exponent) == (10, False, None)
    assert found.goal.law == "power_law_damping"


def test_units_cross_the_door_once():
    lists = ["++plan.speeds_rpm=[1500,3000]", "++plan.torques={value:[1,2],unit:kNm}", "++plan.durations_ms=[50,80]"]
    found = plan(*lists, "++plan.settle=80 ms", f"{BY}.noise=0.5um")
    assert found.tests.durations == pytest.approx((0.05, 0.08))
    assert plan("++plan.durations=[50 ms,1]").tests.durations == pytest.approx((0.05, 1))
    assert found.tests.speeds == pytest.approx((1500 * RPM, 3000 * RPM))
    assert found.tests.torques == pytest.approx((1e3, 2e3))
    assert found.tests.settle == pytest.approx(0.08)
    assert found.sensors[0].noise == pytest.approx(5e-7)
    assert found.sensors[0].snr_db is None


def test_what_was_said_last_counts():
    found = plan("experiment=plan", "++plan.speeds=[100]", "++plan.torques=null")
    assert found.tests.speeds == (100,)
    assert found.tests.torques == ()
    assert plan("experiment=plan", "++plan.speeds_rpm=null").tests.speeds == ()
    other = plan("experiment=plan", "++plan.sensors.encoders.snr_db=12", "++plan.sensors.accelerometer=null")
    assert other.sensors == (PlannedSensor("encoders", None, 12, "transmission_error", True, 0.0),)


def test_the_assumed_sensor_gives_way_to_a_named_one():
    named = plan("++plan.sensors={transmission_error: {noise: 2 um}}")
    assert [(one.name, one.noise) for one in named.sensors] == [("transmission_error", pytest.approx(2e-6))]
    both = plan("++plan.sensors.encoders.channel=transmission_error", f"{BY}.snr_db=20")
    assert [one.name for one in both.sensors] == ["response", "encoders"]
    other = plan("++plan.sensors.accelerometer.channel=pinion_acceleration", "++plan.sensors.accelerometer=null")
    assert [one.name for one in other.sensors] == ["response"]


def test_an_experiment_is_read_whole():
    found = plan("experiment=plan")
    assert [one.name for one in found.sensors] == ["encoders", "accelerometer"]
    assert found.sensors[1] == PlannedSensor("accelerometer", 2e4, None, "pinion_acceleration", False, 4)
    torque = Unknown("pinion_torque", percent=1.0, each=True)
    assert found.unknown == (Unknown("fourier_mesh_stiffness.maximum"), torque)
    assert found.goal.joint
    assert found.goal.costs == PlanCosts(1, 5, 3, 1)


def test_what_is_known_beforehand():
    listed = "[inertia_gear,{name:mesh_phase,deviation:5 deg},{name:module,deviation:{value:2,unit:'%'}}]"
    found = plan(f"++plan.unknown={listed}").unknown
    assert found[0] == Unknown("inertia_gear")
    assert found[1].deviation == pytest.approx(math.radians(5))
    assert found[2] == Unknown("module", percent=2.0)


def test_an_oscillator_has_amplitudes():
    found = plan("simulator=oscillator", "family=none", "++plan.amplitudes=[1mm,2mm]", f"{BY}.channel=acceleration",
                 f"{BY}.noise=0.1 g", "++plan.durations=[2]")  # fmt: skip
    assert found.tests.amplitudes == pytest.approx((1e-3, 2e-3))
    assert found.sensors[0].noise == pytest.approx(0.980665)


def test_a_coefficient_that_is_typed_counts():
    """The family draws no damping for a plan."""
    settings = read_settings(*composed(["++task=plan", "++simulator.power_law_damping.coefficient=50"]))
    assert settings.simulator.given["power_law_damping.coefficient"] == 50


def test_the_commands_of_the_page_are_read():
    lines = (Path(__file__).parents[2] / "docs" / "plan.md").read_text(encoding="utf-8").splitlines()
    commands = [line.split("gear_damping ")[1].split() for line in lines if line.startswith("    python -m")]
    assert len(commands) == 2
    for words in commands:
        typed = read_command_line(words)
        assert not typed.problems
        assert read_settings(*composed(typed.overrides)).plan is not None


REFUSED = {
    "no_key": (["++plan.speed=[1]"], ["plan.speed:", "did you mean 'speeds'"]),
    "no_list": (["++plan.torques=5"], ["plan.torques = 5", "must be a list"]),
    "wrong_unit": (["++plan.durations=[1 s,1 m]"], ["plan.durations[1]", "not one of the kind of 's'"]),
    "no_durations": (["++plan.durations=null"], ["plan.durations: must be given"]),
    "sensor_text": (["++plan.sensors.response=30"], ["plan.sensors.response = 30", "or hold keys"]),
    "sensor_key": ([f"{BY}.snr=30"], ["plan.sensors.response.snr:", "did you mean 'snr_db'"]),
    "sensor_channel": ([f"{BY}.channel=displacement"], ["response.channel", "sees no channel of a gear_pair"]),
    "sensor_name": (["++plan.sensors.other={snr_db:3}"], ["plan.sensors.other", "sees no channel"]),
    "sensor_unit": ([f"{BY}.noise=1 rad/s"], ["plan.sensors.response.noise", "not one of the kind of 'm'"]),
    "cost": (["++plan.cost.per_day=1"], ["plan.cost.per_day", "did you mean 'per_"]),
    "cost_below_0": (["++plan.cost.per_test=-1"], ["plan.cost.per_test = -1"]),
    "unknown_text": (["++plan.unknown=inertia_gear"], ["plan.unknown = 'inertia_gear'", "must be a list"]),
    "unknown_keys": (["++plan.unknown=[{nam:inertia_gear}]"], ["must name parameters"]),
    "deviation": (["++plan.unknown=[{name:module,deviation:2 N}]"], ["plan.unknown.module", "kind of 'm'"]),
    "wanted": (["++plan.wanted_percent=0"], ["plan.wanted_percent = 0"]),
    "no_plan": (["++task=simulate", "++plan.wanted_percent=3"], ["plan.wanted_percent", "acts in task=plan"]),
    "training": (["++training.max_epochs=3"], ["training.max_epochs", "has no effect in task=plan"]),
    "samples": (["++simulator.n_samples=300"], ["simulator.n_samples", "has no effect in task=plan"]),
    "spread": (["++family.spreads.pinion_torque=null"], ["family.spreads.pinion_torque", "has no effect"]),
    "a_network": (["model=raw_lstm"], ["model = 'raw_lstm'", "has no effect in task=plan"]),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_it_is_refused(name):
    overrides, said = REFUSED[name]
    with pytest.raises(InputError) as caught:
        plan(*overrides)
    assert len(caught.value.problems) == 1
    for part in said:
        assert part in str(caught.value)
