"""The remedy of a message is the one that cures: the right name, the product with its sign, the decimal point."""

import re

import numpy as np
import pytest

from gear_damping.errors import InputError, nearest
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.quantities import Column, Measured, Rate
from gear_damping.units import parse_unit


def test_the_same_words_in_another_order_are_nearest():
    assert nearest("pinion_inertia", ["inertia_gear", "module", "inertia_pinion"]) == "did you mean 'inertia_pinion'?"
    assert nearest("inertia_pinio", ["inertia_gear", "module", "inertia_pinion"]) == "did you mean 'inertia_pinion'?"


@pytest.mark.parametrize(
    ("word", "choices", "right"),
    [
        ("pinion_teeth", ["n_teeth_gear", "n_teeth_pinion"], "n_teeth_pinion"),
        ("teeth", ["n_teeth_gear", "n_teeth_pinion", "tooth"], "tooth"),  # two have all its words: spelling decides
        ("backlash", ["backlash_gap", "gear_lash"], "backlash_gap"),
    ],
)
def test_the_only_name_with_all_the_words_is_nearest(word, choices, right):
    assert nearest(word, choices) == f"did you mean '{right}'?"


@pytest.mark.parametrize(
    ("text", "product", "factor"),
    [
        ("kgm2", "kg*m2", 1.0), ("kgm^2", "kg*m^2", 1.0), ("kg m^2", "kg*m^2", 1.0), ("kg.m2", "kg*m2", 1.0),
        ("kgcm2", "kg*cm2", 1e-4), ("Nmm", "N*mm", 1e-3), ("in-lbf", "in*lbf", 0.0254 * 4.4482216152605),
    ],
)  # fmt: skip
def test_a_product_without_its_sign_is_answered_with_one(text, product, factor):
    with pytest.raises(InputError, match="unknown unit") as caught:
        parse_unit(text)
    assert caught.value.problems[0].remedy == f"write '{product}'"
    assert parse_unit(product).factor == pytest.approx(factor, rel=1e-12)


@pytest.mark.parametrize("text", ["mmm", "Nn", "N m x"])
def test_what_is_no_product_is_answered_with_the_nearest_unit(text):
    with pytest.raises(InputError) as caught:
        parse_unit(text)
    assert "did you mean" in caught.value.problems[0].remedy


def test_a_decimal_comma_is_answered_with_the_point(bench):
    bench.record["conditions"] = {"pinion_speed": {"value": "1200,5", "unit": "rpm"}}
    assert "remedy: write 1200.5, with a decimal point" in bench.only_problem()
    bench.record["conditions"] = {"pinion_speed": {"value": 1200, 5: None, "unit": "rpm"}}  # {value: 1200,5, …}
    assert "remedy: write a decimal point, not a comma" in bench.only_problem()


def test_decimal_commas_between_commas_are_told_from_ragged_rows(bench):
    def remedy(lines: list[str]) -> str:
        bench.write_lines(lines)
        return bench.problems(write=False)[-1]

    header = ",".join(bench.columns)
    assert "with decimal points" in remedy([header, *["0,1,0,2,0,3,0,4"] * 20])
    assert "with decimal points" not in remedy([header, *["0,1,0,2,0"] * 20])


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        ("system: oscillator\nsystem: gear_pair\n", "keep the one that is right"),
        ("records:\n\t- file: a.csv\n", "indent with spaces, not with tabs"),
        ("records: {column: te [um]}\n", "quote texts that hold any of"),
    ],
)
def test_a_yaml_is_cured_by_what_is_wrong_with_it(tmp_path, text, remedy):
    path = tmp_path / "measurement.yaml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        load_measurement(path)
    assert remedy in caught.value.problems[0].remedy


def test_a_missing_file_names_the_one_beside_it(bench):
    bench.write_csv()
    bench.record["file"] = "run1.csv"
    problem = bench.only_problem(write=False)
    assert "did you mean 'run_1.csv'?" in problem
    assert f"relative to {bench.folder}" in problem
    bench.record["file"] = "elsewhere.mat"
    assert "did you mean" not in bench.only_problem(write=False)


