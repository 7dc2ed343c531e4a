"""Files that the other side of each library wrote: HDF5, MAT with structures and 7.3, UFF 58, TDMS, xlsx, gzip."""

import gzip
from datetime import datetime, timedelta

import h5py
import numpy as np
import openpyxl
import pytest
import pyuff
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter
from scipy.io import savemat
from scipy.sparse import csc_matrix

from gear_damping.errors import InputError
from gear_damping.measurement.formats import table as table_module
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.formats.uff_file import rounded_rate
from gear_damping.units import parse_unit

TIME = np.arange(60) / 1000
WAVE = np.sin(2 * np.pi * 20 * TIME)
MATRIX = np.column_stack([WAVE, 2 * WAVE, 3 * WAVE])


def _values(table, name):
    return table.values(table.index(name, "column"))


def _shapes(table):
    return dict(table.shapes)


# HDF5


@pytest.fixture
def hdf5(tmp_path):
    path = tmp_path / "run.h5"
    with h5py.File(path, "w") as file:
        file["t"] = TIME
        file["t"].attrs["units"] = "s"
        rig = file.create_group("rig 1/daq")
        rig["wave"] = WAVE.astype(np.float32)
        rig["wave"].attrs["unit"] = np.bytes_("m/s^2")
        rig.create_dataset("all", data=MATRIX.T, compression="gzip", chunks=True)
        pairs = np.zeros(60, dtype=[("y", "<f8"), ("label", "S4"), ("xyz", "<f4", (3,))])
        pairs["y"], pairs["xyz"] = WAVE, MATRIX
        file["table"] = pairs
        file["note"] = "a text"
        file["none"] = np.zeros((0, 3))
        file["spectrum"] = WAVE + 1j
    return path


def test_hdf5_datasets_are_columns_under_their_paths(hdf5):
    table = read_table(hdf5)
    assert _shapes(table) == {
        "t": (60,), "rig 1/daq/wave": (60,), "rig 1/daq/all": (3, 60), "table.y": (60,), "table.xyz": (60, 3),
    }  # fmt: skip
    for name in ("rig 1/daq/wave", "/rig 1/daq/wave"):
        np.testing.assert_allclose(_values(table, name), WAVE, atol=1e-7)
    assert _values(table, "rig 1/daq/wave").dtype == np.float64
    np.testing.assert_array_equal(_values(table, "/rig 1/daq/all[2]"), MATRIX[:, 2])
    np.testing.assert_array_equal(_values(table, "table.y"), WAVE)
    np.testing.assert_allclose(_values(table, "table.xyz[1]"), MATRIX[:, 1], atol=1e-6)
    assert [table.unit(table.index(name, "")) for name in ("t", "rig 1/daq/wave", "table.y")] == ["s", "m/s^2", None]


@pytest.mark.parametrize(("said", "unit"), [("milliseconds since 2024-01-01", "ms"), ("seconds since 1970-1-1", "s")])
def test_a_unit_of_time_since_a_date_is_that_unit(tmp_path, said, unit):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"] = np.arange(30.0)
        file["t"].attrs["units"] = said
    assert parse_unit(read_table(tmp_path / "a.h5").unit(0)) == parse_unit(unit)


def test_a_message_about_a_column_says_what_the_file_holds_with_shapes(hdf5):
    table = read_table(hdf5)
    with pytest.raises(InputError, match=r"run.h5 holds .*all \(3 x 60\), .*t \(60\), table.y"):
        table.index("nothing of the kind", "column")
    with pytest.raises(InputError, match=r"no real numbers: none \(empty\), note \(text\), spectrum \(complex\)"):
        table.index("spectrum", "column")
    for wrong in ("rig 1/daq/all", "/rig 1/daq/all[3]"):
        with pytest.raises(InputError, match=r"is 3 x 60, .* write one of rig 1/daq/all\[0\] to rig 1/daq/all\[2\]"):
            table.index(wrong, "column")


