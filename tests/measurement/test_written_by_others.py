"""Files as other programs write them, each beside the plain file that holds the same numbers."""

import numpy as np
import pytest
import yaml

from gear_damping.errors import InputError
from gear_damping.measurement.column_kinds import SIGNAL
from gear_damping.measurement.column_kinds import TIME as TIME_STAMPS
from gear_damping.measurement.files import read_yaml
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.inspection import inspect_table
from gear_damping.measurement.load import load_measurement

RATE = 200.0
TIME = np.arange(60) / RATE
WAVE = np.round(5 * np.cos(23 * TIME), 4)
ROWS = [f"{t:.4f},{x:.4f}" for t, x in zip(TIME, WAVE, strict=True)]


def _table(folder, text: str, name: str = "a.csv"):
    (folder / name).write_bytes(text.encode())
    return read_table(folder / name)


def _wave(table) -> list[float]:
    return table.values(table.index("x", "")).tolist()


def _ruled(rows: list[str]) -> str:
    return "\n".join("| " + row.replace(",", " | ") + " |" for row in rows)


@pytest.mark.parametrize(
    "text",
    [
        "t,x\r\r\n" + "\r\r\n".join(ROWS) + "\r\r\n",
        "Rig 5\rrun 2\nt,x\n" + "\n".join(ROWS),
        '"t\r[s]","x\r[mm]"\n' + "\n".join(ROWS),
        "t,x\r" + "\r".join(ROWS) + "\r# end\n",
        "t,x\n" + "\n".join(ROWS) + "\n\x1a",
        "t,x,remark\n" + ",\n".join(ROWS[:-1]) + ",\n" + ROWS[-1] + ",ok; done",
        "t,x,remark\n" + "\n".join(f"{row},{'stopping' if k > 40 else ''}" for k, row in enumerate(ROWS)),
        "t,x\n" + "\n".join(ROWS) + "\nend of data; 60 rows",
        "| t | x |\n|---|---|\n" + _ruled(ROWS),
        '"t" "x"\n' + "\n".join(f'"{k}" {row.replace(",", " ")}' for k, row in enumerate(ROWS, 1)),
        "# a remark\nt,x,run\n" + "\n".join(f"{row},run #{k}" for k, row in enumerate(ROWS)),
    ],
    ids=["crcrlf", "cr in a title", "cr in a header", "cr", "dos", "remark", "remarks", "footer", "bars", "R", "hash"],
)
def test_every_row_comes_out(tmp_path, text):
    table = _table(tmp_path, text)
    named = [k for k, name in enumerate(table.names) if name.startswith("x")]
    assert table.values(named[0]).tolist() == WAVE.tolist()


@pytest.mark.parametrize("empty", ["", ",", " , "])
def test_empty_rows_among_values_are_said(tmp_path, empty):
    table = _table(tmp_path, "t,x\n" + "\n".join([*ROWS[:20], empty, *ROWS[21:]]))
    assert _wave(table) == [*WAVE[:20], *WAVE[21:]]
    assert "1 empty row(s) among its values, the first in line 22, are left out" in " ".join(table.notes)
    doubled = _table(tmp_path, "t,x\n" + "\n\n".join(ROWS) + "\n\n")
    assert not doubled.notes


