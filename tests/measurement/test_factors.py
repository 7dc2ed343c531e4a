"""Factors and spellings of units beside the name of a column contradict the whole unit; channels' names do not."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.formats.header import bracket_unit
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.guessing import guessed
from gear_damping.measurement.load import load_measurement

SECONDS = np.arange(400) * 0.01
MOTION = np.exp(-0.4 * SECONDS) * np.cos(12 * SECONDS)
ROWS = [f"{t:.4f};{x:.6f}" for t, x in zip(SECONDS, MOTION, strict=True)]


def conflicts(folder, head, unit, channel="displacement", above="", more=""):
    """What is said of the unit of a table's motion, whose header is `head`."""
    (folder / "a.csv").write_text("\n".join([above + head, *ROWS]) + "\n", encoding="utf-8")
    (folder / "m.yaml").write_text(
        f"system: oscillator\nrecords:\n  - file: a.csv\n    channels:\n      time: {{column: 0, unit: s}}\n"
        f"      {channel}: {{column: 1, unit: {unit}{more}}}\n"
    )
    (record,) = load_measurement(folder / "m.yaml").records
    return [found.message for found in record.findings if found.kind == "unit_conflict"]


STEPS = {  # what a header says, the step that it counts in and the gain for one whole unit
    "x / 10^-6 m": ("10^-6 m", 1e6), "x / 10⁻⁶ m": ("10⁻⁶ m", 1e6), "x in 10^-6 m": ("10^-6 m", 1e6),
    "x/10^-6m": ("10^-6 m", 1e6), "x [E-3 m]": ("1e-3 m", 1e3), "x [1E-3 m]": ("1e-3 m", 1e3),
    "x / 10**-3 m": ("10^-3 m", 1e3), "x (x 0.001 m)": ("0.001 m", 1e3), "x / 1e-3 m": ("1e-3 m", 1e3),
}  # fmt: skip


@pytest.mark.parametrize("head", STEPS)
def test_a_power_of_ten_before_a_unit_is_a_step(head, tmp_path):
    step, gain = STEPS[head]
    (message,) = conflicts(tmp_path, f"t;{head}", "m")
    assert f"says '{step}' and the YAML 'm', which was used; write gain: {gain:.6g}" in message
    assert not conflicts(tmp_path, f"t;{head}", "m", more=f", gain: {gain:.0f}")


SCALED = {
    "x*10^6 / m": "m*10^6", "x·10³ / m": "m*10³", "x x 1000 / m": "m*1000", "10^3 x (m)": "m*10^3",
    "x [m E-3]": "m*1e-3", "x_x100_m": "m*100", "x [m] (x10)": "m*10", "x*10^6 in m": "m*10^6", "x·10⁻³ [m]": "m*10⁻³",
}  # fmt: skip


@pytest.mark.parametrize("head", SCALED)
def test_a_factor_elsewhere_is_asked_for(head, tmp_path):
    (message,) = conflicts(tmp_path, f"t;{head}", "m")
    assert f"says '{SCALED[head]}' and the YAML 'm', which was used; write gain: what the column holds" in message
    assert not conflicts(tmp_path, f"t;{head}", "m", more=", gain: 1")


@pytest.mark.parametrize("head", [*STEPS, *SCALED])
def test_a_unit_with_a_factor_is_not_guessed_without_it(head, tmp_path):
    (tmp_path / "a.csv").write_text("\n".join([f"t;{head}", *ROWS]) + "\n", encoding="utf-8")
    (guess,) = [one for one in guessed(read_table(tmp_path / "a.csv"))[2] if one.used]
    assert guess.unit == "???"


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("CH x2 [V]", "V"), ("CH1_x10 [V]", "V"), ("Probe (E1 V)", "E1 V"), ("Weg / mm", "mm"), ("a/(m/s^2)", "m/s^2"),
        ("x [V] (x2)", "V"), ("Ch1 [g] 10", "g"), ("run/10 m", None),
    ],
)  # fmt: skip
def test_numbers_of_channels_are_no_factors(name, unit):
    assert bracket_unit(name) == unit


SPELT = {
    "a [mG]": ("g", "mg"), "a [milli g]": ("g", "mg"), "a [mG] ": ("m/s^2", "mg"), "x (milli-m)": ("m", "mm"),
    'x ["]': ("mm", "in"), "x [micro m]": ("mm", "um"), "phi [']": ("deg", "arcmin"), "U [milli V]": ("V", "mV"),
}  # fmt: skip


@pytest.mark.parametrize("head", SPELT)
def test_units_in_spellings_of_their_own_contradict_another_one(head, tmp_path):
    unit, word = SPELT[head]
    channel = "acceleration" if head.startswith("a ") else "displacement"
    (message,) = conflicts(tmp_path, f"t;{head}", unit, channel)
    assert f"where {word} may be the unit, and the YAML '{unit}', which was used" in message
    assert not conflicts(tmp_path, f"t;{head}", word, channel)


def test_a_level_contradicts_the_unit_of_a_signal(tmp_path):
    (message,) = conflicts(tmp_path, "t;x [dBV]", "V")
    assert "says 'dBV', a level, which is a logarithm, and the YAML 'V', which was used" in message
    assert not conflicts(tmp_path, "t;x [dBV]", "V", more=", gain: 1")


@pytest.mark.parametrize("word", ["LSB", "counts", "ADC counts", "px"])
def test_counts_in_a_header_contradict_a_unit_without_their_number(tmp_path, word):
    (message,) = conflicts(tmp_path, f"t;x ({word})", "mm")
    assert f"says '{word}', and the YAML 'mm', which was used; write gain: the counts of one mm" in message
    assert not conflicts(tmp_path, f"t;x ({word})", "mm", more=", gain: 1638.4")
    assert not conflicts(tmp_path, f"t;x ({word})", "'1'")
    assert not conflicts(tmp_path, "t;x (raw)", "mm")


@pytest.mark.parametrize("above", ["X Units: s\nY Units: um\n", "Horizontal Units;s\nVertical Units;um\n"])
def test_units_of_axes_above_a_table_are_those_of_its_two_columns(above, tmp_path):
    (message,) = conflicts(tmp_path, "t;x", "mm", above=above)
    assert "says 'um' and the YAML 'mm'" in message
    assert not conflicts(tmp_path, "t;x", "um", above=above)
    table = read_table(tmp_path / "a.csv")
    assert [table.unit(k) for k in range(2)] == ["s", "um"]


def test_another_unit_of_the_axis_of_time_is_refused(tmp_path):
    with pytest.raises(InputError, match="the header of column '0' says 'ms'"):
        conflicts(tmp_path, "t;x", "mm", above="X Units: ms\n")


@pytest.mark.parametrize("above", ["Y Units: foo\n", "Y Units: um\nY Units: mm\n"])
def test_units_of_axes_that_say_nothing_sure_are_none(above, tmp_path):
    assert not conflicts(tmp_path, "t;x", "mm", above=above)


def test_units_of_axes_say_nothing_of_three_columns(tmp_path):
    (tmp_path / "a.csv").write_text("\n".join(["Y Units: um", "t;x;y", *(f"{row};1" for row in ROWS)]) + "\n")
    assert [read_table(tmp_path / "a.csv").unit(k) for k in range(3)] == [None, None, None]
