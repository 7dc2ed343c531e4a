"""Every quantity of measurement.yaml is read as it is spoken, as {value, unit} is."""

from typing import get_args

import pytest
from pydantic import BaseModel

from gear_damping.errors import InputError
from gear_damping.measurement import layout
from gear_damping.measurement.quantities import Cutoff, Measured
from gear_damping.schema.mappings import read_declared
from gear_damping.schema.values import Problems

SPOKEN = {  # the text, and what it means, by the unit that is expected
    "Hz": ("3kHz", 3, "kHz"), "s": ("20 ms", 20, "ms"), "m": ("3mm", 3, "mm"), "rad": ("20deg", 20, "deg"),
    "kg*m^2": ("0.01 kg*m^2", 0.01, "kg*m^2"), "N/m": ("1e8N/m", 1e8, "N/m"), "kg": ("0.4kg", 0.4, "kg"),
    "N*m": ("100 Nm", 100, "Nm"), "1/s^2": ("40 1/s^2", 40, "1/s^2"), "1/s": ("3 1/s", 3, "1/s"),
    "rad/s": ("4600rpm", 4600, "rpm"), "1": ("120 %", 120, "%"), "own": ("2 m/s^2/V", 2, "m/s^2/V"),
    None: ("3mV", 3, "mV"),
}  # fmt: skip


def kinds(model, seen):
    """Every kind of quantity below a model, with its place."""
    if model in seen:
        return
    seen.add(model)
    for name, field in model.model_fields.items():
        for part in field.metadata:
            if isinstance(part, Measured):
                yield f"{model.__name__}.{name}", part
        stack = [field.annotation]
        while stack:
            inner = stack.pop()
            stack += get_args(inner)
            if isinstance(inner, type) and issubclass(inner, BaseModel):
                yield from kinds(inner, seen)
            elif isinstance(inner, Measured):
                yield f"{model.__name__}.{name}", inner


EVERY = {place: kind for file in layout.FILES.values() for place, kind in kinds(file, set())}


def test_there_are_as_many_as_the_page_lists():
    assert len(EVERY) > 40
    assert {kind.unit for kind in EVERY.values()} == set(SPOKEN)


@pytest.mark.parametrize("place", EVERY)
def test_it_is_read_as_it_is_spoken(place):
    kind = EVERY[place]
    text, value, unit = (25, 25, "1") if kind.whole else SPOKEN[kind.unit]
    assert kind.read(text, "x") == kind.read({"value": value, "unit": unit}, "x")


@pytest.mark.parametrize(
    "window",
    [{"from": 0.01, "to": 0.2, "unit": "s"}, {"from": 10, "to": 200, "unit": "ms"}, {"from": "10 ms", "to": "0.2 s"},
     {"from": {"value": 10, "unit": "ms"}, "to": "200ms"}, {"from": "10ms", "to": 0.2, "unit": "s"}],
)  # fmt: skip
def test_a_window_is_said_with_its_unit_beside_or_at_each_time(window):
    problems = Problems()
    found = read_declared(layout.Window, window, problems, "a.yaml")
    assert not problems
    assert found.seconds == pytest.approx((0.01, 0.2))


@pytest.mark.parametrize(
    ("window", "key", "rule"),
    [({"from": 1, "to": 2}, "unit", "is missing"), ({"from": "1 s", "to": 2}, "unit", "is missing"),
     ({"from": "1 s", "to": "2 s", "unit": "ms"}, "unit", "has no effect"),
     ({"from": "1 mm", "to": "2 s"}, "from", "not one of the kind of 's'"),
     ({"from": "300 ms", "to": "0.2 s"}, "from", "must lie before 'to'"), ({"from": "soon", "to": "2 s"}, "from", "")],
)  # fmt: skip
def test_a_window_that_is_none_is_refused_by_its_key(window, key, rule):
    problems = Problems()
    read_declared(layout.Window, window, problems, "a.yaml")
    assert problems[0].key == key
    assert rule in problems[0].rule


def test_a_relative_uncertainty_may_be_in_percent():
    given = {"value": 1, "unit": "N/m", "uncertainty": "5 %"}
    assert Measured("N/m", uncertain=True).read(given, "x").uncertainty == 0.05


@pytest.mark.parametrize(
    ("given", "kind", "found"),
    [
        ({"value": "5 %", "uncertainty": 0.02}, Measured("1", uncertain=True), 0.05),
        ({"value": "2.5 mm", "uncertainty": "1 %"}, Measured("m", uncertain=True), 0.0025),
    ],
)
def test_the_unit_may_stand_behind_the_value_of_a_mapping(given, kind, found):
    assert kind.read(given, "x").value == found


@pytest.mark.parametrize("unit", ["1/s", "s^-1"])
def test_a_corner_by_the_second_may_be_of_turns_or_of_radians(unit):
    with pytest.raises(InputError, match="may count turns or radians"):
        Cutoff().read({"value": 25, "unit": unit}, "lowpass")
    assert Cutoff().read({"value": "10 kHz", "order": 4}, "lowpass").frequency == 1e4
