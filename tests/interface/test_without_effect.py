"""What is accepted in Python and would do nothing is refused, as on the command line."""

import numpy as np
import pytest
import torch
import yaml

import gear_damping as gd
from gear_damping.tasks.command import main

EFFECTS = [gd.FourierMeshStiffness(), gd.ViscousDamping(damping_coefficient=500.0)]
SAMPLED = {"sampling_rate": 4e4, "n_samples": 60}
ANGLE = {"pinion_angle": np.linspace(0, 0.6, 60)}
BALANCED = (
    "has no effect where {}gear_torque_mode is balanced: it follows from the pinion's torque; remedy: leave it out"
)


def pair(**given):
    return gd.Model(gd.GearPair(**given), EFFECTS)


def said_of(ask):
    with pytest.raises(gd.InputError) as caught:
        ask()
    return str(caught.value)


def test_a_torque_of_a_gear_that_follows_is_refused_wherever_it_is_given():
    rule = BALANCED.format("")
    assert f"- gear_torque = 100.0: {rule}, or make the system with gear_torque_mode='held'" in said_of(
        lambda: pair(gear_torque=100.0)
    )
    assert f"- gear_torque = 30.0: {rule}" in said_of(lambda: gd.simulate(pair(), **SAMPLED, gear_torque=30.0))
    series = {"gear_torque": np.full(60, 30.0)}
    for inputs in (series, gd.Driven({name: torch.tensor(one) for name, one in series.items()})):
        assert f"- inputs.gear_torque: {rule}" in said_of(
            lambda inputs=inputs: gd.simulate(pair(), **SAMPLED, inputs=inputs)
        )


@pytest.mark.parametrize("by_hand", [True, False])
def test_a_torque_of_a_gear_that_follows_is_refused_in_a_file(by_hand, tmp_path, caplog):
    node = {**pair().to_config(), "gear_torque": 100.0}
    path = tmp_path / "model.yaml"
    path.write_text(yaml.safe_dump(node))
    if by_hand:
        said = said_of(lambda: gd.Model.from_config(path))
        assert BALANCED.format("simulator.") in said_of(lambda: gd.Model.from_config(node))
    else:
        assert main(["task=simulate", "family=none", f"simulator.extended={path}", f"hydra.run.dir={tmp_path}/a"]) == 1
        said = caplog.text
    assert f"simulator.gear_torque = 100.0: {BALANCED.format('simulator.')}" in said
    assert f"(from {path})" in said


def test_an_option_that_comes_on_top_of_a_file_may_overrule_it(tmp_path):
    path = pair(gear_torque_mode="held", gear_torque=290.0).write(tmp_path / "model.yaml")
    size = ["simulator.n_runs=2", "simulator.n_samples=50", "progress=false", f"data_folder={tmp_path / 'data'}"]
    typed = [f"simulator.extended={path}", "simulator.gear_torque_mode=balanced", f"hydra.run.dir={tmp_path / 'run'}"]
    assert main(["task=simulate", "family=none", *typed, *size]) == 0


def test_a_torque_that_is_held_acts():
    held = pair(gear_torque_mode="held", gear_torque=290.0)
    assert held.given["gear_torque"] == 290.0
    plain = gd.simulate(held, **SAMPLED).transmission_error
    for more in ({"gear_torque": 250.0}, {"inputs": {"gear_torque": np.linspace(290.0, 200.0, 60)}}):
        assert not np.allclose(gd.simulate(held, **SAMPLED, **more).transmission_error, plain, rtol=1e-6, atol=0)


def test_a_torque_that_is_held_has_to_be_said():
    """It was taken for 0 without a word."""
    rule = (
        "- gear_torque: must be given where it is held; remedy: give gear_torque: n_teeth_gear / n_teeth_pinion times"
    )
    held = pair(gear_torque_mode="held")
    assert rule in said_of(lambda: gd.simulate(held, **SAMPLED))
    tests = gd.PlannedTests(durations=(0.02,), sampling_rate=20e3, speeds=(200.0,), torques=(100.0,))
    sensor = gd.PlannedSensor("transmission_error", noise=1e-6)
    assert rule in said_of(lambda: gd.plan(held, tests, sensor))
    for more in ({"gear_torque": 0.0}, {"inputs": {"gear_torque": np.full(60, 300.0)}}):
        assert len(gd.simulate(held, **SAMPLED, **more)) == 1


def test_what_the_paper_prints_takes_the_place_of_a_module():
    said = said_of(lambda: pair(as_printed=True, module=0.004))
    assert "- module = 0.004: has no effect beside as_printed=True: mass and base circles are those that" in said
    assert pair(as_printed=True).system.chosen["as_printed"]


@pytest.mark.parametrize("name", ["pinion_speed", "pinion_acceleration", "pinion_jerk", "pinion_angle"])
def test_a_measured_angle_takes_the_place_of_a_speed(name):
    said = said_of(lambda: gd.simulate(pair(), **SAMPLED, inputs=ANGLE, **{name: 9.0}))
    assert f"- {name} = 9.0: has no effect beside the series inputs['pinion_angle'], which says how the pinion" in said
    assert len(gd.simulate(pair(pinion_speed=9.0), **SAMPLED, inputs=ANGLE)) == 1  # that of a model is its usual one