def _at_a_rate(bench, kilohertz: float, header: str = "time [s]") -> list[str]:
    bench.columns = {header: bench.columns["t"], **{k: v for k, v in bench.columns.items() if k != "t"}}
    bench.write_csv()
    bench.channels.pop("time", None)
    bench.record["sampling_rate"] = {"value": kilohertz, "unit": "kHz"}
    return [finding.kind for finding in bench.load().findings]


def test_a_rate_that_the_stamps_of_the_file_contradict_is_said(bench):
    assert "rate_conflict" in _at_a_rate(bench, 10.0)
    (found,) = [finding for finding in bench.load().findings if finding.kind == "rate_conflict"]
    assert "'time [s]' run at 20000 Hz and sampling_rate says 10000 Hz" in found.message
    assert found.severity == "note"


@pytest.mark.parametrize(("header", "factor"), [("millis", 1e3), ("t_us", 1e6), ("time_s", 1.0)])
def test_so_is_one_that_a_clock_named_by_its_unit_contradicts(bench, header, factor):
    """A logger that lost samples, whose rows are taken as even."""
    kept = np.arange(bench.columns["t"].size) % 25 != 7
    bench.columns = {name: values[kept] for name, values in bench.columns.items()}
    bench.columns["t"] = bench.columns["t"] * factor
    assert "rate_conflict" in _at_a_rate(bench, 20.0, header)


_SILENT = [(20.0, "time [s]"), (20.0, "time_s"), (20.1, "time [s]"), (10.0, "t"), (10.0, "x [m]")]  # kHz and header


@pytest.mark.parametrize(("kilohertz", "header"), _SILENT)
def test_a_rate_that_nothing_contradicts_is_silent(bench, kilohertz, header):
    assert "rate_conflict" not in _at_a_rate(bench, kilohertz, header)


def oscillator_of(lines, tmp_path, column="x"):
    """The problems with a declaration of a text table."""
    (tmp_path / "run.csv").write_text("\n".join(lines) + "\n")
    record = (
        "system: oscillator\nrecords:\n  - file: run.csv\n    channels:\n"
        f"      time: {{column: t, unit: s}}\n      displacement: {{column: {column}, unit: m}}\n"
    )
    (tmp_path / "measurement.yaml").write_text(record)
    with pytest.raises(InputError) as caught:
        load_measurement(tmp_path / "measurement.yaml")
    return [str(problem) for problem in caught.value.problems]


def test_rows_in_another_order_are_to_be_sorted_and_a_stumble_is_to_be_left_out(tmp_path):
    times = [0.01 * k for k in range(60)]
    shuffled = [*times[::2], *reversed(times[1::2])]
    rows = [f"{t:.4f},{t * t:.6f}" for t in shuffled]
    assert "remedy: sort the rows by time" in oscillator_of(["t,x", *rows], tmp_path)[0]
    rows = [f"{t:.4f},{t * t:.6f}" for t in (*times[:30], 0.2, *times[30:])]
    assert "remedy: leave those rows out" in oscillator_of(["t,x", *rows], tmp_path)[0]


def test_an_empty_column_is_named_once_with_those_that_hold_numbers(tmp_path):
    problems = oscillator_of(["t,blank,x", *(f"{0.01 * k:.3f},,{k * k}" for k in range(60))], tmp_path, "blank")
    assert len(problems) == 1
    assert "all of its cells are empty" in problems[0]
    assert "name another column: t, x" in problems[0]


def _runs_beside_each_other(tmp_path, columns, rows="", is_text=False):
    """A measurement of a table whose columns t and x hold so many numbers, and then nothing."""
    times, values = columns
    table = [(0.01 * k if k < times else None, k * k if k < values else None, k) for k in range(200)]
    table = [("t", "x", "longer"), *table]
    if is_text:
        lines = (",".join("" if cell is None else str(cell) for cell in row) for row in table)
        (tmp_path / "run.csv").write_text("\n".join(lines) + "\n")
    else:
        book = pytest.importorskip("openpyxl").Workbook()
        for row in table:
            book.active.append(row)
        book.save(tmp_path / "run.xlsx")
    record = (
        f"system: oscillator\nrecords:\n  - file: run.{'csv' if is_text else 'xlsx'}\n{rows}    channels:\n"
        "      time: {column: t, unit: s}\n      displacement: {column: x, unit: m}\n"
    )
    (tmp_path / "measurement.yaml").write_text(record)
    return tmp_path / "measurement.yaml"