def test_empty_rows_of_a_sheet_are_said(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for k, row in enumerate([("t", "x"), *zip(TIME.tolist(), WAVE.tolist(), strict=True)]):
        book.active.append((None, None) if k == 30 else row)
    book.save(tmp_path / "a.xlsx")
    assert "1 empty row(s) among its values, the first in line 31" in " ".join(read_table(tmp_path / "a.xlsx").notes)


def test_a_quotation_mark_that_is_not_closed_does_not_swallow_rows(tmp_path):
    rows = [f"{row}," for row in ROWS]
    rows[20] += '"bump at 5'
    rows[30] += 'ok"'
    with pytest.raises(InputError, match=r"a cell of row 20 goes on over 10 lines, up to line 32"):
        _table(tmp_path, "t,x,remark\n" + "\n".join(rows))
    said = [f"{row}," for row in ROWS]
    said[20] += '"a bump\nat 5 s, no more"'
    assert _wave(_table(tmp_path, "t,x,remark\n" + "\n".join(said))) == WAVE.tolist()


def _load(folder, channels: dict, **files: str):
    for name, text in files.items():
        (folder / f"{name}.csv").write_text(text)
    record = {"name": "a", "file": "a.csv", "channels": channels}
    content = {"system": "oscillator", "records": [record]}
    (folder / "measurement.yaml").write_text(yaml.safe_dump(content))
    return load_measurement(folder / "measurement.yaml").records[0]


@pytest.mark.parametrize(
    ("said", "gain"), [("0.1 mm", 10), ("1/100 mm", 100), ("10^-3 mm", 1000), ("10 mm", 0.1), ("1e-3 mm", 1000)]
)
def test_a_header_that_counts_in_steps_contradicts_the_unit(tmp_path, said, gain):
    channels = {"sampling_rate": {"value": RATE, "unit": "Hz"}, "displacement": {"column": 1, "unit": "mm"}}
    text = f"t,x [{said}]\n" + "\n".join(ROWS)
    (found,) = [one for one in _load(tmp_path, channels, a=text).findings if one.kind == "unit_conflict"]
    assert f"write gain: {gain:g}, by which values are divided" in found.message
    channels["displacement"]["gain"] = gain
    mended = _load(tmp_path, channels, a=text)
    assert not [one for one in mended.findings if one.kind == "unit_conflict"]
    np.testing.assert_allclose(mended.channels["displacement"].values, WAVE / gain, rtol=1e-12)


def test_stamps_that_count_steps_are_read_so_and_not_against_the_unit(tmp_path):
    channels = {"time": {"column": 0}, "displacement": {"column": 1, "unit": "mm"}}
    text = "t [10 ms],x\n" + "\n".join(f"{k / 2},{x}" for k, x in enumerate(WAVE))
    assert _load(tmp_path, channels, a=text).sampling_rate == pytest.approx(RATE)
    channels["time"]["unit"] = "ms"
    with pytest.raises(InputError, match="says '10 ms'"):
        _load(tmp_path, channels, a=text)


def test_what_a_name_is_over_is_no_unit(tmp_path):
    text = "t,x(t)\n" + "\n".join(ROWS)
    channels = {"sampling_rate": {"value": RATE, "unit": "Hz"}, "displacement": {"column": "x(t)", "unit": "mm"}}
    assert not [one for one in _load(tmp_path, channels, a=text).findings if one.kind == "unit_conflict"]
    del channels["displacement"]["unit"]
    with pytest.raises(InputError, match=r"displacement\.unit: is missing"):
        _load(tmp_path, channels, a=text)


def test_counts_without_their_sign_are_a_problem_and_a_switch_is_none(tmp_path):
    counts = np.round(1000 * WAVE).astype(int)
    channels = {"sampling_rate": {"value": RATE, "unit": "Hz"}}
    channels["displacement"] = {"column": "x", "unit": "mm", "gain": 1000}

    def kinds(values):
        text = "t,x\n" + "\n".join(f"{t},{x}" for t, x in zip(TIME, values, strict=True))
        return [one.kind for one in _load(tmp_path, channels, a=text).findings if one.severity == "data_problem"]

    assert "run_over" in kinds(counts % 65536)
    assert "run_over" not in kinds(counts)
    assert "run_over" not in kinds(np.where(counts > 0, 65535, 0))
    for size in (1000, 1024, 3600, 16384):  # a counter of one turn, which the motion passes either way
        beginning_again = np.round(0.15 * size * WAVE).astype(int) % size
        assert "run_over" in kinds(beginning_again), size
    assert "run_over" not in kinds(np.arange(len(WAVE)) * 37 % 1000)  # a sawtooth of a generator


def test_a_channel_with_a_rate_alone_begins_with_the_first_row(tmp_path):
    text = "t,x,u\n" + "\n".join(f"{t - 0.1:.4f},{x},{x}" for t, x in zip(TIME, WAVE, strict=True))
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "mm"}}
    channels["force"] = {"column": "u", "unit": "N", "sampling_rate": {"value": RATE, "unit": "Hz"}}
    record = _load(tmp_path, channels, a=text)
    np.testing.assert_allclose(record.channels["force"].values, WAVE, atol=1e-9)


