"""Figures over a frequency that may be none are no figures."""

import pytest

from gear_damping.interface.identified_oscillator import _table


@pytest.mark.parametrize(("low", "is_shown"), [(3.1, True), (-6.9, False), (0.0, False), (float("nan"), False)])
def test_a_damping_ratio_over_no_frequency_is_not_shown(low, is_shown):
    ratio = {"value": 6.9e8, "interval95": (-1e16, 1e16), "unit": "%"}
    frequency = {"value": 3.2, "interval95": (low, 7.0), "unit": "Hz"}
    stiffness = {"value": 404.0, "interval95": (403.0, 405.0), "unit": "1/s^2"}
    content = {
        "damping_ratio_percent": ratio, "natural_frequency_hz": frequency, "log_decrement": None, "records": {},
        "parameters": {"stiffness": stiffness}, "segment_s": None,
    }  # fmt: skip
    text = _table(content)
    assert ("damping_ratio_percent" in text) == ("natural_frequency_hz" in text) == is_shown
    assert "stiffness" in text