@pytest.mark.parametrize(("missing", "is_last_cell"), [(1, True), (100, False)])
def test_a_column_that_ends_early_ends_the_slice_or_is_a_channel_of_its_own(tmp_path, missing, is_last_cell):
    path = _runs_beside_each_other(tmp_path, (200, 200 - missing), "    slice: [0, 200]\n")
    with pytest.raises(InputError, match="give the channel its own time") as caught:
        load_measurement(path)
    assert ("end the slice at 199, or" in str(caught.value)) == is_last_cell


@pytest.mark.parametrize("is_text", [True, False])
@pytest.mark.parametrize("columns", [(150, 150), (150, 149)])  # the last stamp may stand alone
def test_a_run_beside_a_longer_one_ends_where_its_columns_do(tmp_path, columns, is_text):
    (record,) = load_measurement(_runs_beside_each_other(tmp_path, columns, is_text=is_text)).records
    assert record.time.size == columns[1]
    blank = 200 - columns[1] if is_text else 150 - columns[1]  # a sheet's columns end where their cells do
    said = f"the last {blank} rows hold nothing in the columns of the record, which ends before them"
    assert [found.message for found in record.findings if found.kind == "blank_rows"] == [said] * bool(blank)


@pytest.mark.parametrize("end", [1.2, 1.49])
def test_blank_rows_behind_a_window_are_not_those_of_the_record(tmp_path, end):
    rows = f"    window: {{from: 0.2, to: {end}, unit: s}}\n"
    (record,) = load_measurement(_runs_beside_each_other(tmp_path, (150, 149), rows, is_text=True)).records
    assert "blank_rows" not in {found.kind for found in record.findings}
    assert [record.time[0], record.time[-1]] == pytest.approx([0.2, end - 0.01])


def test_stamps_that_go_on_alone_are_no_end_of_a_run(tmp_path):
    with pytest.raises(InputError, match="give the channel its own time"):
        load_measurement(_runs_beside_each_other(tmp_path, (200, 100)))


def test_a_problem_of_a_record_with_a_name_says_it(bench):
    bench.record["name"] = "up_800"
    bench.record["conditions"] = {"pinion_speed": {"value": 1200, "unit": "rpmm"}}
    assert "record 'up_800'" in bench.only_problem()
    del bench.record["name"]
    assert "record '" not in bench.only_problem()


@pytest.mark.parametrize(("rows", "remedy"), [(5, "use a longer file"), (20, "use a longer slice, window or file")])
def test_a_file_that_is_too_short_as_a_whole_has_no_better_column(tmp_path, rows, remedy):
    lines = ["t,x", *(f"{0.01 * k:.3f},{k * k}" for k in range(rows))]
    (tmp_path / "run.csv").write_text("\n".join(lines) + "\n")
    record = (
        "system: oscillator\nrecords:\n  - file: run.csv\n    slice: [0, 5]\n    channels:\n"
        "      time: {column: t, unit: s}\n      displacement: {column: x, unit: m}\n"
    )
    (tmp_path / "measurement.yaml").write_text(record)
    with pytest.raises(InputError) as caught:
        load_measurement(tmp_path / "measurement.yaml")
    assert caught.value.problems[0].remedy == remedy


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        (
            "pinion_speed",
            1100,
            "write pinion_speed: {value: 1100, unit: rpm}, or pinion_speed: 1100 rpm, or 1100 rad/s",
        ),
        ("inertia_pinion", "1,2e-3 kg*m^2", "a decimal point, not a comma: inertia_pinion: 1.2e-3 kg*m^2"),
        ("pinion_speed", "1,100 rpm", "pinion_speed: 1100 rpm, without a sign between thousands, or 1.100 rpm with"),
        ("pinion_speed", "1 100 rpm", "write pinion_speed: 1100 rpm, without a sign between thousands"),
        ("pinion_speed", "1/200 s", "write pinion_speed: {value: …, unit: rad/s}"),
        ("pinion_speed", "1100", "write pinion_speed: {value: 1100, unit: rad/s}"),
    ],
)
def test_no_one_unit_is_offered_for_a_bare_number(key, value, said):
    unit = {"pinion_speed": "rad/s", "inertia_pinion": "kg*m^2"}[key]
    with pytest.raises(InputError, match=re.escape(said)):
        Measured(unit).read(value, key)