def test_orders_of_a_run_are_those_of_its_measured_angle():
    usual, other = (gd.simulate(pair(pinion_speed=one), **SAMPLED, inputs=ANGLE) for one in (400.0, 100.0))
    shown = [[line.get_xdata() for axes in run.plot().axes for line in axes.lines] for run in (usual, other)]
    assert len(shown[0]) > 2
    for one, again in zip(*shown, strict=True):
        np.testing.assert_array_equal(one, again)


def test_a_gain_scales_a_series():
    model = gd.Model(gd.Oscillator(stiffness=400.0), [gd.ViscousDamping(damping_coefficient=0.8)])
    asked = {"sampling_rate": 200, "n_samples": 50}
    said = said_of(lambda: gd.simulate(model, **asked, initial_displacement=0.01, force_gain=3.0))
    assert "- force_gain = 3.0: has no effect without a series of force, which it scales; remedy: leave it out" in said
    assert gd.simulate(model, **asked, inputs={"force": np.ones(50)}, force_gain=3.0).displacement.any()


@pytest.mark.parametrize(
    ("driven", "said"),
    [
        ({"held": ["foo"]}, "- inputs.held = 'foo': there is no such series; remedy: name some of pinion_torque"),
        ({"held": "torque"}, "- inputs.held = 'torque': there is no such series"),
        ({"held": [3]}, "- inputs.held = 3: must be names"),
        ({"seed": -3}, "- inputs.seed = -3: must"),
        ({"series": 3}, "- inputs: must say which series is which, and is an int; remedy: write {'force': ARRAY}"),
        ({"series": {}, "held": ["pinion_torque"]}, "no such series; remedy: leave it out"),
    ],
)
def test_what_holds_is_a_series(driven, said):
    given = {"series": {"pinion_torque": torch.full((1, 60), 150.0)}} | driven
    assert said in said_of(lambda: gd.simulate(pair(), **SAMPLED, inputs=gd.Driven(**given)))


def test_one_series_that_holds_is_one_name():
    series = {"pinion_torque": torch.linspace(100.0, 200.0, 60, dtype=torch.float64)[None]}
    one, listed = (gd.simulate(pair(), **SAMPLED, inputs=gd.Driven(series, held=held))
                   for held in ("pinion_torque", ["pinion_torque"]))  # fmt: skip
    np.testing.assert_array_equal(one.transmission_error, listed.transmission_error)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"damping_ratio": 0.02}, "give the coefficient, **{'viscous_damping.damping_coefficient': VALUE}"),
        ({"damping_ratio_percent": 2}, "a ratio is what the coefficient of a damping law comes to"),
        ({"seed": 3}, "- seed: no such parameter of the model; remedy: it stands in inputs=gd.Driven(…, seed=…)"),
        ({"substeps": 3}, "remedy: it stands in solver=gd.Solver(substeps=…)"),
    ],
)
def test_what_another_argument_takes_is_said_where(given, said):
    assert said in said_of(lambda: gd.simulate(pair(), **SAMPLED, **given))


def test_a_series_is_no_value():
    model = gd.Model(gd.Oscillator(stiffness=400.0), [gd.ViscousDamping()])
    said = said_of(lambda: gd.simulate(model, **SAMPLED, force=np.ones(60)))
    assert "- force: no such parameter of the model; remedy: a series stands in inputs={'force': ARRAY}" in said


@pytest.mark.parametrize("model", [None, gd.GearPair(), [gd.Oscillator()]])
def test_what_is_no_model_is_answered(model):
    tests, sensor = gd.PlannedTests(durations=(1.0,), sampling_rate=500), gd.PlannedSensor("response", snr_db=30)
    for ask in (lambda: gd.simulate(model, **SAMPLED), lambda: gd.plan(model, tests, sensor)):
        assert "is no model: a system with its effects; remedy: give a gd.Model, for example" in said_of(ask)


def test_what_another_option_decides_is_not_unknown():
    tests, sensor = gd.PlannedTests(durations=(0.01,), sampling_rate=4e4), gd.PlannedSensor("response", noise=1e-7)
    said = said_of(lambda: gd.plan(pair(), tests, sensor, unknown="gear_torque"))
    assert f"- plan.unknown = 'gear_torque': {BALANCED.format('')}" in said


def test_what_acts_on_an_accelerometer_of_a_shaft_is_refused_where_there_is_none(tmp_path, caplog):
    rule = "accelerometer_gravity: has no effect on what a simulation gives"
    model = gd.Model(gd.GearPair(), [*EFFECTS, gd.AccelerometerGravity(shaft="gear")])
    assert rule in said_of(lambda: gd.simulate(model, **SAMPLED))
    tests = gd.PlannedTests(durations=(0.02,), sampling_rate=2e4, speeds=(300.0,), torques=(100.0,))
    assert rule in said_of(lambda: gd.plan(model, tests, [gd.PlannedSensor("response", snr_db=30)]))
    path = tmp_path / "model.yaml"
    path.write_text(yaml.safe_dump(model.to_config(), sort_keys=False))
    assert gd.Model.from_config(path) == model, "a model of measured records holds it"
    assert main(["task=simulate", "family=none", f"simulator.extended={path}", f"hydra.run.dir={tmp_path}/out"]) == 1
    assert f"holds {rule.replace(': has', ', which has')}" in caplog.text
    assert main(["task=simulate", "++simulator.accelerometer_gravity={}", f"hydra.run.dir={tmp_path}/out"]) == 1
    assert f"simulator.{rule}" in caplog.text