def test_waveforms_that_begin_at_other_times_stand_as_much_apart(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    begun = np.datetime64("2026-01-05T08:00:00")
    late = {"one": begun + np.timedelta64(1500, "ms"), "two": begun}
    with nptdms.TdmsWriter(str(tmp_path / "a.tdms")) as writer:
        writer.write_segment([
            nptdms.ChannelObject("g", name, WAVE, {"wf_increment": 1 / RATE, "wf_start_time": start})
            for name, start in late.items()
        ])  # fmt: skip
    table = read_table(tmp_path / "a.tdms")
    assert [table.clock(table.index(f"g/{name}", "")) for name in late] == [(1.5, RATE), (0.0, RATE)]


@pytest.mark.parametrize(
    "attributes",
    [
        {"sample_interval": 5, "sample_interval_unit": "ms"},
        {"dt": 5, "time_unit": b"ms"},
        {"sample_interval_us": 5000},
        {"fs": 0.2, "fs_unit": "kHz"},
        {"dt_us": 5000},
        {"dt_ms": 5.0},
        {"fs_kHz": 0.2},
        {"sample_rate_hz": 200},
    ],
)
def test_a_rate_is_read_in_the_unit_beside_it(tmp_path, attributes):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["x"] = WAVE
        file["x"].attrs.update(attributes)
    assert read_table(tmp_path / "a.h5").clock(0) == (0.0, pytest.approx(RATE))


def test_numbers_of_a_yaml_are_decimal(tmp_path):
    (tmp_path / "a.yaml").write_text("a: 010\nb: 1:30\nc: 1e-3\nd: -7\ne: 1_000\nf: 08\n")
    found = {"a": 10, "b": "1:30", "c": 1e-3, "d": -7, "e": 1000, "f": 8}
    assert read_yaml(tmp_path / "a.yaml") == found


def test_range_and_gain_of_a_wav_file_do_not_both_scale_it(tmp_path):
    from scipy.io import wavfile

    wavfile.write(tmp_path / "a.wav", int(RATE), np.round(3000 * WAVE).astype(np.int16))
    channel = {"column": 0, "unit": "mm", "range": {"value": 100, "unit": "mm"}, "gain": 0.1}
    record = {"file": "a.wav", "channels": {"displacement": channel}}
    (tmp_path / "m.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": [record]}))
    with pytest.raises(InputError, match=r"gain = 0\.1: stands beside range.*leave one of the two out"):
        load_measurement(tmp_path / "m.yaml")


def test_a_name_is_found_without_its_unit_and_its_run(tmp_path):
    header = '"Time (s) Run #14","Angle, Ch P1 (rad) Run #14","Angle, Ch P2 (rad) Run #14"'
    table = _table(tmp_path, header + "\n" + "\n".join(f"{row},0.5" for row in ROWS))
    assert table.index("Angle, Ch P1", "") == 1
    with pytest.raises(InputError, match=r"did you mean 'Angle, Ch P1 \(rad\) Run #14'\?"):
        table.index("Angle, Ch P1 (r", "")


def _sheet(folder, rows, formats=()):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in rows:
        book.active.append(row)
    for column, shown in formats:
        for cell in book.active[column][1:]:
            cell.number_format = shown
    book.save(folder / "a.xlsx")
    return read_table(folder / "a.xlsx")


@pytest.mark.parametrize("blank", [(0,), (1,), (2,), (0, 2)])
def test_a_blank_column_of_a_sheet_moves_no_name(tmp_path, blank):
    rows = [["t", "x", "F"], *([t, x, -x] for t, x in zip(TIME.tolist(), WAVE.tolist(), strict=True))]
    for row in rows:
        for k in blank:
            row.insert(k, None)
    table = _sheet(tmp_path, rows)
    assert table.names == ("t", "x", "F")
    assert _wave(table) == WAVE.tolist()
    assert table.values(2).tolist() == (-WAVE).tolist()


def test_cells_in_per_cent_are_read_as_they_are_shown(tmp_path):
    table = _sheet(tmp_path, [["t", "x"], *([t, x / 100] for t, x in zip(TIME, WAVE, strict=True))], [("B", "0.00%")])
    assert _wave(table) == pytest.approx(WAVE.tolist())


def test_texts_with_a_decimal_comma_among_numbers_of_a_sheet(tmp_path):
    cells = [f"{x:.3f}".replace(".", ",") if k % 7 == 3 else x for k, x in enumerate(WAVE.tolist())]
    table = _sheet(tmp_path, [["t", "x"], *([t, x] for t, x in zip(TIME, cells, strict=True))])
    assert _wave(table) == pytest.approx(WAVE.tolist(), abs=6e-4)
    assert "texts with a comma among the numbers of 'x' are read as numbers, the first" in " ".join(table.notes)


