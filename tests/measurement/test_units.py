"""Units: every one that may stand in a product has its factor, and what nobody knows is refused by name."""

import re

import pytest

from gear_damping.errors import InputError
from gear_damping.units import multiple_of_a_unit, parse_unit, scaled_unit, spoken, to_si, unit_names

STANDARD_GRAVITY = 9.80665


@pytest.mark.parametrize(
    ("text", "factor"),
    [
        ("km/h", 1 / 3.6), ("N*m", 1.0), ("g", STANDARD_GRAVITY), ("m/s^2", 1.0), ("rpm", 0.10471975511965977),
        ("kg*mm^2", 1e-6), ("deg/s", 0.017453292519943295), ("µm", 1e-6),
        ("in", 0.0254), ("ft/s^2", 0.3048), ("lbf", 4.4482216152605), ("kgf", STANDARD_GRAVITY), ("mA", 1e-3),
        ("Gal", 0.01), ("mGal", 1e-5), ("gon", 0.015707963267948967), ("krpm", 104.71975511965977),
        ("Upm", 0.10471975511965977), ("mph", 0.44704), ("knots", 0.5144444444444445), ("kV", 1e3), ("mHz", 1e-3),
        ("ozf*in", 0.00706155181422604), ("lbf*in", 0.1129848290276167), ("Ns/m", 1.0), ("Nms/rad", 1.0),
        ("Ns/mm", 1e3), ("millimeter", 1e-3), ("Mikrometer", 1e-6),
    ],
)  # fmt: skip
def test_a_unit_has_its_factor(text, factor):
    assert parse_unit(text).factor == pytest.approx(factor, rel=1e-12)


@pytest.mark.parametrize("name", unit_names())
def test_every_listed_unit_is_read_by_itself_and_in_a_quotient(name):
    unit = parse_unit(name)
    assert unit.factor > 0
    assert parse_unit(f"{name}/s").dimension.time == unit.dimension.time - 1


@pytest.mark.parametrize(
    ("text", "right"),
    [
        ("counts", "1"), ("count", "1"), ("pixel", "1"), ("px", "1"), ("ticks", "1"), ("steps", "1"), ("LSB", "1"),
        ("a.u.", "1"), ("arb", "1"), ("px/s", "1/s"),
    ],
)  # fmt: skip
def test_what_is_counted_has_no_unit(text, right):
    with pytest.raises(InputError, match="has no unit here") as caught:
        parse_unit(text)
    assert caught.value.problems[0].remedy == f"write '{right}'"
    assert parse_unit(right)


@pytest.mark.parametrize(
    ("text", "right"),
    [
        ("in-lb", "lbf*in"), ("lb-in", "lbf*in"), ("in-lbs", "lbf*in"), ("oz-in", "ozf*in"), ("grad", "gon"),
        ("grad", "deg"), ("oz", "ozf"), ("ft-lb", "ft*lbf"),
    ],
)  # fmt: skip
def test_what_may_be_meant_is_offered_as_it_is_written_here(text, right):
    with pytest.raises(InputError, match=re.escape(f"'{right}'")):
        parse_unit(text)
    assert parse_unit(right)


@pytest.mark.parametrize(
    ("text", "number", "factor"),
    [
        ("x10^-3 m", 1e-3, 1.0), ("×10⁻³ m", 1e-3, 1.0), ("*1e-3 m", 1e-3, 1.0), ("x1000 mm", 1e3, 1e-3),
        ("0.1 mm", 0.1, 1e-3),
    ],
)  # fmt: skip
def test_a_step_may_begin_with_a_sign_of_a_product(text, number, factor):
    found, unit = multiple_of_a_unit(text)
    assert (found, unit.factor) == (pytest.approx(number), factor)


@pytest.mark.parametrize("text", ["x1 m", "x2 [V]", "mm", "x"])
def test_what_is_no_step_of_a_unit_is_none(text):
    assert multiple_of_a_unit(text) is None


@pytest.mark.parametrize("text", ["mg", "milli-g", "mgn"])
def test_a_milli_g_is_one_of_an_accelerometer(text):
    assert parse_unit(text).factor == pytest.approx(STANDARD_GRAVITY / 1000, rel=1e-12)
    assert parse_unit(text).dimension == parse_unit("m/s^2").dimension


