"""The readers: what each format gives, and how each says what is wrong."""

import gzip
import wave

import numpy as np
import pytest
from scipy.io import savemat, wavfile

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table


def _csv(folder, text: str, encoding: str = "utf-8"):
    path = folder / "data.csv"
    path.write_bytes(text.encode(encoding))
    return read_table(path)


def _column(table, name):
    return table.values(table.index(name, "column")).tolist()


@pytest.mark.parametrize(
    "text",
    [
        "t,a\n0,1.5\n1,-2e-3\n",
        '"t","a",\r\n0,1.5,\r\n1,-2e-3,\r\n\r\n',  # quotes, an empty third column, blank lines
        "t,a,\n0,1.5\n1,-2e-3\n",  # a third header without cells
        "t;a\n0;1,5\n1;-2e-3\n",
        "t\ta\n0\t1.5\n1\t-2e-3\n",
        "t a\n0  1.5\n1 -2e-3\n",
        "# exported by a logger\n# t,a\n0,1.5\n1,-2e-3\n",
        "\ufefft, a\n0, 1.5\n1, -2e-3\n",
    ],
)
def test_the_same_numbers_come_out_of_every_dialect(tmp_path, text):
    table = _csv(tmp_path, text)
    assert _column(table, "t") == [0, 1]
    assert _column(table, "a") == [1.5, -2e-3]
    assert _column(table, 1) == [1.5, -2e-3]


def test_a_decimal_comma_is_said_and_never_guessed_against_points(tmp_path):
    table = _csv(tmp_path, "t;a\n0;1,5\n1;2\n")
    assert _column(table, "a") == [1.5, 2]
    assert table.notes == ("data.csv: read with decimal commas",)
    mixed = _csv(tmp_path, "t;a\n0;1,500\n1;2.5\n")
    assert np.isnan(_column(mixed, "a")[0])
    assert "row 0 (line 2), column 1 'a' = '1,500': not a number" in str(mixed.bad_cells(1, 0, 2)[0])


def test_bars_part_columns_and_stand_in_names_where_others_do(tmp_path):
    table = _csv(tmp_path, "TE [um]|angle [deg]\n3.5|228.6\n3.25|229\n")
    assert (_column(table, 0), _column(table, "angle [deg]")) == ([3.5, 3.25], [228.6, 229])
    assert _csv(tmp_path, "|X|,Y\n1,2\n").names == ("|X|", "Y")


def test_a_header_names_units_and_may_hold_the_delimiter(tmp_path):
    table = _csv(tmp_path, '"Acc DE, radial (m/s^2)",Speed [rpm],Note\n1,2,3\n')
    assert table.names == ("Acc DE, radial (m/s^2)", "Speed [rpm]", "Note")
    assert [table.unit(k) for k in range(3)] == ["m/s^2", "rpm", None]


def test_units_stand_behind_a_stroke_or_before_the_number_of_a_run_too(tmp_path):
    names = ["t/s", "AngVel/rad/s", "Weg/mm", "Angle, Ch P1 (rad) Run #16", "group/name", "data[3]"]
    names += ["Position (cm) Monitor Run", "Signal (left) of x", "x (2) old"]
    table = _csv(tmp_path, ",".join(f'"{name}"' for name in names) + "\n1,2,3,4,5,6,7,8,9\n")
    assert [table.unit(k) for k in range(len(names))] == ["s", "rad/s", "mm", "rad", None, None, "cm", None, None]


def test_older_encodings_are_read(tmp_path):
    assert _csv(tmp_path, "t,x (µm)\n0,1\n", "latin-1").unit(1) == "µm"
    assert _csv(tmp_path, "t,x (µm)\n0,1\n", "utf-16").unit(1) == "µm"


