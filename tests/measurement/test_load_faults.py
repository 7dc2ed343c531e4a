"""Every fault in a YAML or file ends as a message that names key, value, place and remedy."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.load import load_measurement


def _lines(bench) -> list[str]:
    bench.write_csv()
    return (bench.folder / "run_1.csv").read_text().splitlines()


def test_all_problems_come_at_once(bench):
    bench.content["parametres"] = {}
    bench.record["rol"] = "fit"
    bench.channels["transmission_error"]["unit"] = "furlong"
    bench.channels["pinion_torque"]["column"] = "T9"
    bench.add_record(file="nowhere.csv")  # a copy: its misspelt key and unit are two more
    problems = bench.problems()
    words = ["parametres", "records[0].rol", "records[0].channels.transmission_error.unit", "T9"]
    words += ["records[1].rol", "records[1].channels.transmission_error.unit", "nowhere.csv"]
    assert len(problems) == len(words), problems
    for word in words:
        assert sum(word in problem for problem in problems) == 1, word


@pytest.mark.parametrize(
    ("place", "key", "right"),
    [
        (lambda b: b.content, "record", "records"),
        (lambda b: b.content["parameters"], "modul", "module"),
        (lambda b: b.content["parameters"]["module"], "uncertainity", "uncertainty"),
        (lambda b: b.record, "slize", "slice"),
        (lambda b: b.channels, "transmision_error", "transmission_error"),
        (lambda b: b.channels["time"], "colum", "column"),
        (lambda b: b.channels["transmission_error"], "low_pass", "lowpass"),
        (lambda b: b.record.setdefault("conditions", {}), "pinion_sped", "pinion_speed"),
        (lambda b: b.record.setdefault("encoders", {}), "pinon", "pinion"),
    ],
)
def test_an_unknown_key_names_the_nearest(bench, place, key, right):
    place(bench)[key] = {}
    problem = bench.only_problem()
    assert f"{key}: unknown key" in problem
    assert f"did you mean '{right}'?" in problem
    assert "measurement.yaml" in problem


def test_a_key_one_floor_too_high_is_sent_to_its_place(bench):
    bench.record["pinion_speed"] = {"value": 300, "unit": "rpm"}
    assert "pinion_speed: unknown key; remedy: it is a key of channels or of conditions: write it there" in (
        bench.only_problem()
    )


@pytest.mark.timeout(20)
@pytest.mark.parametrize("key", ["uncertain.1.2", ".", "value.unit", "a" * 3000])
def test_an_unknown_key_with_dots_ends_as_a_message(bench, key):
    """It was looked for in vain, again and again."""
    bench.content["parameters"]["module"][key] = 0.05
    (problem,) = bench.problems()
    assert "unknown key" in problem


def test_a_file_name_that_no_file_can_bear_ends_as_a_message(bench):
    bench.record["file"] = "a" * 5000
    (problem,) = bench.problems(write=False)
    assert "File name too long" in problem


@pytest.mark.parametrize(
    ("unit", "said"),
    [
        ("furlong", "unknown unit 'furlong'"),
        ("N", "not one of the kind of 'm'"),
        ("g*m", "write 'gram' or 'gn'"),
    ],
)
def test_a_wrong_unit_names_channel_and_unit(bench, unit, said):
    bench.channels["transmission_error"]["unit"] = unit
    problem = bench.only_problem()
    assert "records[0].channels.transmission_error.unit" in problem
    assert said in problem


def test_a_missing_unit_is_asked_for(bench):
    del bench.channels["transmission_error"]["unit"]
    assert "transmission_error.unit: is missing" in bench.only_problem()


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("slice", [400], "must be [a, b]"),
        ("slice", [-1, 50], "must be [a, b]"),
        ("slice", [90, 90], "must be [a, b]"),
        ("slice", [0, 1e3], "must be [a, b]"),
        ("slice", [0, 401], "run_1.csv has 400 rows"),
        ("slice", [10, 12], "at least 8"),
        ("role", "fti", "did you mean 'fit'?"),
        ("file", 7, "must be a text"),
        ("mesh_index", "yes please", "must be true or false"),
    ],
)
def test_a_bad_entry_of_a_record_is_named(bench, key, value, said):
    bench.write_csv()
    bench.record[key] = value
    problem = bench.only_problem(write=False)
    assert said in problem
    assert "records[0]" in problem


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("lowpass", 20, "needs a value and a unit"),
        ("lowpass", {"value": 8}, "lowpass.unit: is missing"),
        ("lowpass", {"value": -8, "unit": "Hz"}, "must be positive"),
        ("lowpass", -8, "must be positive; remedy: write lowpass: {value: …, unit: Hz}"),
        ("lowpass", {"value": 8, "unit": "s"}, "not one of the kind of 'Hz'"),
        ("range", {"value": 8, "unit": "V"}, "not one of the kind of 'm'"),
        ("coupling", "CD", "must be one of DC, AC"),
        ("polarity", 2, "must be one of 1, -1"),
        ("polarity", True, "must be one of 1, -1"),
        ("uncertainty", -0.1, "at least 0"),
        (
            "uncertainty",
            float("nan"),
            "must be a finite number; remedy: write a number: neither infinity nor nan is one",
        ),
        ("gain", "inf", "must be a finite number; remedy: write a number: neither infinity nor nan is one"),
        ("range", {"value": float("inf"), "unit": "mm"}, "or leave range out where it is not known"),
        ("datum", "relative", "must be one of absolute, arbitrary"),
    ],
)
def test_a_bad_word_about_a_sensor_is_named(bench, key, value, said):
    bench.channels["transmission_error"][key] = value
    problem = bench.only_problem()
    assert f"transmission_error.{key}" in problem
    assert said in problem


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("module", 3, "needs a value and a unit; remedy: write module: {value: 3, unit: mm}, or"),
        ("module", 0, "must be positive"),
        ("module", -3, "= -3: must be positive; remedy: write module: {value: …, unit: m}"),
        ("module", float("inf"), "= inf: must be a finite number, and needs a unit; remedy: write module: {value: …"),
        ("module", "nan mm", "must be a finite number, and needs a unit; remedy: write module: {value: …, unit: m}"),
        ("module", "-.inf", "must be a finite number"),
        ("module", "-.inf", "; leave module out where it is not known"),
        (
            "module",
            {"value": float("inf"), "unit": "mm"},
            "value = inf: must be a finite number; remedy: write a finite",
        ),
        (
            "damping_ratio",
            float("inf"),
            "must be a finite number; remedy: write a finite number, or leave damping_ratio",
        ),
        ("damping_ratio", {"value": float("nan")}, "write a finite number, or leave damping_ratio out"),
        (
            "damping_ratio",
            "inf %",
            "must be a finite number; remedy: write a finite number, or leave damping_ratio out",
        ),
        ("backlash_gap", -1e-4, "= -0.0001: must not be negative"),
        ("module", {"value": 0, "unit": "mm"}, "must be positive"),
        ("n_teeth_pinion", 20.5, "whole number"),
        ("inertia_gear", {"value": 1, "unit": "kg"}, "kg*m^2"),
        ("damping_ratio", 0, "must be positive; remedy: leave the key out"),
    ],
)
def test_a_bad_parameter_is_named(bench, name, value, said):
    bench.content["parameters"] = {name: value}
    problem = bench.only_problem()
    assert f"parameters.{name}" in problem
    assert said in problem


@pytest.mark.parametrize("system", ["gearpair", None, 3])
def test_a_wrong_system_is_named(bench, system):
    bench.content["system"] = system
    assert "gear_pair" in bench.only_problem()


def test_records_must_be_there(bench):
    bench.write_csv()
    bench.content["records"] = []
    (bench.folder / "m.yaml").write_text("system: oscillator\nrecords: []\n")
    with pytest.raises(InputError, match="at least one record"):
        load_measurement(bench.folder / "m.yaml")


@pytest.mark.parametrize(
    ("drop", "add", "said"),
    [
        (["transmission_error"], {}, "lacks a transmission_error"),
        (["pinion_angle"], {}, "lacks pinion_speed"),
        (["pinion_torque"], {}, "lacks pinion_torque"),
        (["gear_torque"], {}, "gear_torque: balanced"),
        (["time"], {}, "neither time nor sampling_rate"),
        ([], {"sampling_rate": {"value": 20, "unit": "kHz"}}, "both given"),
    ],
)
def test_what_a_gear_record_needs_is_asked_for(bench, drop, add, said):
    for name in drop:
        del bench.channels[name]
    bench.channels.update(add)
    assert said in bench.only_problem()


@pytest.mark.parametrize(("rate", "said"), [(0, "must be positive"), (-5, "must be positive")])
def test_a_sampling_rate_must_be_positive(bench, rate, said):
    del bench.channels["time"]
    bench.channels["sampling_rate"] = {"value": rate, "unit": "Hz"}
    assert said in bench.only_problem()


def test_a_missing_file_is_named_with_its_folder(bench):
    problem = bench.only_problem(write=False)
    assert "no such file" in problem
    assert str(bench.folder) in problem


def test_a_missing_data_folder_names_the_variable(bench, monkeypatch):
    monkeypatch.setenv("GEAR_DAMPING_DATA", str(bench.folder / "absent"))
    bench.record["file"] = "${GEAR_DAMPING_DATA}/run_1.csv"
    assert "set the environment variable GEAR_DAMPING_DATA" in bench.only_problem(write=False)
    bench.record["file"] = "${HOME}/run_1.csv"
    assert "only ${GEAR_DAMPING_DATA} is filled in" in bench.only_problem(write=False)


def test_a_missing_column_names_the_nearest(bench):
    bench.channels["transmission_error"]["column"] = "dtee"
    problem = bench.only_problem()
    assert "transmission_error.column = 'dtee': no such column" in problem
    assert "did you mean 'dte'? run_1.csv holds t (400), dte (400)" in problem


@pytest.mark.parametrize("index", [4, -1])
def test_a_column_index_out_of_range_lists_the_columns(bench, index):
    bench.channels["transmission_error"]["column"] = index
    assert "0 't' (400), 1 'dte' (400)" in bench.only_problem()


def test_a_run_of_nan_names_file_column_and_sample(bench):
    bench.columns["dte"][120:125] = np.nan
    bench.columns["dte"][300] = np.inf
    problem = bench.only_problem()
    for part in ("run_1.csv column 'dte'", "6 value(s)", "first at sample 120", "up to 5 in a row"):
        assert part in problem
    bench.record["slice"] = [130, 290]
    assert bench.load().records[0].time.size == 160


def test_nan_in_a_slice_is_counted_from_the_first_row_of_the_file(bench):
    bench.columns["dte"][120] = np.nan
    bench.record["slice"] = [100, 200]
    assert "first at sample 120" in bench.only_problem()


@pytest.mark.parametrize(
    ("shift", "said"),
    [(-1, "1 repeated time stamp(s), the first at sample 51"), (-3, "1 backward time stamp(s)")],
)
def test_time_that_stands_still_or_runs_back_is_named(bench, shift, said):
    bench.columns["t"][51:] += shift * bench.columns["t"][1]
    assert said in bench.only_problem()


def test_an_empty_file_is_named(bench):
    (bench.folder / "run_1.csv").write_text("")
    assert "the file is empty" in bench.only_problem(write=False)
    (bench.folder / "run_1.csv").write_text("t,dte,T1,theta1\n")
    assert "a header and no rows" in bench.only_problem(write=False)


def test_a_ragged_row_is_named(bench):
    lines = _lines(bench)
    lines[8] = lines[8].rsplit(",", 1)[0]
    bench.write_lines(lines)
    problem = bench.only_problem(write=False)
    assert "row 7 (line 9)" in problem
    assert "3 cells where the first line has 4" in problem


@pytest.mark.parametrize(("cell", "said"), [("n/a", "not a number"), ("", "an empty cell"), ("1,5", "cells where")])
def test_a_cell_that_is_no_number_names_row_and_column(bench, cell, said):
    lines = _lines(bench)
    cells = lines[33].split(",")
    cells[1] = cell
    lines[33] = ",".join(cells)
    bench.write_lines(lines)
    problem = bench.only_problem(write=False)
    assert "row 32 (line 34)" in problem
    assert said in problem
    assert ("column 1 'dte'" in problem) == (said != "cells where")


def test_a_bad_cell_of_an_unused_column_does_not_matter(bench):
    bench.columns["T2"] = np.full(400, 9.0)
    lines = _lines(bench)
    lines[20] = lines[20].rsplit(",", 1)[0] + ",oops"
    bench.write_lines(lines)
    assert bench.load_as_it_is().records[0].time.size == 400


def test_channels_of_different_length_need_their_own_time(bench):
    np.savez(bench.folder / "run.npz", **{**bench.columns, "T1": np.ones(300)})
    bench.record["file"] = "run.npz"
    problem = bench.only_problem(write=False)
    assert "column 'T1' has 300 samples, the record 400" in problem
    assert "own time or sampling_rate" in problem


def test_a_channel_that_ends_before_the_record_is_refused(bench):
    np.savez(bench.folder / "run.npz", **{**bench.columns, "T1": np.ones(50)})
    bench.record["file"] = "run.npz"
    bench.channels["pinion_torque"]["sampling_rate"] = {"value": 5, "unit": "kHz"}
    assert "shorten the record with slice" in bench.only_problem(write=False)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("system: oscillator\nsystem: gear_pair\n", "appears twice"),
        ("system: [oscillator\n", "not valid YAML at line"),
        ("- just\n- a list\n", "must be a mapping"),
        ("", "must be a mapping"),
        ("!!python/object/apply:os.getcwd []\n", "not valid YAML"),
    ],
)
def test_a_yaml_that_cannot_be_read_is_one_error(tmp_path, text, said):
    path = tmp_path / "measurement.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        load_measurement(path)


@pytest.mark.parametrize("head", ["Sample rate: 500 Hz\nlogger: 3\nt,x\n", "[ready]\nt\tx\n", "t,x\n%d,%d\n"])
def test_a_file_of_data_in_its_place_is_answered_with_the_task_that_reads_one(tmp_path, head):
    (tmp_path / "run.csv").write_text(f"{head}0,1\n1,2\n")
    with pytest.raises(InputError, match=r"task=inspect measurement\.path=\S+run\.csv writes one to start from"):
        load_measurement(tmp_path / "run.csv")


def test_a_yaml_that_is_not_there_or_not_text_is_one_error(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        load_measurement(tmp_path / "measurement.yaml")
    (tmp_path / "measurement.yaml").write_bytes(b"system: \xff\xfe\xb5")
    with pytest.raises(InputError, match="not UTF-8"):
        load_measurement(tmp_path / "measurement.yaml")


def test_two_records_of_one_name_are_refused(bench):
    bench.record["name"] = "twin"
    bench.add_record()
    assert "2 records bear the name 'twin'" in bench.only_problem()


def test_units_of_an_oscillator_must_agree_in_kind(bench):
    bench.content = {
        "system": "oscillator",
        "parameters": {"force_gain": {"value": 1, "unit": "m/s^2/V"}},
        "records": [
            {
                "file": "run_1.csv",
                "channels": {
                    "time": {"column": "t", "unit": "s"},
                    "displacement": {"column": "dte", "unit": "V"},
                    "velocity": {"column": "T1", "unit": "m/s"},
                    "force": {"column": "theta1", "unit": "V"},
                },
            }
        ],
    }
    problems = bench.problems()
    assert len(problems) == 2
    assert any("velocity.unit" in p and "not one of the kind of 'V/s'" in p for p in problems)
    assert any("parameters.force_gain" in p and "V/s^2/V" in p for p in problems)