def test_a_rate_below_one_may_be_the_time_of_a_sample():
    with pytest.raises(InputError, match=r"0.001 Hz, or 0.001 s from one sample to the next, whichever it is in"):
        Rate().read(0.001, "sampling_rate")


@pytest.mark.parametrize("unit", ["kpm", "Nms2", "trad"])
def test_no_unit_is_meant_by_one_that_begins_otherwise(unit):
    with pytest.raises(InputError, match="choose one of"):
        parse_unit(unit)


def test_what_yaml_takes_for_a_truth_value_is_to_be_put_in_quotes():
    with pytest.raises(InputError, match="put the header text in quotes"):
        Column().read(False, "column")


@pytest.mark.parametrize(("word", "said"), [("sensitivity", "write gain"), ("offset", "datum: arbitrary")])
def test_other_words_for_the_scale_of_a_channel_lead_to_its_key(bench, word, said):
    bench.channels["transmission_error"][word] = 2.0
    assert said in bench.only_problem()


@pytest.mark.parametrize(
    ("place", "key", "value", "remedy"),
    [
        ((), "parameters", {"contact_ratio": 1.5}, "write them beside records"),
        (("channels",), "tacho", {"column": "te"}, "it is a key of encoders, which stands beside channels"),
        (("channels",), "gear_angle", {"column": "te", "unit": "deg"}, "counts_per_revolution: 360}} beside channels"),
        (("channels",), "acceleration_2", {"column": "te"}, "there is one 'acceleration' and no second"),
        (("encoders", "pinion"), "cpr", 1024, "write counts_per_revolution"),
        (("encoders", "tacho"), "ppr", 60, "write pulses_per_revolution"),
    ],
)
def test_a_key_in_the_wrong_place_or_by_another_name_is_told_where_and_how(bench, place, key, value, remedy):
    at = bench.record
    for part in place:
        at = at.setdefault(part, {})
    at[key] = value
    (said,) = [one for one in bench.problems() if one.startswith(".".join(("records[0]", *place, key)) + ":")]
    assert remedy in said


def test_a_sensitivity_with_its_unit_is_answered_with_the_gain_and_a_quoted_sign_is_taken(bench):
    channel = bench.record["channels"]["transmission_error"]
    channel |= {"polarity": "-1", "gain": "100 mV/g"}
    assert "write unit: g, and gain: 100 where the column is in mV, 0.1 where it is in V" in bench.only_problem()
    channel["gain"] = 2.0
    assert bench.load().records[0].channels["transmission_error"].polarity == -1


@pytest.mark.parametrize("given", ["inertia_pinion", "inertia_gear"])
def test_one_inertia_of_a_pair_needs_the_other(bench, given):
    bench.content["parameters"][given] = {"value": 0.01, "unit": "kg*m^2"}
    missing = {"inertia_pinion": "inertia_gear", "inertia_gear": "inertia_pinion"}[given]
    said = bench.only_problem()
    assert f"parameters.{missing}: is missing beside {given}; remedy: give it too" in said
    bench.content["parameters"][missing] = {"value": 0.02, "unit": "kg*m^2"}
    assert bench.load().parameters[missing].value == pytest.approx(0.02)


