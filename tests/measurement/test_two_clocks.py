"""Channels on clocks of their own: a force beside a displacement, both of one known motion, laid on one time."""

from datetime import datetime, timedelta

import numpy as np
import pytest
import yaml

from gear_damping.errors import InputError
from gear_damping.measurement.load import load_measurement

RATE, COUNT = 200.0, 400
TIME = np.arange(COUNT) / RATE
NOON = datetime(2024, 3, 1, 12)
LATE = 0.5  # s by which the displacement's clock begins behind that of the force
CLOCKS = {"time": {"column": "tx"}}
FORCE = {"column": "F", "unit": "N"}


def wave(time):
    """What both channels follow, by the time of the force's clock."""
    return np.sin(7 * time) + 0.3 * np.cos(11 * time)


def loaded(folder, file, force, **channels):
    record = {"name": "a", "file": file, "channels": {"displacement": {"column": "x", "unit": "mm"}, "force": force}}
    record["channels"] |= channels
    (folder / "m.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": [record]}))
    return load_measurement(folder / "m.yaml").records[0]


def is_on_one_time(record, late=0.0):
    """Whether the force lies on the displacement's time, apart from the ends of splines and filters."""
    inner = slice(30, -30)
    return np.allclose(record.channels["force"].values[inner], wave(record.time + late)[inner], atol=2e-3)


@pytest.mark.parametrize(
    ("of_x", "of_force"),
    [
        ("%Y-%m-%d %H:%M:%S.%f", "%Y-%m-%d %H:%M:%S.%f"),
        ("%H:%M:%S.%f", "%H:%M:%S.%f"),
        ("%Y-%m-%d %H:%M:%S.%f", "%H:%M:%S.%f"),
    ],
    ids=["dates", "clocks", "a date beside a clock"],
)
def test_what_parts_two_clocks_of_a_text_is_kept(tmp_path, of_x, of_force):
    longer = np.arange(COUNT + int(LATE * RATE)) / RATE
    rows = ["tx,x,tF,F"]
    for k, t in enumerate(longer):
        own = [(NOON + timedelta(seconds=LATE + t)).strftime(of_x), "1.5"] if k < COUNT else ["", ""]
        rows.append(",".join([*own, (NOON + timedelta(seconds=t)).strftime(of_force), f"{wave(t):.6f}"]))
    (tmp_path / "a.csv").write_text("\n".join(rows))
    record = loaded(tmp_path, "a.csv", FORCE | {"time": {"column": "tF"}}, **CLOCKS)
    assert len(record.time) == COUNT
    assert is_on_one_time(record, LATE)


