"""Quantities as they are spoken, at every door of the configuration."""

import pytest

from gear_damping.config.command_line import parse, read_command_line
from gear_damping.config.keys import SCHEMA, read_value, unit_of
from gear_damping.config.quantities import number_of, quantity
from gear_damping.config.settings import read_settings
from gear_damping.config.source import Origin
from gear_damping.errors import InputError
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
    distribution = drawn.distributions["damping_ratio_percent"]
    assert (distribution.low, distribution.high) == pytest.approx((0.1, 0.4))


def test_ends_of_a_range_are_quantities():
    drawn = settings("task=simulate", "family.spreads.pinion_speed={uniform: [4000rpm, {value: 5000, unit: rpm}]}")
    distribution = drawn.simulator.family.distributions["pinion_speed"]
    assert (distribution.low, distribution.high) == pytest.approx((4000 * RPM, 5000 * RPM))


def test_lists_and_sensors_of_a_plan_are_quantities():
    said = ["plan.speeds=[3000rpm, {value: 100, unit: rev/s}]", "plan.durations=[50ms, 0.2 s]", "plan.settle=20ms"]
    plan = settings("experiment=plan", *said, "plan.sensors.transmission_error.noise=0.1um").plan
    assert plan.tests.speeds == pytest.approx((3000 * RPM, 6000 * RPM))
    assert plan.tests.durations == pytest.approx((0.05, 0.2))
    assert plan.tests.settle == pytest.approx(0.02)
    assert {one.name: one.noise for one in plan.sensors}["transmission_error"] == pytest.approx(1e-7)


@pytest.mark.parametrize(
    ("task", "words", "place", "found"),
    [
        ("train", ["wavelet.frequency_max_hz=10kHz"], ("wavelet", "frequency_max_hz"), 10e3),
        ("train", ["wavelet.frequency_min_hz={value: 0.5, unit: kHz}"], ("wavelet", "frequency_min_hz"), 500),
        ("train", ["training.noise_snr_db=[1 dB, 30dB]"], ("training", "noise_snr_db"), [1, 30]),
        ("train", ["protocol.test_fraction=20%"], ("protocol", "test_fraction"), 0.2),
        ("explain", ["explain.minutes=2 min"], ("explain_minutes",), 2),
        ("explain", ["explain.minutes=90 s"], ("explain_minutes",), 1.5),
        ("explain", ["explain.minutes={value: 0.5, unit: h}"], ("explain_minutes",), 30),
        ("explain", ["explain.least_excess=0.05 %"], ("search", "least_excess"), 0.05),
        ("simulate", ["simulator.damping_ratio_percent=0.3 %"], ("simulator", "damping_ratio_percent"), 0.3),
        ("simulate", ["simulator.damping_ratio_percent={value: 0.003, unit: '1'}"],
         ("simulator", "damping_ratio_percent"), 0.3),
        ("train", ["model=record_cwt_lstm", "model.lowest_hz=1kHz", "model.frame_ms=800us"],
         ("model", "settings", "record_cwt_lstm"), {"lowest_hz": 1000, "frame_ms": 0.8}),
    ],
)  # fmt: skip
def test_every_key_with_a_unit_is_read_as_it_is_spoken(task, words, place, found):
    measured = ["measurement=silverbox", "simulator=oscillator", "family=none"] if task == "explain" else []
    kept = settings(f"task={task}", *measured, *words)
    for part in place:
        kept = kept[part] if isinstance(kept, dict) else getattr(kept, part)
    kept = {name: kept[name] for name in found} if isinstance(found, dict) else kept
    assert kept == pytest.approx(found)


def test_a_plan_is_too():
    said = ["plan.wanted_percent=12 %", "plan.sensors.response.snr_db=25 dB"]
    plan = settings("experiment=plan", *said).plan
    assert plan.goal.percent == pytest.approx(12)
    assert plan.sensors[0].snr_db == pytest.approx(25)


@pytest.mark.parametrize("said", ["1", "1.0", "100 %"])
def test_a_plain_number_is_kept_as_it_was_given(said):
    """It is told so in messages, and decides the name of a data set."""
    share = settings("task=simulate", f"simulator.diverged_share={said}").simulator.diverged_share
    assert str(share) == ("1" if said == "1" else "1.0")


def kinds_with_units(node, prefix=""):
    """Key, kind and unit of what the schema says to be in a unit."""
    for name, kind in node.items():
        if isinstance(kind, dict):
            yield from kinds_with_units(kind, f"{prefix}{name}.")
        elif unit := unit_of(prefix + name):
            yield prefix + name, kind, unit