@pytest.mark.parametrize("code", ["utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("name", ["x", "変位センサの値"])
def test_utf_16_needs_no_mark_of_its_order(code, name, tmp_path):
    table = _csv(tmp_path, f"Time (s);{name} (µm)\n" + "".join(f"{k};{k / 8}\n" for k in range(9)), code)
    assert table.names == ("Time (s)", f"{name} (µm)")
    assert table.unit(1) == "µm"
    np.testing.assert_allclose(table.values(1), np.arange(9) / 8)


def test_a_wide_text_that_was_cut_within_a_letter_is_read(tmp_path):
    text = "t;x\n" + "".join(f"{k};{k / 8}\n" for k in range(9)) + " "
    (tmp_path / "a.csv").write_bytes(text.encode("utf-16-le")[:-1])
    np.testing.assert_allclose(read_table(tmp_path / "a.csv").values(1), np.arange(9) / 8)


def test_binary_numbers_of_two_bytes_are_no_text(tmp_path):
    (tmp_path / "a.csv").write_bytes(np.arange(1, 200, dtype="<i2").tobytes())
    with pytest.raises(InputError, match="not a text file"):
        read_table(tmp_path / "a.csv")


def test_a_file_without_header_is_read_by_index(tmp_path):
    table = _csv(tmp_path, "0,1\n1,2\n")
    assert _column(table, 1) == [1, 2]
    with pytest.raises(InputError, match=r"give a 0-based index: 0 .2., 1 .2."):
        table.index("x", "column")


def test_a_column_without_name_or_cells_is_empty_when_asked_for(tmp_path):
    table = _csv(tmp_path, "t,a,\n0,1.5\n1,2\n")
    with pytest.raises(InputError, match="column 2: all of its cells are empty; remedy: name another column: t, a"):
        table.values(2)


def test_a_repeated_header_needs_an_index(tmp_path):
    table = _csv(tmp_path, "x,x\n0,1\n1,2\n")
    with pytest.raises(InputError, match=r"2 columns bear this name.*one of \[0, 1\]"):
        table.index("x", "column")


def test_the_last_part_of_a_path_is_enough_where_it_is_the_only_one(tmp_path):
    held = {"left/force": np.arange(3.0), "left/speed": np.ones(3), "right/speed": np.zeros(3)}
    np.savez(tmp_path / "a.npz", **held)
    table = read_table(tmp_path / "a.npz")
    assert _column(table, "force") == [0, 1, 2]
    assert _column(table, "right/speed") == [0, 0, 0]
    with pytest.raises(InputError, match=r"2 columns bear this name.*one of \[1, 2\]"):
        table.index("speed", "column")


def test_many_faults_are_counted_not_listed(tmp_path):
    with pytest.raises(InputError) as caught:
        _column(_csv(tmp_path, "t,a\n" + "0,x\n" * 50 + "0,1\n"), "a")
    assert len(caught.value.problems) == 4
    assert "47 more cells" in str(caught.value)
    with pytest.raises(InputError, match="47 more rows"):
        _csv(tmp_path, "t,a\n" + "0\n" * 50 + "0,1\n")


def test_binary_under_the_name_of_text_is_refused(tmp_path):
    (tmp_path / "data.csv").write_bytes(b"\x00\x01\x02" * 50)
    with pytest.raises(InputError, match="not a text file"):
        read_table(tmp_path / "data.csv")


def test_gzip_packs_text_only(tmp_path):
    savemat(tmp_path / "a.mat", {"x": np.arange(100.0)})
    (tmp_path / "a.mat.gz").write_bytes(gzip.compress((tmp_path / "a.mat").read_bytes()))
    with pytest.raises(InputError, match=r"a\.mat\.gz.*remedy: unpack it: of what gzip packs only text is read"):
        read_table(tmp_path / "a.mat.gz")


def test_npz_gives_vectors_and_the_columns_of_matrices(tmp_path):
    matrix = np.arange(20.0).reshape(2, 10)
    np.savez(tmp_path / "a.npz", x=np.arange(10, dtype=np.int16), m=matrix, label=np.array("rig 3"))
    table = read_table(tmp_path / "a.npz")
    assert table.names == ("x", "m[0]", "m[1]")
    np.testing.assert_array_equal(table.values(2), matrix[1])
    assert table.values(0).dtype == np.float64


@pytest.mark.parametrize("digits", ["ns", "us", "ms"])
def test_npz_gives_dates_and_durations_in_seconds(tmp_path, digits):
    went = np.arange(40).astype(f"timedelta64[{digits}]") * 5
    dates = np.datetime64("2026-03-01T12:00:00", digits) + went
    gone = dates.copy()
    gone[3] = "NaT"
    np.savez(tmp_path / "a.npz", went=went, dates=dates, later=dates + np.timedelta64(2, "s"), gone=gone)
    table, seconds = read_table(tmp_path / "a.npz"), np.arange(40) * {"ns": 5e-9, "us": 5e-6, "ms": 5e-3}[digits]
    for name in ("went", "dates", "later"):
        np.testing.assert_allclose(_column(table, name), seconds, rtol=1e-12)
        assert table.unit(table.index(name, "")) == "s"
    assert np.flatnonzero(np.isnan(_column(table, "gone"))).tolist() == [3]
    begun = [table.begins(table.index(name, "")) for name in ("went", "dates", "later")]
    assert begun == [None, 825_681_600.0, 825_681_602.0]  # s since 2000


def test_npz_with_python_objects_is_never_unpickled(tmp_path):
    np.savez(tmp_path / "a.npz", x=np.array([{}, 1], dtype=object))
    with pytest.raises(InputError, match="not a readable NPZ"):
        read_table(tmp_path / "a.npz")


def test_npz_that_unpacks_to_too_much_is_refused(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", x=np.zeros(100_000))
    assert (tmp_path / "a.npz").stat().st_size < 10_000
    with pytest.raises(InputError, match="1 MB are more than the 0 MB"):
        read_table(tmp_path / "a.npz", max_bytes=10_000)


def test_mat_that_unpacks_to_too_much_is_refused(tmp_path):
    savemat(tmp_path / "a.mat", {"x": np.zeros(100_000)}, do_compression=True)
    with pytest.raises(InputError, match="1 MB are more than"):
        read_table(tmp_path / "a.mat", max_bytes=10_000)


@pytest.mark.parametrize(
    ("suffix", "remedy"),
    [
        (
            "parquet",
            "write it as CSV, in Python pandas.read_parquet('a.parquet').to_csv('a.csv', index=False); a format",
        ),
        (
            "feather",
            "write it as CSV, in Python pandas.read_feather('a.feather').to_csv('a.csv', index=False); a format",
        ),
        ("ods", "save it as an Excel workbook (.xlsx) or as CSV in the spreadsheet; a format of your own"),
        ("mf4", "export its channels as CSV or MAT from the program that made it; a format of your own"),
    ],
)
def test_a_format_that_is_no_text_is_told_how_it_is_brought_into_one_that_is_read(tmp_path, suffix, remedy):
    """They were to be named .txt where they are tables in text."""
    (tmp_path / f"a.{suffix}").write_bytes(b"PAR1")
    with pytest.raises(InputError) as said:
        read_table(tmp_path / f"a.{suffix}")
    (problem,) = said.value.problems
    assert problem.remedy.startswith(remedy)


@pytest.mark.parametrize("suffix", ["npz", "mat", "wav", "h5", "tdms", "xlsx", "gz"])
def test_garbage_is_one_error_that_names_the_file(tmp_path, suffix):
    path = tmp_path / f"a.{suffix}"
    path.write_bytes(bytes(range(1, 250)) * 4)
    with pytest.raises(InputError, match=rf"a\.{suffix}'?: not a readable"):
        read_table(path)


def test_an_unknown_format_lists_the_known(tmp_path):
    (tmp_path / "a.xls").write_bytes(b"something")
    with pytest.raises(InputError, match=r"unknown format '.xls'.*save it as one of .*\.csv.*\.hdf5.*\.tdms.*\.xlsx"):
        read_table(tmp_path / "a.xls")


def test_a_large_file_is_refused_before_it_is_read(tmp_path):
    (tmp_path / "a.csv").write_text("t,a\n" + "0,1\n" * 1000)
    wavfile.write(tmp_path / "a.wav", 12800, np.zeros(1000, np.int16))
    for name in ("a.csv", "a.wav"):
        with pytest.raises(InputError, match="more than the"):
            read_table(tmp_path / name, max_bytes=1000)


@pytest.mark.parametrize(
    ("dtype", "stored", "fractions"),
    [
        (np.int16, [-32768, 0, 16384], [-1, 0, 0.5]),
        (np.int32, [-(2**31), 0, 2**30], [-1, 0, 0.5]),
        (np.uint8, [0, 128, 192], [-1, 0, 0.5]),
        (np.float32, [-3.0, 0, 0.5], [-3, 0, 0.5]),
    ],
)
def test_wav_integers_are_fractions_of_full_scale(tmp_path, dtype, stored, fractions):
    wavfile.write(tmp_path / "a.wav", 12800, np.array(stored, dtype))
    table = read_table(tmp_path / "a.wav")
    assert table.sampling_rate == 12800
    assert table.values(0).tolist() == fractions
    assert ("full scale" in table.notes[0]) == (dtype is not np.float32)


@pytest.mark.parametrize("chunk", [b"", b"LIST\x03\x00\x00\x00abc\x00"])
@pytest.mark.parametrize(("bytes_each", "largest"), [(1, 128), (2, 32768), (3, 8388608), (4, 2147483648)])
def test_the_bits_of_a_wav_file_are_those_of_its_header(tmp_path, bytes_each, largest, chunk):
    """Three bytes a sample are read in four."""
    path = tmp_path / "a.wav"
    with wave.open(str(path), "wb") as file:
        file.setparams((1, bytes_each, 12800, 0, "NONE", ""))
        middle = 128 if bytes_each == 1 else 0
        file.writeframes(b"".join(one.to_bytes(bytes_each, "little") for one in [middle, middle + largest // 2]))
    content = path.read_bytes()
    size = (len(content) - 8 + len(chunk)).to_bytes(4, "little")
    path.write_bytes(content[:4] + size + content[8:12] + chunk + content[12:])
    table = read_table(path)
    assert table.values(0).tolist() == [0, 0.5]
    said = f"WAV holds integers of {8 * bytes_each} bits: divided by {largest}, so that full scale is 1"
    assert table.notes == (said,)


def test_a_wav_record_brings_its_rate_and_is_scaled_by_the_range(bench):
    samples = (3000 * np.sin(np.arange(2000) / 9)).astype(np.int16)
    wavfile.write(bench.folder / "a.wav", 12800, np.column_stack([samples, -samples]))
    channel = {"column": 1, "unit": "m/s^2", "range": {"value": 5, "unit": "gn"}}
    record = {"file": "a.wav", "channels": {"acceleration": channel}}
    record["conditions"] = {"pinion_speed": {"value": 1800, "unit": "rpm"}}
    bench.content["records"] = [record]
    loaded = bench.load_as_it_is().records[0]
    assert loaded.sampling_rate == 12800
    expected = -samples / 32768 * 5 * 9.80665
    np.testing.assert_allclose(loaded.channels["acceleration"].values, expected, rtol=1e-14)
    assert loaded.channels["acceleration"].mounting == "casing"
    assert any("full scale is taken as 49.03" in note for note in loaded.notes)
    record["channels"]["sampling_rate"] = {"value": 44.1, "unit": "kHz"}
    other = bench.load_as_it_is().records[0]
    assert other.sampling_rate == 44100
    conflict = next(one for one in other.findings if one.kind == "rate_conflict")
    assert "the file itself says 12800 Hz" in conflict.message
    assert conflict.severity == "data_problem"


@pytest.mark.parametrize("said", [{"range": "1000 urad"}, {"gain": 0.001}])
def test_an_angle_of_a_shaft_is_scaled_by_what_full_scale_is_said_to_be(bench, said):
    """A thousandth of full scale per microradian, by either word, along the line of action of the shaft."""
    samples = (3000 * np.sin(np.arange(2000) / 9)).astype(np.int16)
    wavfile.write(bench.folder / "a.wav", 12800, samples)
    error = {"column": 0, "unit": "urad", "shaft": "gear", "datum": "arbitrary", **said}
    bench.content["parameters"] |= {"n_teeth_pinion": 20, "n_teeth_gear": 40, "pressure_angle": "20 deg"}
    record = {"file": "a.wav", "channels": {"transmission_error": error}}
    record["conditions"] = {"pinion_speed": "1800 rpm", "pinion_torque": "40 N*m"}
    bench.content["records"] = [record]
    loaded = bench.load_as_it_is().records[0]
    radius = 40 * 3e-3 / 2 * np.cos(np.deg2rad(20))
    expected = samples / 32768 * 1e-3 * radius
    np.testing.assert_allclose(loaded.channels["transmission_error"].values, expected, rtol=1e-12)
    assert any(f"full scale is taken as {1e-3 * radius:.6g} m" in note for note in loaded.notes)


def test_without_a_range_the_full_scale_of_a_wav_file_is_said_to_be_a_guess(bench):
    samples = (3000 * np.sin(np.arange(2000) / 9)).astype(np.int16)
    wavfile.write(bench.folder / "a.wav", 12800, samples)
    channel = {"column": 0, "unit": "g"}
    record = {"file": "a.wav", "channels": {"acceleration": channel}}
    record["conditions"] = {"pinion_speed": {"value": 1800, "unit": "rpm"}}
    bench.content["records"] = [record]
    said = "acceleration: no range is stated, and full scale is taken as 1 g, a guess: write `range: 50 g`"
    assert any(note.startswith(said) for note in bench.load_as_it_is().records[0].notes)
    channel["range"] = "50 g"
    assert not any("a guess" in note for note in bench.load_as_it_is().records[0].notes)


def test_settings_above_a_table_without_a_header_are_left_out(tmp_path):
    path = tmp_path / "swing.lvm"
    values = -90 + np.arange(50) / 8
    path.write_text("trigger_deg, rate, seconds\n90, 1000, 5\n" + "\n".join(map(str, values)))
    table = read_table(path)
    assert _column(table, 0) == values.tolist()
    assert "2 line(s) above the values are left out" in table.notes[0]


def test_a_header_that_is_wider_than_its_table_is_no_such_setting(tmp_path):
    with pytest.raises(InputError, match="2 cells where the first line has 3"):
        _csv(tmp_path, "time,x,remark\n" + "\n".join(f"{k / 10},{k}" for k in range(50)))


LABVIEW = (
    "LabVIEW Measurement{s}\nWriter_Version{s}2\nSeparator{s}x\n***End_of_Header***{s}\n{s}\nChannels{s}2{s}{s}\n"
    "Samples{s}3{s}3{s}\nY_Unit_Label{s}Volts{s}g{s}\nX0{s}0.0E+0{s}0.0E+0{s}\nDelta_X{s}0.001{s}0.001{s}\n"
    "***End_of_Header***{s}{s}{s}\nX_Value{s}Voltage{s}Acceleration{s}{last}\n"
    "0.000{s}-0.17{s}-0.016\n0.001{s}-0.63{s}-0.094\n0.002{s}-0.51{s}-0.066\n"
)


@pytest.mark.parametrize("sign", [",", "\t"])
@pytest.mark.parametrize("last", ["Comment", ""])
def test_a_labview_text_file_is_read_below_its_last_header(tmp_path, sign, last):
    table = _csv(tmp_path, LABVIEW.format(s=sign, last=last))
    assert [name for name in table.names if name] == ["X_Value", "Voltage", "Acceleration"]
    assert _column(table, "X_Value") == [0, 0.001, 0.002]
    assert _column(table, "Acceleration") == [-0.016, -0.094, -0.066]
    assert [table.unit(table.index(name, "column")) for name in ("X_Value", "Voltage", "Acceleration")] == [
        "s",
        "Volts",
        "g",
    ]


@pytest.mark.parametrize("sign", [",", "\t"])
def test_labview_s_channels_of_one_sample_a_block_have_no_other_values(tmp_path, sign):
    head, _, values = LABVIEW.format(s=sign, last="Drive").partition("Drive\n")
    first, *others = values.splitlines()
    table = _csv(
        tmp_path,
        head + "\n".join([f"Drive{sign}Comment", f"{first}{sign}42.05", *(f"{row}{sign}" for row in others)]) + "\n",
    )
    assert table.names == ("X_Value", "Voltage", "Acceleration", "Drive")
    assert _column(table, "Acceleration") == [-0.016, -0.094, -0.066]
    np.testing.assert_array_equal(_column(table, "Drive"), [42.05, np.nan, np.nan])
