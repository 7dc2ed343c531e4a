"""Stamps of a few significant digits, rows that a recorder stored again, and rows that end in a sign of their own."""

import numpy as np
import pytest

from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.formats.stated_rate import stated_rate
from gear_damping.measurement.formats.table import Table
from gear_damping.measurement.timebase import stamped_time

MAX_BYTES = 10**8


def significant(values, digits):
    return np.array([float(f"{value:.{digits - 1}e}") for value in values])


@pytest.mark.parametrize(
    ("rate", "start", "digits"),
    [
        (30.0, 0.0, 3),
        (25.0, 0.2, 3),
        (1 / 0.0123, 0.0, 3),
        (240.0, 0.5, 4),
        (1 / 0.00192012, -1.2, 4),  # a trigger in the middle, as an oscilloscope writes it
    ],
)
def test_stamps_of_a_few_significant_digits_stand_for_an_even_grid(rate, start, digits):
    time = start + np.arange(900) / rate
    base = stamped_time(significant(time, digits), "t", "a.csv")
    assert base.uniform
    assert base.sampling_rate == pytest.approx(rate, rel=1e-5)
    np.testing.assert_allclose(base.time, time, atol=0.02 / rate)
    assert f"{digits} significant digits" in base.notes[0]


def test_a_clock_that_jitters_is_no_grid_for_all_its_few_digits():
    steps = (1 + 0.3 * np.random.default_rng(0).standard_normal(900)).clip(0.2) / 30
    with pytest.raises(ValueError, match="repeated time stamp"):
        stamped_time(significant(np.cumsum(steps), 3), "t", "a.csv")


@pytest.mark.parametrize("at", [0.0, 2.5])
def test_a_clock_that_stands_is_refused(at):
    with pytest.raises(ValueError, match="49 repeated time stamp"):
        stamped_time(np.full(50, at), "t", "a.csv")


def test_beside_rows_stored_again_a_column_that_cannot_be_read_is_said_once(bench):
    table = phone()
    table[200] = table[199]
    declared(bench, table).content["records"][0]["channels"]["force"] = {"column": "no such", "unit": "N"}
    assert "no such" in bench.only_problem(write=False)


def phone(rows=400):
    """Stamps in s and two signals, of which no two rows are alike."""
    time = 0.0062290 + np.arange(rows) / 100
    return np.stack([time, np.sin(7 * time), np.cos(5 * time) * np.exp(-time / 9)], 1)


def declared(bench, table):
    np.savetxt(bench.folder / "phone.csv", table, delimiter=",", header="t,x,y", comments="", fmt="%.10g")
    bench.content["system"] = "oscillator"
    bench.content.pop("parameters", None)
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "m"}}
    bench.content["records"] = [{"file": "phone.csv", "channels": channels}]
    return bench


@pytest.mark.parametrize(
    ("row", "holds", "left_out"),
    [
        (200, lambda t: np.r_[t[198, 0], t[197, 1:]], 200),  # as if it were an older one
        (200, lambda t: np.r_[t[201, 0], t[199, 1:]], 200),  # the last one once more, its stamp that of the next
        (200, lambda t: t[199], 200),
    ],
    ids=["an older stamp", "the stamp of the next", "all the same"],
)
def test_a_row_that_is_stored_again_is_left_out_and_said(bench, row, holds, left_out):
    table = phone()
    clean = table.copy()
    table[row] = holds(table)
    loaded = declared(bench, table).load_as_it_is()
    (record,) = loaded.records
    (found,) = [finding for finding in record.findings if finding.kind == "doubled_rows"]
    assert found.severity == "note"
    assert f"row {left_out} of the file" in found.message
    np.testing.assert_allclose(record.channels["displacement"].values, np.delete(clean[:, 1], left_out), atol=1e-9)


def test_stamps_that_do_not_go_on_beside_new_values_are_refused(bench):
    table = phone()
    table[200, 0] = table[199, 0]
    assert "1 repeated time stamp(s), the first at sample 200" in declared(bench, table).only_problem(write=False)


def read(tmp_path, text) -> Table:
    (tmp_path / "a.csv").write_text(text)
    return read_table(tmp_path / "a.csv", MAX_BYTES)


def test_rows_may_end_in_another_sign_below_names_that_stand_as_comments(tmp_path):
    head = "%Motor data\n%Timestep increments at 8kHz\n\n%timestep (8Hz),voltage,position\n%[#],[V],[turns]\n"
    rows = "".join(f"{44 * k}.0,{0.1 * (k % 7):.4f},{113 + 0.01 * (k % 5):.6f};\n" for k in range(40))
    table = read(tmp_path, head + rows)
    assert table.names == ("timestep (8Hz)", "voltage", "position")
    assert [table.unit(k) for k in (1, 2)] == ["V", "turns"]
    np.testing.assert_allclose(table.values(0), 44.0 * np.arange(40))


@pytest.mark.parametrize(("said", "rate"), [("%Timestep increments at 8kHz", 8000.0), ("time step: 8 ms", 125.0)])
def test_steps_at_a_frequency_are_no_steps_of_its_size(said, rate):
    assert stated_rate([[said]])[1] == rate


@pytest.mark.parametrize("sign", [";", "|"])
def test_any_sign_may_end_a_row(tmp_path, sign):
    table = read(tmp_path, f"x,y{sign}\n" + "".join(f"{k}.5,{k % 7}.25{sign}\n" for k in range(40)))
    np.testing.assert_allclose(table.values(0), np.arange(40) + 0.5)
    np.testing.assert_allclose(table.values(1), np.arange(40) % 7 + 0.25)


def test_one_column_of_decimal_commas_ends_in_its_sign_too(tmp_path):
    table = read(tmp_path, "x\n" + "".join(f"{k},{k % 10};\n" for k in range(40)))
    np.testing.assert_allclose(table.values(0), [float(f"{k}.{k % 10}") for k in range(40)])


@pytest.mark.parametrize("times", [2, 3])
def test_rows_that_are_all_stored_again_are_left_out_and_said(bench, times):
    clean = phone()
    (record,) = declared(bench, np.repeat(clean, times, 0)).load_as_it_is().records
    (found,) = [finding for finding in record.findings if finding.kind == "doubled_rows"]
    assert (found.severity, found.message.partition(" ")[0]) == ("note", str((times - 1) * len(clean)))
    np.testing.assert_allclose(record.channels["displacement"].values, clean[:, 1], atol=1e-9)
    assert record.sampling_rate == pytest.approx(100, rel=1e-6)


def test_new_values_at_shared_stamps_are_not_left_out(bench):
    table = phone(800)
    table[:, 0] = np.arange(800) // 2 * 0.01
    (record,) = declared(bench, table).load_as_it_is().records
    assert record.time.size == 800