def test_thousands_within_the_numbers_of_a_sheet_stay_thousands(tmp_path):
    cells = [1000.0 * k for k in range(60)]
    table = _sheet(
        tmp_path,
        [["t", "x"], *([t, "7,000" if k == 7 else x] for k, (t, x) in enumerate(zip(TIME, cells, strict=True)))],
    )
    assert _wave(table) == cells


@pytest.mark.parametrize("header", ["x [mm*10]", "x [mm/10]", "x [mm]*1000", "1000*x [mm]", "x (mm·10⁻³)", "x/mm*10"])
def test_a_factor_behind_a_unit_is_asked_for(tmp_path, header):
    (tmp_path / "a.csv").write_text(f"t,{header}\n" + "\n".join(ROWS))
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": 1, "unit": "mm"}}
    for gain, said in ((None, ["unit_conflict"]), (10, []), (1, [])):
        channels["displacement"] |= {} if gain is None else {"gain": gain}
        record = {"file": "a.csv", "channels": channels}
        (tmp_path / "m.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": [record]}))
        assert [one.kind for one in load_measurement(tmp_path / "m.yaml").records[0].findings] == said


def test_comments_below_units_are_no_names(tmp_path):
    table = _table(tmp_path, "A(X)\tB(Y)\nTime\tx\ns\tmm\nrun 1\tlaser\n" + "\n".join(ROWS).replace(",", "\t"))
    assert (table.names, table.unit(1), _wave(table)) == (("Time", "x"), "mm", WAVE.tolist())


def test_minutes_of_a_clock_go_on_past_the_hour(tmp_path):
    table = _table(tmp_path, "t,x\n" + "\n".join(f"{(59 + k // 60) % 60:02d}:{k % 60:02d}.0,{k}" for k in range(120)))
    assert table.values(0).tolist() == [float(k) for k in range(120)]


def test_several_variables_of_octave_have_their_names(tmp_path):
    text = "# Created by Octave 8.4.0, Fri Mar 01 12:00:00 2024 UTC <a@b>\n"
    for name, values in (("t", TIME), ("x", WAVE)):
        text += f"# name: {name}\n# type: matrix\n# rows: 60\n# columns: 1\n"
        text += "".join(f" {value:.6f}\n" for value in values) + "\n\n"
    table = _table(tmp_path, text, "a.txt")
    assert table.names == ("t", "x")
    assert _wave(table) == WAVE.tolist()


def test_a_table_of_signals_by_turns_is_refused(tmp_path):
    rows = [f"{t:.4f},{'mm' if k % 2 else 'N'},{x:.4f}" for k, (t, x) in enumerate(zip(TIME, WAVE, strict=True))]
    with pytest.raises(InputError, match=r"its rows hold N, mm by turns, as column 'Unit' says"):
        _table(tmp_path, "t,Unit,x\n" + "\n".join(rows))
    alike = _table(tmp_path, "t,Unit,x\n" + "\n".join(row.replace(",N,", ",mm,") for row in rows))
    assert _wave(alike) == WAVE.tolist()


@pytest.mark.parametrize(
    ("numbers", "lost"),
    [
        (range(60), None),
        ([*range(20), *range(25, 65)], "leaves 5 number(s) out, the first behind row 19"),
        ([(k + 230) % 256 for k in range(60)], None),
        ([(k + 230 + 7 * (k > 40)) % 256 for k in range(60)], "leaves 7 number(s) out, the first behind row 40"),
        ([3 * k for k in range(60)], None),
    ],
    ids=["whole", "lost", "a register", "lost in a register", "another count"],
)
def test_numbers_that_a_counter_leaves_out_are_lost_samples(tmp_path, numbers, lost):
    (tmp_path / "a.csv").write_text("Sample,x\n" + "\n".join(f"{n},{x}" for n, x in zip(numbers, WAVE, strict=True)))
    channels = {"sampling_rate": f"{RATE} Hz", "displacement": {"column": "x", "unit": "mm"}}
    record = {"file": "a.csv", "channels": channels}
    (tmp_path / "m.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": [record]}))
    found = [one for one in load_measurement(tmp_path / "m.yaml").records[0].findings if one.kind == "lost_numbers"]
    assert [one.severity for one in found] == ["data_problem"] * bool(lost)
    assert all(lost in one.message for one in found)


