"""The unit of a rate that a file states above its table, and what is said of one that is not read."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.formats.stated_rate import stated_rate, unread_rate
from gear_damping.measurement.guessing import guessed
from gear_damping.measurement.inspection import inspect_table
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.starting_yaml import starting_yaml

MOTION = np.exp(-0.01 * np.arange(300)) * np.cos(0.3 * np.arange(300))
RATE = 2000.0


def table_of(folder, head, sign=",", decimal=".", numbered=False):
    numbers = [f"{k}{sign}" if numbered else "" for k in range(MOTION.size)]
    rows = [f"{n}{x:.5f}{sign}{x * x:.5f}".replace(".", decimal) for n, x in zip(numbers, MOTION, strict=True)]
    (folder / "a.csv").write_text(head + "\n".join(rows) + "\n", encoding="utf-8")
    return read_table(folder / "a.csv")


@pytest.mark.parametrize(
    "said",
    [
        "Sample rate: 2 ksps", "Sample rate: 2 kSPS", "Sample rate: 2 k", "Sample rate: 2k",
        "Sample rate: 2 kSamples/s", "Sample rate: 2 kS/sec", "Sample rate: 2 kHz/ch", "Sample rate: 2 kpts/s",
        "Sample rate: 2 [kHz]", "Sample rate (kSPS): 2", "Sample rate (k): 2", "Sample rate in kHz: 2",
        "Sample rate kHz: 2", "Sample interval: 0.5 millisec", "Sample rate: 120000 samples/min",
        "Sample rate: 2000 samples per second", "Sample rate: 0.5 ms", "Sample rate: 2000±1 Hz",
        "Sample rate (per channel): 2 kHz", "Sample rate: 2000 per channel", "tInc = 5.0e-04", "#CLOCK:500us",
        "#CLOCK=500uS", "2000 SPS", "Rate: 2 kHz", "Sample rate: 2.000,0 Hz", "Sample rate: 2,000.0 Hz",
        "time step h: 0.0005", "Sampling time: 0.5 ms", "Sample time [us]: 500", "Abtastzeit: 0,5 ms",
        "Tastzeit = 500 us", "Période d'échantillonnage: 0.5 ms", "Tempo di campionamento: 0.5 ms",
        "Sample rate: 2000; mode=fast", "dt = 0.0005 mode: fast", "Sample rate: 2 kHz mode: fast", "fs=2 kHz N=1500",
        "dt = 0.5 ms mode: fast", "Fs (Hz),2000", "Sampling: 2 kHz", "Abtastung: 2000 Hz", "sampled at 2 kHz",
        "Zeitschritt 0.5 ms",
    ],
)  # fmt: skip
def test_units_of_rates_are_read_as_people_write_them(said):
    words, rate = stated_rate([[said]])
    assert rate == pytest.approx(RATE)
    assert words
    assert unread_rate([[said]]) == ""


@pytest.mark.parametrize(
    "said",
    [
        "Sample rate: 2 kfoo", "Sample rate (foo): 2", "Sample rate in foo: 2", "Sample rate: 1/2000 s",
        "Sample interval: 1/2000", "Sample interval: 1 s per turn", "Sample rate [Hz]: 2 kHz", "X inc: 0.5 mm",
        "Sample rate: 2,000 Hz", "Sample rate: 2 k samples/foo", "Sample interval: 2 k", "Rate: 2000",
        "Sample rate: 4000 Hz (2 channels)", "dt 10", "Sample interval: 5", "Frequency: 1000 Hz", "Frequenz,1,kHz",
        "Time base: 1 ms", "Sampling period: 40.000",
    ],
)  # fmt: skip
def test_a_rate_whose_unit_is_not_read_is_none(said):
    assert stated_rate([[said]]) is None
    assert unread_rate([[said]]) == said


@pytest.mark.parametrize(
    "said",
    [
        "Rate: 5 mm/s",
        "clock: 12 s",
        "Sampling time: 10 s",
        "Sampling time: 500 ms",
        "Sample time: 12:30",
        "Clock: 16 MHz",
        "version 1.2.3",
        "Sampling: 10 s",
        "Sampling: yes, 3",
        "Natural frequency: 8 Hz",
        "Frequency: 1000",
    ],
)
def test_what_is_no_rate_of_samples_is_not_told_as_one(said):
    assert stated_rate([[said]]) is None
    assert unread_rate([[said]]) == ""


@pytest.mark.parametrize(("said", "rate"), [("2.000", None), ("2.000,0", RATE), ("2000.000", RATE), ("0.001", 1e-3)])
def test_beside_decimal_commas_a_point_before_three_digits_may_part_thousands(tmp_path, said, rate):
    table = table_of(tmp_path, f"Abtastrate [Hz];{said}\n\nx;y\n", ";", ",")
    assert table.stated_rate == (rate and ("Abtastrate", pytest.approx(rate)))
    assert table.unread_rate == ("" if rate else f"Abtastrate [Hz] {said}")


def test_a_rate_that_is_not_read_is_asked_for_in_the_words_of_the_file(tmp_path):
    found, system, listed = guessed(table_of(tmp_path, "Sample rate: 2 kfoo\n\nx [V],y [V]\n"))
    assert found.rate is None
    yaml = starting_yaml(found, system, listed)
    assert (
        "sampling_rate: {value: \"???\", unit: Hz}   # the file says 'Sample rate: 2 kfoo', which is not read" in yaml
    )
    (tmp_path / "a.yaml").write_text(
        "system: oscillator\nrecords:\n- file: a.csv\n  channels:\n    displacement: {column: 'x [V]', unit: V}\n"
    )
    with pytest.raises(InputError, match="for what 'Sample rate: 2 kfoo' in the file means, which is not read"):
        load_measurement(tmp_path / "a.yaml")


def test_a_right_rate_beside_one_in_another_spelling_is_not_contradicted(tmp_path):
    table_of(tmp_path, "Sample rate in kHz: 2\n\nx [V],y [V]\n")
    (tmp_path / "a.yaml").write_text(
        "system: oscillator\nrecords:\n- file: a.csv\n  channels:\n    sampling_rate: 2000 Hz\n"
        "    displacement: {column: 'x [V]', unit: V}\n"
    )
    assert "rate_conflict" not in [one.kind for one in load_measurement(tmp_path / "a.yaml").findings]


@pytest.mark.parametrize("head", ["#CLOCK:500us\n", "#CLOCK:500us\nt,x,y\n"])
def test_numbers_of_rows_beside_a_stated_rate_are_no_time(tmp_path, head):
    found = inspect_table(table_of(tmp_path, head, numbered=True))
    assert found.time is None
    assert found.rate == RATE
    assert found.columns[0].kind == "row number"


def test_stamps_that_a_stated_rate_agrees_with_stay(tmp_path):
    found = inspect_table(table_of(tmp_path, "#CLOCK:1000us\n", numbered=True))
    assert (found.time.unit, found.rate) == ("ms", pytest.approx(1000.0))


@pytest.mark.parametrize(("step", "unit"), [(0.5, "ms"), (500, "us"), (0.0005, "s")])
def test_a_stated_rate_tells_in_which_unit_stamps_without_one_count(tmp_path, step, unit):
    head = "Sample rate: 2000 Hz\n\nt,x\n"
    (tmp_path / "a.csv").write_text(head + "".join(f"{k * step:.10g},{x}\n" for k, x in enumerate(MOTION)))
    found = inspect_table(read_table(tmp_path / "a.csv"))
    assert (found.time.unit, found.rate) == (unit, pytest.approx(RATE))
    assert ("as 'Sample rate' says" in found.time.guessed) == (unit == "ms")


@pytest.mark.parametrize(
    ("unit", "head", "said"),
    [
        ("s", "Sample rate: 2 kHz", ""), ("s", "Sample rate: 2.04 kHz", ""), ("s", "Sample rate: 2 kfoo", ""),
        ("s", "Sample rate: 1 kHz", "'Sample rate' beside the table says 1000 Hz and the time stamps 2000 Hz"),
        ("ms", "Abtastrate: 2 kHz", "'Abtastrate' beside the table says 2000 Hz and the time stamps 2e+06 Hz"),
        ("s", "Sample interval: 1 ms", "'Sample interval' beside the table says 1000 Hz and the time stamps 2000 Hz"),
    ],
)  # fmt: skip
def test_a_stated_rate_that_stamps_contradict_is_said(tmp_path, unit, head, said):
    (tmp_path / "a.csv").write_text(f"{head}\n\nt;x\n" + "".join(f"{k / RATE};{x}\n" for k, x in enumerate(MOTION)))
    (tmp_path / "a.yaml").write_text(
        "system: oscillator\nrecords:\n- file: a.csv\n  channels:\n    time: {column: t, unit: "
        + unit
        + "}\n    displacement: {column: x, unit: V}\n"
    )
    found = [one for one in load_measurement(tmp_path / "a.yaml").findings if one.kind == "rate_conflict"]
    assert [one.message.partition(", which was used; correct the unit")[0] for one in found] == [said] * bool(said)
    assert all(one.severity == "note" for one in found)
