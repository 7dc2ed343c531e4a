"""Quantities as they are spoken, at every door of the configuration."""

import pytest

from gear_damping.config.command_line import parse, read_command_line
from gear_damping.config.quantities import number_of, quantity
from gear_damping.config.settings import read_settings
from gear_damping.tasks.composed import composed

RPM = 3.14159265 / 30


def settings(*words):
    typed = read_command_line(words)
    assert not typed.problems
    return read_settings(*composed(typed.overrides))


def typed(text, unit):
    """What a typed value is in SI, without the rest of the configuration."""
    (override,) = read_command_line([f"simulator.effect.parameter={text}"]).overrides
    return quantity(parse(override).value(), unit, "key", "source")


@pytest.mark.parametrize(
    "text", ["80um", "80 um", "80µm", "80 μm", "0.08mm", "'80 um'", "{value: 80, unit: um}", "8e-5", "8e1um"]
)
def test_a_length_is_read_however_it_is_typed(text):
    assert typed(text, "m") == pytest.approx(8e-5)


@pytest.mark.parametrize("text", ["3000rpm", "3000 rpm", "50 rev/s", "{value: 3000, unit: rpm}", "314.159265rad/s"])
def test_a_speed_is_read_however_it_is_typed(text):
    assert typed(text, "rad/s") == pytest.approx(3000 * RPM)


@pytest.mark.parametrize("text", ["3kHz", "3 kHz", "{value: 3, unit: kHz}", "3000"])
def test_a_rate_is_read_however_it_is_typed(text):
    assert typed(text, "Hz") == pytest.approx(3000)


def test_a_path_in_quotes_is_left_as_it_is():
    word = "measurement.path='a/lauf 3µm.yaml'"
    assert read_command_line([word]).overrides == (f"++{word}",)


def test_parameters_are_quantities_whatever_unit_their_key_carries():
    said = ["simulator.backlash.gap_um=0.08mm", "simulator.pinion_speed=3000rpm", "simulator.sampling_rate=3 kHz"]
    found = settings("task=simulate", *said).simulator
    assert found.given["backlash.gap"] == pytest.approx(8e-5)
    assert found.given["pinion_speed"] == pytest.approx(3000 * RPM)
    assert found.sampling_rate == pytest.approx(3000)


@pytest.mark.parametrize("ends", ["[0.1 %, 0.4]", "[{value: 1e-3, unit: '1'}, 0.4%]"])
def test_a_range_of_damping_ratios_is_in_percent(ends):
    """`0.1 %` had been a hundredth of that."""
    drawn = settings("task=simulate", f"family.spreads.damping_ratio_percent={{uniform: {ends}}}").simulator.family
    spread = drawn.spreads["damping_ratio_percent"]
    assert (spread.low, spread.high) == pytest.approx((0.1, 0.4))


def test_ends_of_a_range_are_quantities():
    drawn = settings("task=simulate", "family.spreads.pinion_speed={uniform: [4000rpm, {value: 5000, unit: rpm}]}")
    spread = drawn.simulator.family.spreads["pinion_speed"]
    assert (spread.low, spread.high) == pytest.approx((4000 * RPM, 5000 * RPM))


def test_lists_and_sensors_of_a_plan_are_quantities():
    said = ["plan.speeds=[3000rpm, {value: 100, unit: rev/s}]", "plan.durations=[50ms, 0.2 s]", "plan.settle=20ms"]
    plan = settings("experiment=plan", *said, "plan.sensors.transmission_error.noise=0.1um").plan
    assert plan.tests.speeds == pytest.approx((3000 * RPM, 6000 * RPM))
    assert plan.tests.durations == pytest.approx((0.05, 0.2))
    assert plan.tests.settle == pytest.approx(0.02)
    assert {one.name: one.noise for one in plan.sensors}["transmission_error"] == pytest.approx(1e-7)


@pytest.mark.parametrize(
    ("key", "value", "found"),
    [("simulator.backlash.gap", "80um", 8e-5), ("simulator.backlash.gap_um", "0.12mm", 120),
     ("simulator.pinion_speed_rpm", {"value": 50, "unit": "rev/s"}, 3000), ("simulator.backlash.gap", None, None),
     ("simulator.backlash.gap", 1e-4, 1e-4), ("simulator.backlash.gap", "80xx", "80xx"),
     ("measurement.path", "3m", "3m"), ("simulator.load_noise.snr_db", "30 dB", 30)],
)  # fmt: skip
def test_a_swept_quantity_is_a_number_of_the_table(key, value, found):
    assert number_of(key, value) == (found if found is None or isinstance(found, str) else pytest.approx(found))