def test_a_milligram_is_not_taken_for_one():
    with pytest.raises(InputError, match="not one of the kind of 'kg'; remedy: give it in 'kg'"):
        to_si(1.0, "mg", "kg")
    with pytest.raises(InputError, match=r"write 'mgn' .* or a mass in 'gram'"):
        parse_unit("mg*m^2")


@pytest.mark.parametrize("text", ["furlong", "rounds/min", "fathom", "torr"])
def test_no_unit_is_suggested_that_shares_hardly_a_letter(text):
    with pytest.raises(InputError) as caught:
        parse_unit(text)
    assert caught.value.problems[0].remedy.startswith("choose one of")


def test_a_current_is_no_voltage_and_no_number():
    kinds = {parse_unit(name).dimension for name in ("A", "V", "1")}
    assert len(kinds) == 3


def test_a_pound_may_be_either():
    with pytest.raises(InputError, match="lbf"):
        parse_unit("Pounds")


@pytest.mark.parametrize("text", ["furlong", "N**", "g*m"])
def test_an_unknown_unit_is_refused(text):
    with pytest.raises(InputError, match="unit"):
        parse_unit(text)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("80um", (80.0, "um")),
        ("3 kHz", (3.0, "kHz")),
        ("3 1/s", (3.0, "1/s")),
        ("4600rpm", (4600.0, "rpm")),
        ("-1.5e-3 m/s^2", (-1.5e-3, "m/s^2")),
        (" .3 µm ", (0.3, "µm")),
        ("7 %", (7.0, "%")),
        ("1e3 Hz", (1000.0, "Hz")),
        ("150 N m", (150.0, "N m")),
    ],
)
def test_a_number_is_told_from_its_unit(text, found):
    assert spoken(text) == found


@pytest.mark.parametrize("value", ["5", "1e3", "31/s", "kg", "1,5 m", "12:30", "20-01-01", "", 4.0, None, {"value": 3}])
def test_anything_else_is_no_number_with_a_unit(value):
    assert spoken(value) is None


def test_a_level_is_no_ratio():
    with pytest.raises(InputError, match=r"the unit 'dB' is not one of the kind of '1'.*10\^\(level/20\)"):
        to_si(-1.0, "dB", "1")
    assert to_si(30.0, "dB", "dB") == 30


def test_rates_may_be_said_in_radians():
    assert to_si(380.0, "rad^2/s^2", "1/s^2") == 380
    assert to_si(2.0, "rad/s", "1/s") == 2
    with pytest.raises(InputError, match="not one of the kind"):
        to_si(2.0, "rad", "1")


def test_kilograms_by_a_length_are_a_torque_of_their_weight():
    with pytest.raises(InputError, match=r"write 'kgf\*cm'"):
        parse_unit("kgcm")
    with pytest.raises(InputError, match=r"write 'kg\*cm\^2'"):
        parse_unit("kgcm^2")


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("mm*10", "mm"), ("mm/10", "mm"), ("µm x 10", "µm"), ("mm·10⁻³", "mm"), ("m/s^2*10", "m/s^2"),
        ("m/s^2", None), ("N*m", None), ("1/s", None), ("run 3*4", None),
    ],
)  # fmt: skip
def test_a_factor_behind_a_unit_is_seen(text, unit):
    assert scaled_unit(text) == unit


@pytest.mark.parametrize(
    ("value", "unit", "expected", "said"),
    [
        (62.83, "rad/s", "Hz", "62.83 rad/s are 9.99971 Hz"),
        (6283, "rad/s", "kHz", "are 0.999971 kHz"),
        (9.61, "Hz^2", "1/s^2", "9.61 Hz^2 are 379.388 1/s^2"),
        (5, "Hz", "1/s^2", "5 Hz are 986.96 1/s^2"),
        (0.001, "kHz", "1/s", "0.001 kHz are 6.28319 1/s"),
    ],
)
def test_turns_are_not_taken_for_radians(value, unit, expected, said):
    """Between the two lies 2 pi, which no dimension shows: it is asked back."""
    with pytest.raises(InputError, match=re.escape(said)):
        to_si(value, unit, expected)


@pytest.mark.parametrize(
    ("text", "factor"), [("lbf/in^2", 6894.757293168361), ("bar", 1e5), ("hPa", 100.0), ("MPa", 1e6)]
)
def test_a_pressure_is_a_force_over_an_area(text, factor):
    assert parse_unit(text).factor == pytest.approx(factor, rel=1e-12)
    assert parse_unit(text).dimension == parse_unit("N/m^2").dimension
