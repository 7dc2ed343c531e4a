"""Any rig and any channel: what is hidden is found whatever the teeth, the sensors, the units and the zero are."""

import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from hidden import draw_case, draw_oscillator, write_case

from gear_damping.explanation.explain import explain
from gear_damping.measurement.load import load_measurement

RECORDS = (0, 3, 4, 6)  # of the full plan: three speeds, two torques, a fourth condition held out
SNR = 30.0


def content_of(case):
    with tempfile.TemporaryDirectory() as folder:
        content = explain(load_measurement(write_case(case, Path(folder) / "measured"))).content
    return content | {"truth": case.truth}


@cache
def gears(effect, seed, rig, sensors, duration=0.02, excess=5.0, order=None):
    chosen = {} if order is None else {"order": order}
    asked = {"duration": duration, "snr_db": SNR, "target_excess": excess, "chosen": chosen}
    case = draw_case(effect, seed, rig=rig, sensors=sensors, **asked)
    return content_of(replace(case, records=tuple(case.records[i] for i in RECORDS)))


@cache
def oscillator(effect, seed, channel, kind="random", unit=None):
    asked = {"periods": 15.0, "snr_db": SNR, "target_excess": 5.0}
    return content_of(draw_oscillator(effect, seed, channel=channel, kind=kind, unit=unit, **asked))


def offered(content):
    return {name for cause in content["causes"] for name in (cause["name"], *cause["confusable_with"])}


def assert_null(content):
    assert (content["verdict"], content["causes"]) == ("consistent", []), content["sentences"]
    low, high = content["gain"]["damping_ratio_percent"]["after"]["interval95"]
    true = content["truth"]["damping_ratio_percent"]
    slack = 0.25 * (high - low)  # one interval in twenty misses by chance; none by much
    assert low - slack < true < high + slack


def assert_named(content, effect, alike=()):
    first = content["causes"][0]
    assert first["status"] == "established", content["sentences"]
    assert first["name"] in (effect, *alike)
    assert effect in offered(content)
    assert content["misfit"]["after"] < 1.5 < content["misfit"]["before"]


QUICK = [("17/43", "mean_free"), ("25/47", "encoders"), ("37/53", "pinion_speed"), ("20/45", "speed_condition")]
MORE = [("17/51", "ac"), ("25/50", "torque_gain"), ("37/44", "acceleration"), ("17/48", "gear_speed"),
        ("25/43", "speed_uncertain"), ("37/49", "torque_condition"), ("20/52", "full")]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("rig", "sensors"), [*QUICK, *(pytest.param(*case, marks=pytest.mark.slow) for case in MORE)])
def test_nothing_is_found_in_a_null_and_its_damping_is_right(rig, sensors):
    assert_null(gears("null", 4, rig, sensors))


@pytest.mark.parametrize(
    ("effect", "seed", "rig", "sensors", "duration"),
    [
        pytest.param("gear_stiffness_modulation", 1, "17/47", "mean_free", 0.02, marks=pytest.mark.slow),
        pytest.param("cubic_stiffness", 1, "25/44", "pinion_speed", 0.02, marks=pytest.mark.slow),
        pytest.param("cubic_stiffness", 2, "37/51", "acceleration", 0.02, marks=pytest.mark.slow),
        pytest.param("tooth_crack", 2, "25/45", "full", 0.04, marks=pytest.mark.slow),  # on the pinion
        pytest.param("tooth_crack", 1, "17/43", "mean_free", 0.04, marks=pytest.mark.slow),  # on the gear
        pytest.param("pitch_error", 1, "37/44", "mean_free", 0.04, marks=pytest.mark.slow),  # on the gear
        pytest.param("profile_error", 3, "17/49", "ac", 0.02, marks=pytest.mark.slow),
    ],
)
def test_an_effect_is_named_on_any_rig_through_any_channel(effect, seed, rig, sensors, duration):
    alike = {"pitch_error": ("encoder_error", "gear_eccentricity", "pinion_eccentricity")}.get(effect, ())
    assert_named(gears(effect, seed, rig, sensors, duration), effect, alike)


@pytest.mark.slow
@pytest.mark.parametrize(("rig", "order"), [("17/47", 12.0), ("37/53", 36.0)])
def test_a_ripple_of_a_high_order_is_named_with_its_order(rig, order):
    content = gears("torque_ripple", 1, rig, "full", 0.03, order=order)
    assert_named(content, "torque_ripple")
    assert content["causes"][0]["fixed"]["order"] == pytest.approx(order, abs=0.01)


@pytest.mark.slow
def test_an_inertia_that_is_stated_wrong_is_a_class_and_no_name():
    content = gears("null", 4, "25/47", "inertia_wrong")
    assert content["verdict"] == "ambiguous"
    assert {"sensor_gain", "inertia_error"} <= offered(content)
    assert any("torque" in sentence for sentence in content["sentences"])


@pytest.mark.parametrize(
    ("seed", "channel"),
    [
        pytest.param(1, "displacement", marks=pytest.mark.slow),
        (2, "velocity"),
        pytest.param(5, "acceleration", marks=pytest.mark.slow),
    ],
)
def test_nothing_is_found_in_an_oscillator_that_is_linear(seed, channel):
    assert_null(oscillator("null", seed, channel))


@pytest.mark.parametrize(
    ("effect", "seed", "channel", "kind", "unit", "alike"),
    [
        pytest.param("cubic_stiffness", 1, "velocity", "random", "V", (), marks=pytest.mark.slow),
        pytest.param(
            "coulomb_friction", 2, "acceleration", "multisine", "gn", ("asymmetric_friction",), marks=pytest.mark.slow
        ),
        pytest.param("sine_restoring", 3, "displacement", "decay", "deg", (), marks=pytest.mark.slow),
        pytest.param("sensor_delay", 4, "velocity", "random", None, (), marks=pytest.mark.slow),
        pytest.param("quadratic_stiffness", 5, "acceleration", "sweep", None, (), marks=pytest.mark.slow),
        pytest.param("hysteretic_damping", 6, "displacement", "random", "V", (), marks=pytest.mark.slow),
    ],
)
def test_an_effect_of_an_oscillator_is_named_through_any_channel(effect, seed, channel, kind, unit, alike):
    assert_named(oscillator(effect, seed, channel, kind, unit), effect, alike)
