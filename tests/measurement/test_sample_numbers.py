"""Numbers of frames and samples, and stamps in two parts, are no counters of a shaft."""

import numpy as np
import pytest

from gear_damping.measurement.column_kinds import COUNTER, ROW_NUMBER, kind_of
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.formats.stated_rate import stated_rate
from gear_damping.measurement.guessing import OSCILLATOR, guessed
from gear_damping.measurement.load import load_measurement

TIME = np.arange(600) / 100.0
MOTION = np.exp(-0.3 * TIME) * np.cos(9 * TIME)
BY_TWO = 2.0 * np.arange(300)


@pytest.mark.parametrize("name", ["frame", "Frame No.", "loggingSample(N)", "sample_number", "packet", "camera/frames"])
def test_names_of_samples_that_rise_by_one_step_number_them(name):
    assert kind_of(BY_TWO, name, "N" if "(N)" in name else None)[0] == ROW_NUMBER
    with_loss = np.delete(BY_TWO, [30, 40])
    assert kind_of(with_loss, name, None)[0] == ROW_NUMBER


@pytest.mark.parametrize("name", ["counter", "encoder", "framework", "n", "samplers"])
def test_other_names_may_be_counters_of_a_shaft(name):
    assert kind_of(BY_TWO, name, None)[0] == COUNTER


def test_a_name_of_samples_whose_steps_change_is_no_number_of_them():
    assert kind_of(np.cumsum(np.arange(300) % 7 + 3.0), "sample", None)[0] == COUNTER


def table_of(folder, names, *columns):
    rows = zip(*columns, strict=True)
    (folder / "a.csv").write_text(",".join(names) + "\n" + "".join(",".join(row) + "\n" for row in rows))
    return read_table(folder / "a.csv")


@pytest.mark.parametrize("name", ["frame", "loggingSample(N)"])
def test_a_phone_with_numbered_frames_is_no_gear_pair(tmp_path, name):
    motion = [f"{x:.5f}" for x in MOTION]
    _, system, listed = guessed(table_of(tmp_path, [name, "x"], [f"{2 * k}" for k in range(600)], motion))
    assert system[0] == OSCILLATOR
    assert [one.column.reference for one in listed if one.used] == ["x"]


def test_seconds_and_their_parts_are_a_clock_and_no_encoder(tmp_path):
    stamps = [730_000_000 + 10_000_000 * k for k in range(600)]
    names = ["header.stamp.sec", "header.stamp.nanosec", "position[0]"]
    seconds, parts = [f"{1_700_000_000 + s // 10**9}" for s in stamps], [f"{s % 10**9}" for s in stamps]
    found, system, listed = guessed(table_of(tmp_path, names, seconds, parts, [f"{x:.5f}" for x in MOTION]))
    assert system[0] == OSCILLATOR
    assert [one.column.reference for one in listed if one.used] == ["position[0]"]
    assert (found.rows, found.rate, found.taken) == ((0, 600), pytest.approx(100.0), "")
    (tmp_path / "m.yaml").write_text(
        "system: oscillator\nrecords:\n- file: a.csv\n  channels:\n"
        f"    time: {{column: {names[found.time.index]}, unit: {found.time.unit}}}\n"
        "    displacement: {column: 'position[0]', unit: rad}\n"
    )
    assert load_measurement(tmp_path / "m.yaml").records[0].sampling_rate == pytest.approx(100.0)


def test_a_setting_in_a_cell_of_its_own_among_names_states_the_rate():
    assert stated_rate([["CH1V", "CH2V", "t0 = -3.0e-01", "tInc = 5.0e-04", ""]]) == ("tInc", pytest.approx(2000.0))


def test_stamps_that_were_rounded_behind_numbers_of_rows_are_the_time(tmp_path):
    """An ECP drive writes the number of the sample, and seconds of three digits in steps of 8.854 ms."""
    rows = [f"{k} {0.008854 * k:.3f} {x:.4f}" for k, x in enumerate(MOTION)]
    (tmp_path / "a.txt").write_text("\n".join(rows) + "\n")
    found, _, listed = guessed(read_table(tmp_path / "a.txt"))
    assert (found.time.index, found.time.unit) == (1, "s")
    assert found.rate == pytest.approx(1 / 0.008854, rel=1e-3)
    assert [one.column.reference for one in listed if one.used] == [2]