def octave(*variables):
    """A file of variables, each as (name, type, lines of what is said of it, values)."""
    text = "# Created by Octave 8.4.0, Fri Mar 01 12:00:00 2024 UTC <a@b>\n"
    for name, kind, said, values in variables:
        text += f"# name: {name}\n# type: {kind}\n" + "".join(f"# {one}\n" for one in said)
        text += "".join(f" {value}\n" for value in values) + "\n\n"
    return text


@pytest.mark.parametrize("ending", ["a.txt", "a.mat"])
def test_numbers_ranges_and_texts_stand_beside_matrices_of_octave(tmp_path, ending):
    """A single number is no column, wherever it stands."""
    table = _table(
        tmp_path,
        octave(
            ("fs", "scalar", (), [200]),
            ("t", "range", ("base, limit, increment",), ["0 0.295 0.005"]),
            ("x", "matrix", ("rows: 60", "columns: 1"), [f"{value:.6f}" for value in WAVE]),
            ("note", "string", ("elements: 1", "length: 5"), ["rig 5"]),
        ),
        ending,
    )
    assert table.names == ("t", "x", "fs")
    assert table.values(0) == pytest.approx([0.005 * k for k in range(60)])
    assert _wave(table) == WAVE.tolist()


def test_one_variable_of_octave_is_read_whatever_the_ending(tmp_path):
    said = ("rows: 60", "columns: 1")
    table = _table(tmp_path, octave(("x", "matrix", said, [f"{value:.6f}" for value in WAVE])), "a.mat")
    assert _wave(table) == WAVE.tolist()


@pytest.mark.parametrize("ends", ["0 1e12 1e-3", "0 1 0", "0 nan 1", "0 1"])
def test_a_range_that_is_none_of_a_record_fills_no_memory(tmp_path, ends):
    text = octave(("t", "range", ("base, limit, increment",), [ends]), ("fs", "scalar", (), [200]))
    with pytest.raises(InputError):
        _table(tmp_path, text, "a.mat")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x =\n\n   1.0e+03 *\n\n" + "\n".join(f"   {value:.4f}" for value in WAVE), r"stand below '1\.0e\+03 \*'"),
        ("\n".join(f"  [{4 * k + 1}]  0.1  0.2  0.3  0.4" for k in range(20)), "4 values a line"),
    ],
    ids=["a factor of MATLAB", "a vector of R"],
)
def test_what_would_be_read_as_something_else_is_refused(tmp_path, text, said):
    with pytest.raises(InputError, match=said):
        _table(tmp_path, text, "a.txt")


def test_a_second_table_in_another_order_is_refused(tmp_path):
    """To leave its row of names out, as of a cell that is no number, would exchange its columns."""
    rows = [f"{k},{k},1" for k in range(60)] + ["t,F,x"] + [f"{k},1,{k}" for k in range(60, 120)]
    (tmp_path / "a.csv").write_text("t,x,F\n" + "\n".join(rows))
    channels = {name: {"column": name[0], "unit": unit} for name, unit in (("time", "s"), ("x", "mm"))}
    record = {"file": "a.csv", "channels": {"time": channels["time"], "displacement": channels["x"]}}
    (tmp_path / "m.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": [record]}))
    with pytest.raises(InputError, match=r"row 60 .*a row of names among the values.*a file and a record of its own"):
        load_measurement(tmp_path / "m.yaml")


def test_a_vector_of_one_value_a_line_is_read(tmp_path):
    table = _table(tmp_path, "\n".join(f"  [{k + 1}]  {value:.6f}" for k, value in enumerate(WAVE)), "a.txt")
    assert table.values(1).tolist() == WAVE.tolist()


@pytest.mark.parametrize(
    ("number_format", "shown", "unit"),
    [
        ("0.00%", 100, None), ("#,##0.00", 1, None), ("#,##0.00,", 1e-3, None), ("0,.0", 1e-3, None),
        ("#,##0,,", 1e-6, None), ('0.00" mm"', 1, "mm"), ('0.0," kN"', 1e-3, "kN"), ('0.0" a, b"', 1, None),
    ],
)  # fmt: skip
def test_cells_of_a_workbook_count_as_they_are_shown(tmp_path, number_format, shown, unit):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.append(["t", "x"])
    for time, value in zip(TIME, WAVE, strict=True):
        book.active.append([float(time), float(value)])
    for (cell,) in book.active.iter_rows(min_row=2, min_col=2, max_col=2):
        cell.number_format = number_format
    book.save(tmp_path / "a.xlsx")
    table = read_table(tmp_path / "a.xlsx")
    assert table.values(1) == pytest.approx(shown * WAVE)
    assert table.unit(1) == unit


