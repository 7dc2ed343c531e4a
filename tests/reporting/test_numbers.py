"""Numbers, units and intervals as they are printed."""

import pytest

from gear_damping.reporting.numbers import NOTHING, estimate, number, percent, pretty_unit, quantity, with_interval

NAN, INFINITE = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("value", "digits", "said"),
    [
        (0.123456, 4, "0.1235"), (123456.0, 4, "1.235e5"), (1e-7, 4, "1e-7"), (1e12, 4, "1e12"),
        (1e-12, 4, "1e-12"), (-1.25e100, 3, "-1.25e100"), (-2.5, 4, "-2.5"), (0.0, 4, "0"),
        (20.0, 2, "20"), (963.0, 2, "960"), (-12345.0, 3, "-12300"), (None, 4, NOTHING),
        (NAN, 4, NOTHING), (INFINITE, 4, NOTHING),
    ],
)  # fmt: skip
def test_number(value, digits, said):
    assert number(value, digits) == said


@pytest.mark.parametrize(
    ("value", "unit", "said"),
    [
        (2e-5, "m", "20 µm"), (3e-3, "m", "3 mm"), (1.5, "m", "1.5 m"), (0.0, "m", "0 m"), (-2e-5, "m", "-20 µm"),
        (2.5e-5, "s", "25 µs"), (0.04, "s", "40 ms"), (150.0, "N*m", "150 N·m"), (0.35, "1", "0.35"),
        (30.0, "deg", "30°"), (4e8, "N/m", "4e8 N/m"), (NAN, "m", NOTHING), (None, "m", NOTHING), (7.0, None, "7"),
    ],
)  # fmt: skip
def test_quantity(value, unit, said):
    assert quantity(value, unit) == said


@pytest.mark.parametrize(
    ("value", "unit", "interval", "said"),
    [
        (2.01e-5, "m", (1.98e-5, 2.04e-5), "20.10 µm (19.80 … 20.40)"),
        (0.3512, "%", (0.341, 0.361), "0.351 % (0.341 … 0.361)"),
        (120.0, "N", (80.0, 160.0), "120 N (80 … 160)"),
        (1.0, "1", (1.0, 1.0), "1 (1 … 1)"),
        (5.0, "N", (None, None), "5 N"),
        (9.6e-4, "m", (9e-4, 1.1e-3), "0.96 mm (0.90 … 1.10)"),
    ],
)
def test_an_interval_has_two_digits_of_its_width(value, unit, interval, said):
    assert quantity(value, unit, interval) == said


def test_an_estimate_is_a_quantity_with_its_interval():
    assert estimate({"value": 2e-5, "unit": "m", "interval95": [1e-5, 3e-5]}) == quantity(2e-5, "m", (1e-5, 3e-5))
    assert estimate({"value": 2.0, "unit": "N"}) == "2 N"
    assert estimate(None) == NOTHING
    assert estimate({"value": 2.0, "unit": "N", "told": False}) == "2 N: not told by these records"
    gap = {"value": 8.1e-5, "unit": "m", "interval95": [0.0, 0.01], "told": False}
    assert estimate(gap) == "81 µm: not told by these records"
    assert estimate({"value": 2.0, "unit": "N", "at_bound": True}) == "2 N, at the end of its range"
    assert estimate({"value": 2.0, "unit": "N", "at_bound": False}) == "2 N"


def test_units_and_percentages():
    assert [pretty_unit(u) for u in ("N*s/m", "kg*m^2", "N/m^3", "1", "", None)] == [
        "N·s/m",
        "kg·m²",
        "N/m³",
        "",
        "",
        "",
    ]
    assert [percent(s) for s in (0.1234, 1.0, None, NAN)] == ["12.3 %", "100 %", NOTHING, NOTHING]


def test_a_narrow_interval_is_told_by_as_many_digits_as_it_needs():
    """It was 1.1 and 1.1 … 1.1."""
    assert with_interval(1.1, (1.09995, 1.10015)) == ("1.10000", "1.09995 … 1.10015")
    assert with_interval(25.3, (20.0, 31.0)) == ("25.3", "20.0 … 31.0")
    assert with_interval(3e-5, (2.9e-5, 3.1e-5)) == ("3e-5", "2.9e-5 … 3.1e-5")
    assert with_interval(1.5, (0.5, INFINITE)) == ("1.5", "0.5 … –")