def test_what_parts_two_clocks_of_a_workbook_is_kept(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.append(["tx", "x", "tF", "F"])
    for t in np.arange(COUNT + int(LATE * RATE)) / RATE:
        own = [NOON + timedelta(seconds=LATE + t), 1.5] if t < TIME[-1] + 0.5 / RATE else [None, None]
        book.active.append([*own, NOON + timedelta(seconds=t), float(wave(t))])
    book.save(tmp_path / "a.xlsx")
    record = loaded(tmp_path, "a.xlsx", FORCE | {"time": {"column": "tF"}}, **CLOCKS)
    assert is_on_one_time(record, LATE)


def test_an_empty_cell_among_dates_is_a_fault_of_its_own_rows(tmp_path):
    cells = [(NOON + timedelta(seconds=t)).strftime("%Y-%m-%d %H:%M:%S.%f") for t in TIME]
    rows = [
        f"{'' if k == 3 else cell},{wave(t):.6f},{wave(t):.6f}"
        for k, (cell, t) in enumerate(zip(cells, TIME, strict=True))
    ]
    (tmp_path / "a.csv").write_text("\n".join(["tx,x,F", *rows]))
    with pytest.raises(InputError, match=r"row 3 \(line 5\), column 0 'tx'.*an empty cell"):
        loaded(tmp_path, "a.csv", FORCE, **CLOCKS)
    text = (tmp_path / "m.yaml").read_text().replace("  file:", "  slice: [10, 400]\n  file:")
    (tmp_path / "m.yaml").write_text(text)
    assert load_measurement(tmp_path / "m.yaml").records[0].time[0] == pytest.approx(10 / RATE)


@pytest.fixture
def two_rates(tmp_path):
    """An HDF5 file with 2 s of x and t at 200 Hz, and of F at 1 kHz, which says so."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"], file["x"] = TIME, wave(TIME)
        file["F"] = wave(np.arange(5 * COUNT) / (5 * RATE))
        file["F"].attrs["fs"] = 5 * RATE
    return tmp_path


@pytest.mark.parametrize(
    "clock",
    [{"time": {"column": "t", "unit": "s"}}, {"sampling_rate": {"value": RATE, "unit": "Hz"}}],
    ids=["stamps", "a rate"],
)
def test_a_rate_that_the_file_gives_one_channel_is_its_own(two_rates, clock):
    record = loaded(two_rates, "a.h5", FORCE, **clock)
    assert len(record.time) == COUNT
    assert is_on_one_time(record)
    assert any("force: filtered and taken from 1000 Hz" in note for note in record.notes)


def test_a_rate_of_1_hz_beside_stamps_is_one_that_nobody_set(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"], file["x"], file["F"] = TIME, wave(TIME), wave(TIME)
        file["F"].attrs["dt"] = 1.0
    record = loaded(tmp_path, "a.h5", FORCE, time={"column": "t", "unit": "s"})
    assert len(record.time) == COUNT
    assert is_on_one_time(record)


def test_a_declared_rate_of_a_channel_that_contradicts_the_file_is_said(two_rates):
    force = FORCE | {"sampling_rate": {"value": 500, "unit": "Hz"}}
    record = loaded(two_rates, "a.h5", force, time={"column": "t", "unit": "s"})
    said = [one for one in record.findings if one.kind == "rate_conflict"]
    assert [(one.channel, one.severity) for one in said] == [("force", "data_problem")]
    assert "the file itself says 1000 Hz and sampling_rate 500 Hz" in said[0].message


def test_a_longer_column_is_not_cut_to_the_record_in_silence(tmp_path):
    np.savez(tmp_path / "a.npz", t=TIME, x=wave(TIME), F=wave(np.arange(5 * COUNT) / (5 * RATE)))
    clock = {"time": {"column": "t", "unit": "s"}}
    with pytest.raises(InputError, match=r"column 'F' has 2000 samples, the record 400.*own time or sampling_rate"):
        loaded(tmp_path, "a.npz", FORCE, **clock)
    record = loaded(tmp_path, "a.npz", FORCE | {"sampling_rate": {"value": 5 * RATE, "unit": "Hz"}}, **clock)
    assert is_on_one_time(record)
    np.savez(tmp_path / "a.npz", t=TIME[:-1], x=wave(TIME), F=wave(TIME))  # of np.arange, one less
    assert is_on_one_time(loaded(tmp_path, "a.npz", FORCE, **clock))


@pytest.mark.parametrize(
    ("clock", "times"), [({"sampling_rate": "0.2 Hz"}, 1000), ({"time": {"column": "tf", "unit": "s"}}, 1000)]
)
def test_rows_that_last_a_thousand_times_as_long_as_those_beside_them_are_said(tmp_path, clock, times):
    table = np.column_stack([TIME, wave(TIME), 1000 * TIME, wave(TIME)])
    np.savetxt(tmp_path / "a.csv", table, header="tx,x,tf,F", comments="", delimiter=",", fmt="%.6f")
    record = {"name": "a", "file": "a.csv", "channels": {"displacement": {"column": "x", "unit": "mm"}}}
    record["channels"] |= {"time": {"column": "tx", "unit": "s"}, "force": FORCE | clock}
    (tmp_path / "m.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": [record]}))
    said = [found.message for found in load_measurement(tmp_path / "m.yaml").findings if found.kind == "two_clocks"]
    assert len(said) == 1
    assert f"over as many rows: they last {times} times as long" in said[0]
    record["channels"]["force"] = FORCE | {"time": {"column": "tx", "unit": "s"}}
    (tmp_path / "m.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": [record]}))
    assert not [found for found in load_measurement(tmp_path / "m.yaml").findings if found.kind == "two_clocks"]
