"""The unit of a gain comes back as people write it."""

import pytest

from gear_damping.measurement.declared_units import _gain_text
from gear_damping.units import parse_unit


@pytest.mark.parametrize(
    ("response", "per", "force", "text"),
    [
        ("rad/s", "/s", "V", "rad/s^2/V"),
        ("rad", "/s^2", "1", "rad/s^2"),
        ("m/s^2", "", "V", "m/s^2/V"),
        ("mm", "/s^2", "N*m", "mm/s^2/(N*m)"),
        ("rad/s", "/s", "rad/s", "rad/s^2/(rad/s)"),
    ],
)
def test_it_is_one_line_of_a_fraction(response, per, force, text):
    assert _gain_text(response, per, force) == text
    assert parse_unit(text).dimension == parse_unit(f"{response}{per}/({force})").dimension
