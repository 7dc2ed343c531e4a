"""Units that stand among other words in the brackets of a header: they contradict another unit, descriptions do not."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.formats.header import bracket_unit
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.guessing import guessed
from gear_damping.measurement.load import load_measurement

SECONDS = np.arange(400) * 0.01
MOTION = np.exp(-0.4 * SECONDS) * np.cos(12 * SECONDS)


def loaded(folder, head, unit, channel="displacement", clock="t", time="s", more=""):
    """The record of a table of a clock and a motion, whose header is `head`."""
    rows = "\n".join(f"{t:.4f};{x:.6f}" for t, x in zip(SECONDS, MOTION, strict=True))
    (folder / "a.csv").write_text(f"{clock};{head}\n{rows}\n")
    (folder / "m.yaml").write_text(
        f"system: oscillator\nrecords:\n  - file: a.csv\n    channels:\n      time: {{column: 0, unit: {time}}}\n"
        f"      {channel}: {{column: 1{f', unit: {unit}' if unit else ''}{more}}}\n"
    )
    return load_measurement(folder / "m.yaml").records[0]


def conflicts(record):
    return [found.message for found in record.findings if found.kind == "unit_conflict"]


OTHERS = {  # what the header says, the unit that is declared and the word that contradicts it
    "Disp (mm, LP 1kHz)": ("m", "mm"), "Disp [mm rms]": ("m", "mm"), "Disp [mm p-p]": ("m", "mm"),
    "Disp (mm - filtered)": ("m", "mm"), "Disp (in mm)": ("m", "mm"), "Disp {mm}": ("m", "mm"),
    "Disp <mm>": ("m", "mm"), "Disp (millimeter)": ("m", "millimeter"), "Disp [mm] (filtered)": ("m", "mm"),
    "Disp (raw, mm)": ("m", "mm"), "Disp [mm-pp]": ("m", "mm"), "Disp (left, m)": ("mm", "m"),
    "Disp (m, left)": ("mm", "m"), "Disp [um eff]": ("mm", "um"),
}  # fmt: skip


@pytest.mark.parametrize("head", OTHERS)
def test_a_unit_among_words_contradicts_another_one(head, tmp_path):
    unit, word = OTHERS[head]
    (message,) = conflicts(loaded(tmp_path, head, unit))
    assert word in message
    assert f"the YAML '{unit}', which was used" in message
    assert not conflicts(loaded(tmp_path, head, word))


@pytest.mark.parametrize("head", ["Acc (g pk)", "Acc [g rms]", "Acc (grms)", "Acc (g, DC)", "Acc [g_pk]"])
def test_one_letter_counts_beside_what_says_how_its_level_is_taken(head, tmp_path):
    assert conflicts(loaded(tmp_path, head, "m/s^2", "acceleration"))
    assert not conflicts(loaded(tmp_path, head, "g", "acceleration"))


@pytest.mark.parametrize("head", ["Disp (mm, LP 1kHz)", "Disp (raw, mm)", "Disp*1000 [mm]", "Disp (x10^-3 m)"])
def test_a_gain_says_that_the_word_is_no_unit(head, tmp_path):
    (message,) = conflicts(loaded(tmp_path, head, "m"))
    assert "gain: 1 where" in message
    assert not conflicts(loaded(tmp_path, head, "m", more=", gain: 1"))


@pytest.mark.parametrize(
    "head",
    [
        "Weg (filtered)", "Weg (left)", "Weg [ch 1]", "Weg (A side)", "Weg (App)", "Weg (second stage)", "Weg (in B)",
        "Weg (LP 1 kHz)", "Weg (probe 3 mm)", "Weg (at 1500 rpm)", "Weg (min of 3)", "Weg (bar 3)", "Weg <1>", "x_{m}",
        "Weg x2", "Weg (m filtered)",
    ],
)  # fmt: skip
def test_a_description_contradicts_nothing(head, tmp_path):
    assert not conflicts(loaded(tmp_path, head, "um"))


@pytest.mark.parametrize(
    ("head", "said"),
    [
        ("Disp*1000 [mm]", "mm*1000"), ("Disp x1000 (mm)", "mm*1000"), ("Disp/1000 [mm]", "mm/1000"),
        ("CH x2 [V]", "V"), ("ai/1 [V]", "V"), ("a2/10 [V]", "V/10"),
    ],
)  # fmt: skip
def test_a_factor_before_the_brackets_is_seen(head, said):
    assert bracket_unit(head) == said


def test_a_factor_before_the_brackets_asks_for_a_gain(tmp_path):
    (message,) = conflicts(loaded(tmp_path, "Disp*1000 [mm]", "mm"))
    assert "says 'mm*1000' and the YAML 'mm', which was used; write gain: what the column holds for one mm" in message


@pytest.mark.parametrize("step", ["x10^-3 m", "x 10^-3 m", "×10⁻³ m", "*1e-3 m", "10^-3 m"])
def test_a_step_in_a_row_of_units_contradicts_the_whole_unit(step, tmp_path):
    (message,) = conflicts(loaded(tmp_path, f"x\ns;{step}", "m"))
    assert f"says '{step}' and the YAML 'm', which was used; write gain: 1000" in message
    assert not conflicts(loaded(tmp_path, f"x\ns;{step}", "mm"))


def test_a_clock_among_words_contradicts_another_unit(tmp_path):
    with pytest.raises(InputError, match=r"channels.time.unit = 's': the header of column '0' says 'ms'"):
        loaded(tmp_path, "x", "mm", clock="Time (ms, relative)")


def test_what_stands_among_words_is_the_unit_where_none_is_declared(tmp_path):
    record = loaded(tmp_path, "Disp (mm, LP 1kHz)", "")
    assert record.channels["displacement"].unit == "mm"
    _, _, listed = guessed(read_table(tmp_path / "a.csv"))
    assert [(guess.unit, guess.unit_by) for guess in listed] == [("mm", "")]
