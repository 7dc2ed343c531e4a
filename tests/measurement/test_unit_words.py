"""Units of headers in other languages and in spellings of their own are read, and contradict another one."""

import h5py
import numpy as np
import pytest
import yaml

from gear_damping.measurement.formats.header import bracket_unit
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.formats.unit_words import as_ours
from gear_damping.measurement.inspection import inspect_table
from gear_damping.measurement.load import load_measurement

TIME = np.arange(200) / 100


def written(folder, time, name, below=""):
    values = 1500 + np.sin(20 * TIME)
    rows = "".join(f"{t:.2f};{x:.5f}\n" for t, x in zip(TIME, values, strict=True))
    (folder / "a.csv").write_text(f"{time};{name}\n{below}{rows}", encoding="utf-8")
    return folder / "a.csv"


def conflicts(folder, name, unit, more=""):
    written(folder, "t [s]", name)
    channels = {"time": {"column": 0}, "velocity": {"column": 1, "unit": unit} | yaml.safe_load(f"{{{more}}}")}
    text = yaml.safe_dump({"system": "oscillator", "records": [{"file": "a.csv", "channels": channels}]})
    (folder / "m.yaml").write_text(text)
    (record,) = load_measurement(folder / "m.yaml").records
    return [found for found in record.findings if found.kind == "unit_conflict"]


@pytest.mark.parametrize(
    ("said", "ours"),
    [
        ("seg", "s"), ("Sek.", "Sek"), ("sec.", "sec"), ("secondi", "s"), ("mseg", "ms"),
        ("Millisekunden", "ms"), ("mm/seg", "mm/s"), ("mm/sec.", "mm/sec"), ("giri/min", "rev/min"),
        ("giri/1'", "rev/min"), ("tours/min", "rev/min"), ("tr/mn", "rev/min"), ("vueltas/min", "rev/min"),
        ("obr/min", "rev/min"), ("U/s", "rev/s"), ("r.p.m.", "rpm"), ("Nmm", "N*mm"), ("N-m", "N*m"),
        ("N-mm", "N*mm"), ("kgf.m", "kgf*m"), ("kgf cm", "kgf*cm"), ("in-lb", "lbf*in"), ("lb-ft", "lbf*ft"),
        ("ft-lbs", "lbf*ft"), ("ozin", "ozf*in"), ("daNm", "daN*m"), ("Newtonmeter", "N*m"),
        ("мм", "mm"), ("м/с²", "m/s^2"), ("м/с2", "m/s^2"), ("мм/с", "mm/s"), ("об/мин", "rev/min"), ("Н·м", "N*m"),
        ("毫米", "mm"), ("转/分", "rev/min"),
        ("degrés", "deg"), ("mètres", "m"), ("µm", "µm"), ("1/min", "1/min"), ("U/V", "U/V"),
        ("filtered", "filtered"), ("min.", "min."), ("A side", "A side"), ("x.y.", "x.y."), ("kg·m", "kg·m"),
        ("", ""),
    ],
)  # fmt: skip
def test_what_a_header_says_is_spelt_as_here(said, ours):
    assert as_ours(said) == ours


@pytest.mark.parametrize(
    ("name", "unit", "right"),
    [
        ("v [mm/seg]", "m/s", "mm/s"),
        ("v (giri/min)", "rad/s", "rpm"),
        ("v [r.p.m.]", "rad/s", "rpm"),
        ("M [Nmm]", "N*m", "N*mm"),
        ("M (kgf.m)", "N*m", "kgf*m"),
        ("v/(mm/seg)", "m/s", "mm/s"),
    ],
)
def test_another_unit_beside_such_a_header_is_a_problem(name, unit, right, tmp_path):
    (found,) = conflicts(tmp_path, name, unit)
    assert found.severity == "data_problem"
    assert f"and the YAML '{unit}'" in found.message
    assert conflicts(tmp_path, name, right) == []
    assert conflicts(tmp_path, name, unit, "gain: 1") == []


@pytest.mark.parametrize(
    ("time", "below", "rate"),
    [("Tiempo (seg)", "", 100), ("t [Sek.]", "", 100), ("tempo [msec.]", "", 1e5), ("Zeit;v\n", "Sek.;r.p.m.\n", 100)],
)
def test_a_bare_file_has_the_clock_and_the_units_that_it_says(time, below, rate, tmp_path):
    name = "v [giri/min]"
    path = written(tmp_path, time, name) if not below else written(tmp_path, "Zeit", "v", below)
    found = inspect_table(read_table(path))
    assert found.time.guessed == ""
    assert found.rate == pytest.approx(rate)
    assert found.columns[1].unit == ("rpm" if below else "rev/min")


_ATTRIBUTES = [("mm/seg", "m/s", 1), ("mm/seg", "mm/s", 0), ("giri/min", "rpm", 0)]


@pytest.mark.parametrize(("said", "unit", "problems"), _ATTRIBUTES)
def test_an_attribute_is_read_as_a_header_is(said, unit, problems, tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"], file["v"] = TIME, np.sin(20 * TIME)
        file["t"].attrs["unit"], file["v"].attrs["units"] = "seg", said
    channels = {"time": {"column": "t"}, "velocity": {"column": "v", "unit": unit}}
    text = yaml.safe_dump({"system": "oscillator", "records": [{"file": "a.h5", "channels": channels}]})
    (tmp_path / "m.yaml").write_text(text)
    (record,) = load_measurement(tmp_path / "m.yaml").records
    assert record.sampling_rate == pytest.approx(100)
    assert [found.kind for found in record.findings].count("unit_conflict") == problems


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("Перемещение, мм", "mm"),
        ("Weg, mm", "mm"),
        ("Weg, A", None),
        ("x, mm", None),
        ("Weg, links", None),
        ("t, s", None),
    ],
)
def test_a_unit_behind_a_comma_is_that_of_the_word_before_it(name, unit):
    assert bracket_unit(name) == unit


def test_names_and_units_in_russian_are_read(tmp_path):
    found = inspect_table(read_table(written(tmp_path, "Время, мс", "Скорость (об/мин)")))
    assert (found.time.unit, found.columns[1].unit) == ("ms", "rev/min")