@pytest.mark.parametrize("written", [3, {"value": 3}, {"value": 3.0, "uncertainty": 0.1}])
def test_a_bare_damping_ratio_above_one_is_asked_whether_it_is_in_per_cent(bench, written):
    bench.content["parameters"]["damping_ratio"] = written
    assert "means 300 %; remedy: write damping_ratio: 3 %, or 300 % where" in bench.only_problem()
    for text, value in (("3 %", 0.03), ("300 %", 3.0), (0.03, 0.03), ({"value": 3, "unit": "%"}, 0.03)):
        bench.content["parameters"]["damping_ratio"] = text
        assert bench.load().parameters["damping_ratio"].value == pytest.approx(value)


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("mounting", "tells accelerometers of a gear_pair on a shaft from those on a casing"),
        ("timing_error", "is that of the angle of a gear_pair; remedy: write delay"),
        (None, "it cuts all records: write it beside records, at the top of the file"),
    ],
)
def test_keys_that_have_a_meaning_elsewhere_say_where(key, said, tmp_path):
    inside, below = (f", {key}: 1 ms", "") if key else ("", "    segments: 1 s\n")
    path = tmp_path / "m.yaml"
    path.write_text(
        "system: oscillator\nrecords:\n  - file: a.csv\n    channels:\n      sampling_rate: 50 Hz\n"
        f"      displacement: {{column: x, unit: mm{inside}}}\n{below}"
    )
    with pytest.raises(InputError) as caught:
        load_measurement(path)
    assert said in str(caught.value)


def test_small_files_beyond_a_smaller_limit_are_told_to_the_byte(bench):
    bench.load()
    with pytest.raises(InputError, match=r"0\.0\d+ MB are more than the 0\.000010 MB"):
        load_measurement(bench.folder / "measurement.yaml", max_bytes=10)


@pytest.mark.parametrize(
    ("written", "unit"),
    [("RAD", "rad"), ("º", "deg"), ("秒", "s"), ("㎜", "mm"), ("sek", "s"), ("secondes", "s"), ("㎳", "ms")],
)
def test_units_in_the_letters_of_other_countries_are_read(written, unit):
    assert parse_unit(written) == parse_unit(unit)


@pytest.mark.parametrize("place", ["parameter", "channel"])
def test_a_bare_uncertainty_above_one_is_asked_whether_it_is_in_per_cent(bench, place):
    at = bench.record["channels"]["transmission_error"]
    if place == "parameter":
        at = bench.content["parameters"]["torque_gain"] = {"value": 1.0}
    at["uncertainty"] = 2
    said = "uncertainty: is relative, and means 200 %; remedy: write uncertainty: 2 % (or 0.02), or 200 % where it is"
    assert said in bench.only_problem().replace(" = 2", "")
    for text, value in (("2 %", 0.02), ("200 %", 2.0), (0.02, 0.02), (1, 1.0), ({"value": 2, "unit": "%"}, 0.02)):
        at["uncertainty"] = text
        loaded = bench.load()
        held = loaded.records[0].channels["transmission_error"] if place == "channel" else None
        assert (held or loaded.parameters["torque_gain"]).uncertainty == pytest.approx(value)


def test_a_file_in_other_capitals_is_offered(tmp_path):
    (tmp_path / "Run.csv").write_text("t,x\n")
    (tmp_path / "measurement.yaml").write_text("system: oscillator\nrecords:\n- file: RUN.CSV\n")
    with pytest.raises(InputError, match=r"did you mean 'Run\.csv'"):
        load_measurement(tmp_path / "measurement.yaml")


@pytest.mark.parametrize(("word", "said"), [("temperature", "as a comment"), ("load", "write force")])
def test_words_of_conditions_of_an_oscillator_are_answered(tmp_path, word, said):
    (tmp_path / "run.csv").write_text("t,x\n" + "".join(f"{k / 100},{k % 7}\n" for k in range(50)))
    (tmp_path / "measurement.yaml").write_text(
        f"system: oscillator\nrecords:\n- file: run.csv\n  conditions: {{{word}: 3 N}}\n"
        "  channels: {time: {column: t, unit: s}, displacement: {column: x, unit: m}}\n"
    )
    with pytest.raises(InputError, match=said):
        load_measurement(tmp_path / "measurement.yaml")