def test_hdf5_without_real_numbers_says_what_it_holds(tmp_path):
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["note"] = "text"
    with pytest.raises(InputError, match=r"holds no array of real numbers, only note"):
        read_table(tmp_path / "a.hdf5")


def test_hdf5_that_unpacks_to_too_much_is_refused_unread(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("x", data=np.zeros(100_000), compression="gzip")
    with pytest.raises(InputError, match="1 MB are more than"):
        read_table(tmp_path / "a.h5", max_bytes=20_000)


def test_a_damaged_part_of_hdf5_is_said_when_it_is_asked_for(hdf5):
    with h5py.File(hdf5, "r") as file:
        begin = file["rig 1/daq/all"].id.get_chunk_info(0).byte_offset
    content = bytearray(hdf5.read_bytes())
    content[begin : begin + 40] = bytes(40)
    hdf5.write_bytes(content)
    table = read_table(hdf5)
    np.testing.assert_array_equal(_values(table, "t"), TIME)
    with pytest.raises(InputError, match=r"'rig 1/daq/all' cannot be read"):
        _values(table, "rig 1/daq/all[0]")


# MAT


def test_mat_structures_cells_and_matrices_are_reachable(tmp_path):
    cells = np.empty(3, object)
    cells[:] = [WAVE, MATRIX, "text"]
    runs = np.zeros(2, dtype=[("y", "O"), ("fs", "O")])
    runs[0], runs[1] = (WAVE, 1000.0), (2 * WAVE, 500.0)
    run = {"y": MATRIX, "fs": 1000.0, "name": "rig", "in": {"u": WAVE[:, None], "on": WAVE > 0}}
    content = {"t": TIME, "run": run, "c": cells, "runs": runs, "z": WAVE + 1j, "none": np.zeros((0, 0)), "n": "x"}
    savemat(tmp_path / "a.mat", {**content, "i": np.int16([1, 2, 3]), "s": csc_matrix(np.eye(4))})
    table = read_table(tmp_path / "a.mat")
    shapes = _shapes(table)
    assert shapes["run.y"] == (60, 3)
    np.testing.assert_array_equal(_values(table, "run.y[2]"), MATRIX[:, 2])
    np.testing.assert_array_equal(_values(table, "run.in.u"), WAVE)
    np.testing.assert_array_equal(_values(table, "run.in.on"), WAVE > 0)
    np.testing.assert_array_equal(_values(table, "run.fs"), [1000])
    np.testing.assert_array_equal(_values(table, "c[0]"), WAVE)
    np.testing.assert_array_equal(_values(table, "c[1][1]"), MATRIX[:, 1])
    np.testing.assert_array_equal(_values(table, "runs.y[1]"), 2 * WAVE)
    np.testing.assert_array_equal(_values(table, "runs.fs"), [1000, 500])
    np.testing.assert_array_equal(_values(table, "i"), [1, 2, 3])
    assert sorted(table.left_out) == [
        "c[2] (text)", "n (text)", "none (empty)", "run.name (text)", "s (csc_matrix)", "z (complex)",
    ]  # fmt: skip


def named_elements(names, beside=0):
    """An array of structures as what turns a TDMS file into a MAT file writes it, and more vectors beside its data."""
    fields = ["Name", "Total_Samples", "Data", *["Also"] * bool(beside)]
    made = np.zeros(len(names), dtype=[(field, "O") for field in fields])
    for k, name in enumerate(names):
        data = (k + 1) * WAVE if k else np.zeros((0, 0))
        made[k] = (name, float(data.size), data, *[WAVE] * bool(beside))
    return {"data": {"MeasuredData": made}}


def test_elements_with_a_name_and_one_vector_are_called_by_it(tmp_path):
    savemat(tmp_path / "a.mat", named_elements(["Root", "run1/Position", "run1/Duty"]))
    table = read_table(tmp_path / "a.mat")
    assert table.names == ("data.MeasuredData.Total_Samples", "run1/Position", "run1/Duty")
    for name in ("run1/Position", "Position", "data.MeasuredData.Data[1]", "data.MeasuredData[1].Data"):
        np.testing.assert_array_equal(_values(table, name), 2 * WAVE)
    with pytest.raises(InputError, match="no such column"):
        table.index("", "column")


@pytest.mark.parametrize(
    ("names", "beside"),
    [(["Root", "x", "x"], 0), (["Root", "x", "y"], 1), (["Root", "data.MeasuredData.Data[2]", ""], 0)],
)
def test_elements_whose_names_do_not_tell_them_apart_keep_their_numbers(tmp_path, names, beside):
    savemat(tmp_path / "a.mat", named_elements(names, beside))
    table = read_table(tmp_path / "a.mat")
    assert {"data.MeasuredData.Data[1]", "data.MeasuredData.Data[2]"} <= set(table.names)
    np.testing.assert_array_equal(_values(table, "data.MeasuredData.Data[1]"), 2 * WAVE)


def test_mat_that_unpacks_to_too_much_inside_a_structure_is_refused(tmp_path):
    savemat(tmp_path / "a.mat", {"run": {"y": np.zeros(100_000)}}, do_compression=True)
    assert (tmp_path / "a.mat").stat().st_size < 10_000
    with pytest.raises(InputError, match="MB are more than"):
        read_table(tmp_path / "a.mat", max_bytes=10_000)


@pytest.mark.parametrize("format", ["4", "5"])
def test_old_mat_files_are_read(tmp_path, format):
    savemat(tmp_path / "a.mat", {"x": WAVE, "m": MATRIX}, format=format)
    table = read_table(tmp_path / "a.mat")
    np.testing.assert_array_equal(_values(table, "x"), WAVE)
    np.testing.assert_array_equal(_values(table, "m[1]"), MATRIX[:, 1])


def _matlab(place, name, values, kind="double"):
    """A variable as MATLAB 7.3 stores it: at least two sides, transposed, with its class."""
    values = np.atleast_2d(values)
    place[name] = values if values.dtype == object or values.shape[0] == 1 else values.T
    place[name].attrs["MATLAB_class"] = np.bytes_(kind)
    return place[name]


@pytest.fixture
def mat73(tmp_path):
    path = tmp_path / "run.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        _matlab(file, "t", TIME)
        _matlab(file, "data", MATRIX)
        _matlab(file, "label", np.array([[ord(c) for c in "rig"]], np.uint16).T, "char")
        run = file.create_group("run")
        run.attrs["MATLAB_class"] = np.bytes_("struct")
        _matlab(run, "y", MATRIX[:, :2])
        inner = run.create_group("in")
        inner.attrs["MATLAB_class"] = np.bytes_("struct")
        _matlab(inner, "u", WAVE)
        refs = file.create_group("#refs#")
        targets = [_matlab(refs, "a", WAVE), _matlab(refs, "b", MATRIX)]
        references = np.array([[one.ref for one in targets]], dtype=h5py.ref_dtype)
        file.create_dataset("c", data=references, dtype=h5py.ref_dtype).attrs["MATLAB_class"] = np.bytes_("cell")
        series = _matlab(file, "ts", np.arange(6, dtype=np.uint32), "timeseries")
        series.attrs["MATLAB_object_decode"] = np.int32(3)
        series_in = _matlab(inner, "ts", np.arange(6, dtype=np.uint32), "timeseries")
        series_in.attrs["MATLAB_object_decode"] = np.int32(3)
        system = file.create_group("#subsystem#")
        system.create_dataset("MCOS", data=references, dtype=h5py.ref_dtype).attrs["MATLAB_class"] = np.bytes_("x")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Jan 05 2026 HDF5 schema 1.00 ."
    content = bytearray(path.read_bytes())
    content[:128] = head.ljust(116) + bytes(8) + b"\x00\x02IM"
    path.write_bytes(content)
    return path


def test_mat_7_3_gives_matrices_structures_and_cells(mat73):
    table = read_table(mat73)
    np.testing.assert_array_equal(_values(table, "t"), TIME)
    np.testing.assert_array_equal(_values(table, "data[2]"), MATRIX[:, 2])
    np.testing.assert_array_equal(_values(table, "run.y[1]"), MATRIX[:, 1])
    np.testing.assert_array_equal(_values(table, "run.in.u"), WAVE)
    np.testing.assert_array_equal(_values(table, "c[0]"), WAVE)
    np.testing.assert_array_equal(_values(table, "c[1][0]"), MATRIX[:, 0])
    assert _shapes(table)["data"] == (60, 3)


def test_a_timeseries_object_is_said_with_what_to_do_in_matlab(mat73):
    table = read_table(mat73)
    assert not any(name.endswith("ts") or name.startswith("#") for name in table.names)
    with pytest.raises(InputError, match=r"ts \(MATLAB object; in MATLAB save its arrays, as t = ts.Time"):
        table.index("velocity", "column")


def test_mat_7_3_too_large_or_cut_off_is_one_message(mat73):
    with pytest.raises(InputError, match="MB are more than"):
        read_table(mat73, max_bytes=3000)
    mat73.write_bytes(mat73.read_bytes()[:3000])
    with pytest.raises(InputError, match="not a readable MAT file"):
        read_table(mat73)


# UFF


def _set58(values, rate=10240.0, **changes):
    time = np.arange(len(values)) / rate
    numbers = {"func_type": 1, "rsp_node": 1, "rsp_dir": 1, "ref_node": 1, "ref_dir": 1}
    kinds = {"abscissa_spec_data_type": 17, "ordinate_spec_data_type": 12, "orddenom_spec_data_type": 0}
    described = {"id1": "NONE", "binary": 0, "abscissa_spacing": 1, "data": values, "x": time}
    return pyuff.prepare_58(**{**numbers, **kinds, **described, **changes})


def _write_uff(path, *sets):
    pyuff.UFF(str(path)).write_sets(list(sets), mode="add")
    return path


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # pyuff leaves its file open
@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize("suffix", ["uff", "unv", "UFF58"])
def test_uff_58_gives_the_abscissa_and_the_sets_in_order(tmp_path, binary, suffix):
    first = _set58(WAVE, id1="bearing", ordinate_axis_units_lab="m/s^2", binary=binary, abscissa_axis_units_lab="s")
    second = _set58(-WAVE, binary=binary, abscissa_axis_units_lab="s")
    table = read_table(_write_uff(tmp_path / f"a.{suffix}", first, second))
    assert table.names == ("abscissa", "bearing", "")
    assert [table.unit(k) for k in range(3)] == ["s", "m/s^2", None]
    assert table.sampling_rate == 10240  # the increment in the file says 10240.02
    np.testing.assert_allclose(table.values(0), np.arange(60) / 10240, rtol=1e-15)
    np.testing.assert_allclose(table.values(1), WAVE, atol=1e-11)
    np.testing.assert_allclose(_values(table, 2), -WAVE, atol=1e-11)


@pytest.mark.parametrize("rate", [10240.0, 51200.0, 25600.0, 65536.0, 44100.0, 12800.0, 4096.0, 1706.67, 0.2])
def test_a_rate_is_what_its_written_increment_rounds(rate):
    assert rounded_rate(1 / float(f"{1 / rate:.5e}")) == rate


def test_uff_with_an_uneven_abscissa_keeps_it(tmp_path):
    time = np.array([0.0, 0.1, 0.3, 0.4, 0.9])
    one = _set58(time**2, x=time, abscissa_spacing=0)
    table = read_table(_write_uff(tmp_path / "a.uff", one))
    assert table.sampling_rate is None
    np.testing.assert_allclose(table.values(0), time, rtol=1e-5)
    np.testing.assert_allclose(table.values(1), time**2, atol=1e-10)


def test_complex_uff_sets_are_left_out(tmp_path):
    response = _set58(WAVE + 1j, func_type=4, abscissa_spec_data_type=18, id1="FRF")
    table = read_table(_write_uff(tmp_path / "a.uff", response, _set58(WAVE)))
    assert table.names == ("abscissa", "")
    assert table.left_out == ("FRF (complex or empty)",)


@pytest.mark.parametrize("content", [b"garbage\n" * 20, bytes(range(256)) * 3, b"    -1\n    58\nbroken\n    -1\n"])
def test_uff_without_a_readable_set_is_one_message(tmp_path, content):
    (tmp_path / "a.uff").write_bytes(content)
    with pytest.raises(InputError, match=r"a\.uff'?: (holds no set 58|not a readable UFF file)"):
        read_table(tmp_path / "a.uff")


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("binary", [0, 1])
def test_uff_that_was_cut_off_is_refused_instead_of_losing_a_set(tmp_path, binary):
    path = _write_uff(tmp_path / "a.uff", _set58(WAVE, binary=binary), _set58(np.tile(WAVE, 30), binary=binary))
    whole = path.read_bytes()
    path.write_bytes(whole[:-200])
    with pytest.raises(InputError, match="holds no set 58 or 58b that can be read to its end"):
        read_table(path)
    path.write_bytes(whole[:-3000] + whole[-8:])
    with pytest.raises(InputError, match=r"set 1 holds \d+ of the 1800 values that it announces"):
        read_table(path)


# TDMS


def _channel(group, name, values, **properties):
    return ChannelObject(group, name, values, properties=properties)


@pytest.fixture
def tdms(tmp_path):
    path = tmp_path / "run.tdms"
    start = np.datetime64("2026-01-05T08:00:00")
    wave = {"wf_increment": 1e-3, "wf_start_offset": 0.0, "wf_samples": 60}
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([
            RootObject(properties={"Name": "rig"}),
            GroupObject("Vibration"),
            _channel("Vibration", "DE", WAVE, unit_string="m/s^2", **wave),
            _channel("Vibration", "NDE", (1000 * WAVE).astype(np.int16), **wave),
            _channel("Torque", "T1", 5 + WAVE[:30], unit_string="N*m", **{**wave, "wf_increment": 2e-3}),
            _channel("Log", "when", start + (1e6 * TIME).astype("timedelta64[us]")),
            _channel("Log", "remark", ["on"] * 60),
        ])  # fmt: skip
    return path


def test_tdms_channels_are_group_and_channel_with_unit_and_rate(tdms):
    table = read_table(tdms)
    assert _shapes(table) == {"Vibration/DE": (60,), "Vibration/NDE": (60,), "Torque/T1": (30,), "Log/when": (60,)}
    places = [table.index(name, "") for name in ("Vibration/DE", "Vibration/NDE", "Torque/T1", "Log/when")]
    assert [table.unit(k) for k in places] == ["m/s^2", None, "N*m", "s"]
    assert [table.clock(k) for k in places] == [(0, 1000), (0, 1000), (0, 500), None]
    assert table.sampling_rate is None
    np.testing.assert_array_equal(_values(table, "/Vibration/DE"), WAVE)
    np.testing.assert_array_equal(_values(table, "Vibration/NDE"), np.trunc(1000 * WAVE))
    np.testing.assert_allclose(_values(table, "Log/when"), TIME, atol=1e-6)
    assert table.left_out[0].startswith("Log/remark")


def test_a_tdms_file_that_was_cut_off_says_so(tdms, tmp_path, capsys):
    path = tmp_path / "a.tdms"
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([_channel("g", "x", WAVE), _channel("g", "y", WAVE)])
    path.write_bytes(path.read_bytes()[:-100])
    table = read_table(path)
    np.testing.assert_array_equal(_values(table, "g/x")[:30], WAVE[:30])
    assert any("Last segment of file has less data than expected" in note for note in table.notes)
    tdms.write_bytes(tdms.read_bytes()[:-600])
    with pytest.raises(InputError, match=r"not a readable TDMS file \(Last segment of file has less data"):
        read_table(tdms)
    assert "segment" not in capsys.readouterr().err


@pytest.mark.parametrize("step", [0.0, -1e-3, 5e-324, float("inf"), float("nan"), True, "fast"])
def test_a_tdms_channel_whose_properties_say_nothing_has_neither_unit_nor_rate(step, tmp_path):
    with TdmsWriter(str(tmp_path / "a.tdms")) as writer:
        writer.write_segment([_channel("g", "x", WAVE, unit_string=True, wf_increment=step)])
    table = read_table(tmp_path / "a.tdms")
    place = table.index("g/x", "")
    assert (table.unit(place), table.clock(place)) == (None, None)


def test_a_damaged_tdms_file_is_one_message(tdms, tmp_path):
    content = bytearray(tdms.read_bytes())
    content[28:60] = b"\xff" * 32
    (tmp_path / "b.tdms").write_bytes(content)
    with pytest.raises(InputError, match="not a readable TDMS file"):
        read_table(tmp_path / "b.tdms")
    with pytest.raises(InputError, match="MB are more than"):
        read_table(tdms, max_bytes=1700)


def test_channels_of_two_rates_follow_the_clocks_of_the_file(bench):
    time = np.arange(400) / 20000
    torque = 150 + np.sin(40 * np.arange(200) / 10000)
    with TdmsWriter(str(bench.folder / "run.tdms")) as writer:
        writer.write_segment([
            _channel("fast", "dte", bench.columns["dte"], unit_string="um", wf_increment=5e-5),
            _channel("fast", "theta", bench.columns["theta1"], unit_string="rad", wf_increment=5e-5),
            _channel("slow", "T1", torque, unit_string="N*m", wf_increment=1e-4),
        ])  # fmt: skip
    bench.record["file"] = "run.tdms"
    del bench.channels["time"]
    paths = {"transmission_error": "fast/dte", "pinion_torque": "slow/T1", "pinion_angle": "fast/theta"}
    bench.channels.update({name: {"column": path} for name, path in paths.items()})
    bench.record["slice"] = [20, 380]
    record = bench.load_as_it_is().records[0]
    assert record.sampling_rate == 20000
    np.testing.assert_allclose(record.time, time[20:380])
    np.testing.assert_allclose(record.channels["pinion_torque"].values, 150 + np.sin(40 * record.time), atol=1e-9)


# xlsx


def _workbook(path, **sheets):
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def test_xlsx_columns_are_found_by_their_header(tmp_path):
    rows = [[time, 1000 * wave] for time, wave in zip(TIME.tolist(), WAVE.tolist(), strict=True)]
    rows[40:] = [[time, None] for time, _ in rows[40:]]  # a column that ends before the other
    titled = [["Rig 3, second run"], [], ["t [s]", "Acc (mm/s^2)"], *rows]
    table = read_table(_workbook(tmp_path / "a.xlsx", Data=titled, Empty=[]))
    assert table.names == ("t [s]", "Acc (mm/s^2)")
    assert [table.unit(k) for k in range(2)] == ["s", "mm/s^2"]
    assert table.lengths == (60, 40)
    np.testing.assert_allclose(table.values(1), 1000 * WAVE[:40], rtol=1e-15)


def test_xlsx_sheets_rows_of_units_and_times(tmp_path):
    begin = datetime(2026, 1, 5, 8)
    moments = [[begin + timedelta(milliseconds=k), float(k)] for k in range(10)]
    path = _workbook(tmp_path / "a.xlsx", A=[["when", "x"], ["-", "um"], *moments], B=[["x"], [1], [2]])
    table = read_table(path)
    assert table.names == ("A/when", "A/x", "B/x")
    assert [table.unit(k) for k in range(3)] == ["s", "um", None]
    np.testing.assert_allclose(_values(table, "A/when"), np.arange(10) / 1000, atol=1e-6)
    np.testing.assert_array_equal(_values(table, "B/x"), [1, 2])


@pytest.mark.parametrize(("blank", "said"), [(0, "A"), (2, "C"), (None, None)])
def test_empty_columns_of_xlsx_that_numbers_leave_out_are_said(tmp_path, blank, said):
    rows = [["t", "x", "F"], *([k / 10, np.cos(k), 3.0 * k] for k in range(20))]
    apart = rows if blank is None else [[*row[:blank], None, *row[blank:]] for row in rows]
    table = read_table(_workbook(tmp_path / "a.xlsx", S=apart))
    notes = [note for note in table.notes if "are empty, and numbers of columns do not count them" in note]
    assert notes == (
        [] if said is None else [f"a.xlsx, S: columns {said} are empty, and numbers of columns do not count them"]
    )


def test_formulas_of_xlsx_without_stored_values_are_said(tmp_path):
    rows = [["t", "x"], *([k, f"=A{k + 2}*2"] for k in range(9))]
    table = read_table(_workbook(tmp_path / "a.xlsx", S=rows))
    assert table.names == ("t",)
    with pytest.raises(InputError, match=r"holds t \(9\); no real numbers: x \(no values; if they are formulas, open"):
        table.index("x", "column")


def test_a_cell_of_xlsx_that_is_no_number_is_named_with_its_row(tmp_path):
    table = read_table(_workbook(tmp_path / "a.xlsx", S=[["t", "x"], [0, 1], [1, "n/a"], [2, None], [3, 4]]))
    np.testing.assert_array_equal(table.values(0), [0, 1, 2, 3])
    assert np.isnan(table.values(1)).tolist() == [False, True, True, False]
    first, second = map(str, table.bad_cells(1, 0, 4))
    assert "row 1 (line 3), column 1 'x' = 'n/a': not a number" in first
    assert "row 2 (line 4), column 1 'x' = '': an empty cell" in second
    assert table.bad_cells(1, 3, 4) == []


def test_xlsx_without_rows_or_too_large_is_refused(tmp_path):
    with pytest.raises(InputError, match="no rows"):
        read_table(_workbook(tmp_path / "a.xlsx", S=[["t", "x"]]))
    path = _workbook(tmp_path / "b.xlsx", S=[[k, k] for k in range(3000)])
    with pytest.raises(InputError, match="MB are more than"):
        read_table(path, max_bytes=path.stat().st_size + 1000)


# text


@pytest.mark.parametrize("name", ["a.gz", "a.csv.gz", "a.TXT.GZ"])
def test_text_in_gzip_is_read(tmp_path, name):
    (tmp_path / name).write_bytes(gzip.compress(b"t (s);x\n0;1,5\n1;-2\n"))
    table = read_table(tmp_path / name)
    assert table.names == ("t (s)", "x")
    assert table.values(1).tolist() == [1.5, -2]


def test_gzip_that_unpacks_to_too_much_or_is_cut_off_is_refused(tmp_path):
    packed = gzip.compress(b"0,1\n" * 100_000)
    (tmp_path / "a.gz").write_bytes(packed)
    with pytest.raises(InputError, match="MB are more than"):
        read_table(tmp_path / "a.gz", max_bytes=10_000)
    (tmp_path / "a.gz").write_bytes(packed[:-40])
    with pytest.raises(InputError, match="not a readable gzip file"):
        read_table(tmp_path / "a.gz")


def test_titles_before_a_header_and_a_row_of_units_are_understood(tmp_path):
    (tmp_path / "a.txt").write_text("Logger 7\nRate: 1000\n\nt;x;T1\ns;um;N*m\n0;1,5;2\n1;2,5;3\n")
    table = read_table(tmp_path / "a.txt")
    assert table.names == ("t", "x", "T1")
    assert [table.unit(k) for k in range(3)] == ["s", "um", "N*m"]
    assert table.values(1).tolist() == [1.5, 2.5]
    assert table.notes[0] == "a.txt: 2 line(s) before the header are left out"


def test_faults_are_named_by_their_line_below_titles_comments_and_blank_lines(tmp_path):
    text = "Logger 7\n\nt,x\n0,1\n\n# paused\n1,oops\n,,\n2,3\n"
    (tmp_path / "a.csv").write_text(text)
    table = read_table(tmp_path / "a.csv")
    assert table.values(0).tolist() == [0, 1, 2]
    assert np.isfinite(table.values(1)).tolist() == [True, False, True]
    assert "row 1 (line 7), column 1 'x' = 'oops'" in str(table.bad_cells(1, 0, 3)[0])
    assert not table.bad_cells(1, 2, 3)
    (tmp_path / "a.csv").write_text(text.replace("2,3", "2,3,4"))
    with pytest.raises(InputError, match=r"row 2 .line 9.: 3 cells where the first line has 2"):
        read_table(tmp_path / "a.csv")


def test_text_is_read_to_the_last_digit(tmp_path):
    values = np.random.default_rng(0).normal(size=2000) * 10.0 ** np.random.default_rng(1).integers(-9, 9, 2000)
    (tmp_path / "a.csv").write_text("x,on\n" + "\n".join(f"{value!r},True" for value in values.tolist()))
    table = read_table(tmp_path / "a.csv")
    np.testing.assert_array_equal(table.values(0), values)
    assert table.values(1).sum() == 2000


# what is missing


@pytest.mark.parametrize(
    ("suffix", "library"),
    [("h5", "h5py"), ("uff", "pyuff"), ("tdms", "nptdms"), ("xlsx", "openpyxl"), ("mat", "pymatreader")],
)
def test_a_library_is_said_to_be_missing_only_where_its_import_fails(tmp_path, monkeypatch, suffix, library, mat73):
    path = tmp_path / f"a.{suffix}"
    path.write_bytes(mat73.read_bytes())

    def missing(name):
        if name == library:
            raise ImportError(f"No module named '{name}'")
        return __import__(name)

    monkeypatch.setattr(table_module, "import_module", missing)
    with pytest.raises(InputError, match=rf"needs the library '{library}'.*pip install 'gear-damping\[formats\]'"):
        read_table(path)
    np.savez(tmp_path / "b.npz", x=WAVE)
    assert read_table(tmp_path / "b.npz").names == ("x",)


def test_one_array_of_numpy_is_its_columns_and_a_structured_one_its_fields(tmp_path):
    np.save(tmp_path / "a.npy", np.column_stack([np.arange(9.0), np.arange(9.0) ** 2]))
    assert read_table(tmp_path / "a.npy").values(1).tolist() == [k * k for k in range(9)]
    np.save(tmp_path / "b.npy", np.array([(1.0, 2), (3.0, 4)], dtype=[("t", float), ("x", int)]))
    table = read_table(tmp_path / "b.npy")
    assert (table.names, table.values(1).tolist()) == (("t", "x"), [2, 4])
    np.save(tmp_path / "c.npy", np.array([{}], dtype=object), allow_pickle=True)
    with pytest.raises(InputError, match="not a readable NPY file"):
        read_table(tmp_path / "c.npy")


def test_columns_are_found_by_what_people_call_them(tmp_path):
    from scipy.io import savemat

    runs = np.array([(np.arange(9.0),), (np.arange(8.0),)], dtype=[("t", object)])
    savemat(tmp_path / "a.mat", {"runs": runs})
    table = read_table(tmp_path / "a.mat")
    assert table.index("runs[1].t", "column") == table.index("runs.t[1]", "column")
    np.save(tmp_path / "a.npy", np.zeros((9, 2)))
    assert read_table(tmp_path / "a.npy").index("1", "column") == 1
    (tmp_path / "a.csv").write_text("Weg [mm],Weg (2)\n1,2\n")
    assert read_table(tmp_path / "a.csv").index("Weg", "column") == 0