@pytest.mark.parametrize(("key", "kind", "unit"), [*kinds_with_units(SCHEMA)], ids=lambda part: str(part)[:30])
def test_each_key_that_the_schema_gives_a_unit_reads_it(key, kind, unit):
    """The same number, plain and with its unit: what is added to the schema is asked here too."""
    span = [1, 2] if "snr_db" in key else None
    plain, said = (span, [f"{one} {unit}" for one in span]) if span else (0.5, {"value": 0.5, "unit": unit})
    read = {words: read_value(given, kind, key, Origin()) for words, given in (("plain", plain), ("said", said))}
    assert read["said"][1] is None
    assert read["said"][0] == pytest.approx(read["plain"][0])


@pytest.mark.parametrize(
    ("word", "rule"),
    [("wavelet.frequency_max_hz=10mm", "the unit 'mm' is not one of the kind of 'Hz'"),
     ("wavelet.frequency_max_hz=10kHzz", "unknown unit 'kHzz'"),
     ("wavelet.frequency_max_hz=0 Hz", "strictly between"),
     ("wavelet.frequency_max_hz=fast", "must be a finite number"),
     ("training.learning_rate=3 mm", "must be a finite number")],
)  # fmt: skip
def test_a_quantity_of_another_kind_is_refused_by_its_key(word, rule):
    typed = read_command_line(["task=train", word])
    with pytest.raises(InputError) as raised:
        read_settings(*composed(typed.overrides))
    [problem] = raised.value.problems
    assert problem.key == word.partition("=")[0]
    assert rule in problem.rule
    assert problem.source == f"command line: {word}"


@pytest.mark.parametrize(
    ("key", "value", "found"),
    [("simulator.backlash.gap", "80um", 8e-5), ("simulator.backlash.gap_um", "0.12mm", 120),
     ("simulator.pinion_speed_rpm", {"value": 50, "unit": "rev/s"}, 3000), ("simulator.backlash.gap", None, None),
     ("simulator.backlash.gap", 1e-4, 1e-4), ("simulator.backlash.gap", "80xx", "80xx"),
     ("wavelet.frequency_max_hz", "10kHz", 10e3), ("explain.minutes", "90 s", 1.5), ("model.frame_ms", "2 s", 2000),
     ("protocol.window", "3 s", "3 s"), ("measurement.path", "3m", "3m"), ("simulator.load_noise.snr_db", "30 dB", 30)],
)  # fmt: skip
def test_a_swept_quantity_is_a_number_of_the_table(key, value, found):
    assert number_of(key, value) == (found if found is None or isinstance(found, str) else pytest.approx(found))


@pytest.mark.parametrize(
    ("word", "remedy"),
    [
        ("training.learning_rate=.inf", "write a number: neither infinity nor nan is one"),
        ("seeds=nan", "write a whole number: neither infinity nor nan is one"),
        ("simulator.pinion_torque=inf", "write a number, or {value: …, unit: N*m}: neither infinity nor nan is one"),
    ],
)
def test_what_helps_beside_infinity_is_a_finite_number(word, remedy):
    with pytest.raises(InputError) as raised:
        read_settings(*composed(read_command_line(["task=train", word]).overrides))
    assert [one.remedy for one in raised.value.problems] == [remedy]


@pytest.mark.parametrize("level", ["20", "20dB", "20 dB", "{value: 20, unit: dB}"])
def test_a_level_is_in_db(level):
    words = [f"simulator.{noise}.snr_db={level}" for noise in ("sensor_noise", "load_noise")]
    found = settings("task=simulate", *words).simulator.given
    assert [found[f"{noise}.snr_db"] for noise in ("sensor_noise", "load_noise")] == [20.0, 20.0]


@pytest.mark.parametrize(
    ("level", "said"),
    [
        ("abc", r"must be a finite number in dB; remedy: write a number, or \{value: …, unit: dB\}"),
        ("20 mm", "the unit 'mm' is not one of the kind of 'dB'; remedy: give a level in dB"),
        ("500 dB", "must lie within -40 … 200 dB; remedy: nearest valid value 200"),
    ],
)
def test_what_is_no_level_is_told_what_is_one(level, said):
    with pytest.raises(InputError, match=rf"simulator\.load_noise\.snr_db = .*: {said}"):
        settings("task=simulate", f"simulator.load_noise.snr_db={level}")


@pytest.mark.parametrize(
    ("given", "remedy"),
    [
        ("coulomb_friction", r"write \[coulomb_friction\], also for one alone"),
        ("[backlash,backlash]", r"write \[backlash\], each name once"),
        ("[]", r"write \[first, second\], each name once"),
    ],
)
def test_a_list_of_names_is_shown_as_it_is_written(given, remedy):
    with pytest.raises(InputError, match=rf"ruled_out = .*: must be a list of different names; remedy: {remedy}"):
        settings("task=explain", f"ruled_out={given}")
