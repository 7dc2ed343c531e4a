"""Files that h5py and MATLAB wrote: HDF5, MAT with structures, and MAT 7.3."""

import struct

import h5py
import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_matrix

from gear_damping.errors import InputError
from gear_damping.measurement.formats import table as table_module
from gear_damping.measurement.formats.registry import read_table
from gear_damping.units import parse_unit
from tests.measurement.stored import MATRIX, TIME, WAVE, shapes_of, values_of

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
    assert shapes_of(table) == {
        "t": (60,), "rig 1/daq/wave": (60,), "rig 1/daq/all": (3, 60), "table.y": (60,), "table.xyz": (60, 3),
    }  # fmt: skip
    for name in ("rig 1/daq/wave", "/rig 1/daq/wave"):
        np.testing.assert_allclose(values_of(table, name), WAVE, atol=1e-7)
    assert values_of(table, "rig 1/daq/wave").dtype == np.float64
    np.testing.assert_array_equal(values_of(table, "/rig 1/daq/all[2]"), MATRIX[:, 2])
    np.testing.assert_array_equal(values_of(table, "table.y"), WAVE)
    np.testing.assert_allclose(values_of(table, "table.xyz[1]"), MATRIX[:, 1], atol=1e-6)
    assert [table.unit(table.index(name, "")) for name in ("t", "rig 1/daq/wave", "table.y")] == ["s", "m/s^2", None]


@pytest.mark.parametrize(("said", "unit"), [("milliseconds since 2024-01-01", "ms"), ("seconds since 1970-1-1", "s")])
def test_a_unit_of_time_since_a_date_is_that_unit(tmp_path, said, unit):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"] = np.arange(30.0)
        file["t"].attrs["units"] = said
    assert parse_unit(read_table(tmp_path / "a.h5").unit(0)) == parse_unit(unit)


def test_a_message_about_a_column_says_what_the_file_holds_withshapes_of(hdf5):
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
    np.testing.assert_array_equal(values_of(table, "t"), TIME)
    with pytest.raises(InputError, match=r"'rig 1/daq/all' cannot be read"):
        values_of(table, "rig 1/daq/all[0]")


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
    shapes = shapes_of(table)
    assert shapes["run.y"] == (60, 3)
    np.testing.assert_array_equal(values_of(table, "run.y[2]"), MATRIX[:, 2])
    np.testing.assert_array_equal(values_of(table, "run.in.u"), WAVE)
    np.testing.assert_array_equal(values_of(table, "run.in.on"), WAVE > 0)
    np.testing.assert_array_equal(values_of(table, "run.fs"), [1000])
    np.testing.assert_array_equal(values_of(table, "c[0]"), WAVE)
    np.testing.assert_array_equal(values_of(table, "c[1][1]"), MATRIX[:, 1])
    np.testing.assert_array_equal(values_of(table, "runs.y[1]"), 2 * WAVE)
    np.testing.assert_array_equal(values_of(table, "runs.fs"), [1000, 500])
    np.testing.assert_array_equal(values_of(table, "i"), [1, 2, 3])
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
        np.testing.assert_array_equal(values_of(table, name), 2 * WAVE)
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
    np.testing.assert_array_equal(values_of(table, "data.MeasuredData.Data[1]"), 2 * WAVE)


def test_mat_that_unpacks_to_too_much_inside_a_structure_is_refused(tmp_path):
    savemat(tmp_path / "a.mat", {"run": {"y": np.zeros(100_000)}}, do_compression=True)
    assert (tmp_path / "a.mat").stat().st_size < 10_000
    with pytest.raises(InputError, match="MB are more than"):
        read_table(tmp_path / "a.mat", max_bytes=10_000)


@pytest.mark.parametrize("format", ["4", "5"])
def test_old_mat_files_are_read(tmp_path, format):
    savemat(tmp_path / "a.mat", {"x": WAVE, "m": MATRIX}, format=format)
    table = read_table(tmp_path / "a.mat")
    np.testing.assert_array_equal(values_of(table, "x"), WAVE)
    np.testing.assert_array_equal(values_of(table, "m[1]"), MATRIX[:, 1])


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
    np.testing.assert_array_equal(values_of(table, "t"), TIME)
    np.testing.assert_array_equal(values_of(table, "data[2]"), MATRIX[:, 2])
    np.testing.assert_array_equal(values_of(table, "run.y[1]"), MATRIX[:, 1])
    np.testing.assert_array_equal(values_of(table, "run.in.u"), WAVE)
    np.testing.assert_array_equal(values_of(table, "c[0]"), WAVE)
    np.testing.assert_array_equal(values_of(table, "c[1][0]"), MATRIX[:, 0])
    assert shapes_of(table)["data"] == (60, 3)


def test_a_timeseries_object_is_said_with_what_to_do_in_matlab(mat73):
    table = read_table(mat73)
    assert not any(name.endswith("ts") or name.startswith("#") for name in table.names)
    with pytest.raises(InputError, match=r"ts \(MATLAB object; in MATLAB save its arrays, as t = ts.Time"):
        table.index("velocity", "column")


def _element(kind, content):
    return struct.pack("<II", kind, len(content)) + content + bytes(-len(content) % 8)


def _object(name, kind):
    """A variable of version 5 to 7 that is an object: its flags, name, system and class, and a handle."""
    words = b"".join(_element(1, word) for word in (name, b"MCOS", kind))
    sides, handle = _element(5, struct.pack("<2i", 6, 1)), _element(6, struct.pack("<6I", *range(6)))
    inner = _element(6, struct.pack("<2I", 13, 0)) + sides + _element(1, b"") + handle
    return _element(14, _element(6, struct.pack("<2I", 17, 0)) + words + _element(14, inner))


@pytest.mark.parametrize(
    ("kind", "remedy"),
    [
        ("timeseries", r"MATLAB object; in MATLAB save its arrays, as t = run\.Time; y = run\.Data"),
        ("table", r"MATLAB object; in MATLAB write it as text, writetable\(run, 'data\.csv'\)"),
        ("timetable", r"MATLAB object; in MATLAB write it as text, writetimetable\(run, 'data\.csv'\)"),
    ],
)
def test_an_object_of_an_older_file_has_its_name_and_what_saves_it(kind, remedy, tmp_path):
    """It was called None, and a table was to be saved like a time series."""
    savemat(tmp_path / "a.mat", {})
    with (tmp_path / "a.mat").open("ab") as file:
        file.write(_object(b"run", kind.encode()))
    with pytest.raises(InputError, match=rf"holds no array of real numbers, only run \({remedy}\); remedy: "):
        read_table(tmp_path / "a.mat")


def test_mat_7_3_too_large_or_cut_off_is_one_message(mat73):
    with pytest.raises(InputError, match="MB are more than"):
        read_table(mat73, max_bytes=3000)
    mat73.write_bytes(mat73.read_bytes()[:3000])
    with pytest.raises(InputError, match="not a readable MAT file"):
        read_table(mat73)


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