BRACKETED = {
    "Mathematica": "{"
    + ",\n ".join(f"{{{t:.4f}*^0, {10 * x:.4f}*^-1}}" for t, x in zip(TIME, WAVE, strict=True))
    + "}\n",
    "in one line": "{" + ", ".join(f"{{{t:.4f}, {x:.4f}}}" for t, x in zip(TIME, WAVE, strict=True)) + "}",
    "NumPy": "[" + "\n ".join(f"[{t:.4f} {x:.4f}]" for t, x in zip(TIME, WAVE, strict=True)) + "]",
    "its array": "array([" + ",\n       ".join(f"[{t:.4f}, {x:.4f}]" for t, x in zip(TIME, WAVE, strict=True)) + "])",
    "a tensor": "tensor(["
    + ",\n".join(f"[{t:.4f}, {x:.4f}]" for t, x in zip(TIME, WAVE, strict=True))
    + "], dtype=float)",
    "a list": "data = [" + ", ".join(f"[{t:.4f}, {x:.4f}]" for t, x in zip(TIME, WAVE, strict=True)) + "]\n",
    "powers alone": "\n".join(f"{t:.4f}*^0\t{10 * x:.4f}*^-1" for t, x in zip(TIME, WAVE, strict=True)),
}


@pytest.mark.parametrize("name", BRACKETED)
def test_rows_in_brackets_are_read(tmp_path, name):
    table = _table(tmp_path, BRACKETED[name], "a.txt")
    assert table.values(0) == pytest.approx(TIME, abs=1e-12)
    assert table.values(1) == pytest.approx(WAVE, abs=1e-9)


def test_a_table_over_orders_is_no_record_and_turns_are_no_time(tmp_path):
    rows = "\n".join(f"{k / 8:.3f},{k % 7}" for k in range(200))
    with pytest.raises(InputError, match=r"goes over frequency .column 'Order'.*remedy: export the time records"):
        inspect_table(_table(tmp_path, "Order,TE (um)\n" + rows))
    assert inspect_table(_table(tmp_path, "rev,TE (um)\n" + rows, "b.csv")).time is None


def test_a_table_over_frequency_is_no_record(tmp_path):
    rows = "\n".join(f"{k / 4:.3f},{k % 7},{k % 5}" for k in range(200))
    with pytest.raises(
        InputError, match=r"goes over frequency .column 'Frequency .Hz.'.*remedy: export the time records"
    ):
        inspect_table(_table(tmp_path, "Frequency (Hz),Real (g/N),Imag (g/N)\n" + rows))
    timed = "\n".join(f"{k / 200:.3f},{k / 4:.3f},{k % 7}" for k in range(200))
    assert inspect_table(_table(tmp_path, "Time (s),Frequency (Hz),x (mm)\n" + timed, "b.csv")).rate == pytest.approx(
        200
    )


def test_a_swing_at_the_pace_at_which_an_angle_is_looked_at_does_not_turn(tmp_path):
    """Every 48th sample of 2400 falls on the same phase, and the decay alone is seen there."""
    time = np.arange(2400) / 40
    swing = 12 * np.exp(-0.03 * time) * np.cos(2 * np.pi * time / 1.2)
    rows = "\n".join(f"{t:.3f},{x:.4f}" for t, x in zip(time, swing, strict=True))
    found = inspect_table(_table(tmp_path, "t,angle_deg\n" + rows))
    assert [column.kind for column in found.columns] == [TIME_STAMPS, SIGNAL]


@pytest.mark.parametrize("header", ["t/s,x/mm", "t/s,x/(mm)", "t/s,x/(m/s²)"])
def test_a_name_is_found_without_the_unit_behind_its_stroke(tmp_path, header):
    table = _table(tmp_path, header + "\n" + "\n".join(ROWS))
    assert table.index("x", "") == 1
    assert table.index("t", "") == 0
