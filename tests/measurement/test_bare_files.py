"""What a bare file is taken for where names mislead: switched currents, row numbers, set values, a camera's stamps."""

import numpy as np
import pytest

from gear_damping.measurement.column_kinds import COUNTER, PULSES, ROW_NUMBER, SIGNAL
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.guessing import guessed, guesses
from gear_damping.measurement.inspection import inspect_table
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.starting_yaml import starting_yaml
from gear_damping.tasks.inspect import _column_lines, _panels
from tests.measurement.bare import column, inspected

N = 6000
T = np.arange(N) / 1000.0
RNG = np.random.default_rng


def test_a_switched_current_is_no_pulse_train(tmp_path):
    rng = RNG(5)
    switched = np.where(rng.random(N) < 0.6, 0.023, 0.0)
    switched[7:-7:40] = 0.023  # where it is on, it is now and then on for a part of the time
    switched[8:-7:40] = np.round(rng.uniform(0.005, 0.018, switched[8:-7:40].size), 5)
    switched[9:-7:40] = 0.023
    found = inspected(tmp_path, time=T, i=switched, tacho=5.0 * (np.mod(31 * T, 1) < 0.3))
    assert column(found, "i").kind == SIGNAL
    assert column(found, "tacho").kind == PULSES


def test_a_number_of_rows_is_no_counter(tmp_path):
    found = inspected(tmp_path, time=T, n=np.arange(N) + 1.0, count=np.round(700 * T), x=np.sin(9 * T))
    assert (column(found, "n").kind, column(found, "n").says) == (ROW_NUMBER, "counts the rows from 1 on")
    assert column(found, "count").kind == COUNTER
    assert [one.reference for one in found.measured] == ["count", "x"]


def test_a_set_value_beside_what_was_measured_is_none_by_its_name(tmp_path):
    settled = np.concatenate([np.full(1500, 5.0), np.full(1500, -5.0)] * 2)
    moving = 5 * np.sin(2 * np.pi * 1.3 * T) + RNG(3).normal(size=N)
    guess = {
        one.column.reference: one for one in guesses(inspected(tmp_path, t=T, xr=settled, x_m=moving), "oscillator")
    }
    assert (guess["xr"].channel, guess["x_m"].channel) == (None, "displacement")
    assert "a set value beside 'x_m'" in guess["xr"].why
    alone = guesses(inspected(tmp_path, t=T, x=settled), "oscillator")
    assert [one.channel for one in alone] == ["displacement"]


def _camera(folder, name, times, text="{time:.3f}\t{x:.6f}"):
    rows = [text.format(time=time, x=0.3 * np.cos(5 * time)) for time in times]
    (folder / "swing.txt").write_text("\n".join([f"{name}\ty", *rows]) + "\n")
    return inspect_table(read_table(folder / "swing.txt"))


@pytest.mark.parametrize("rate", [29.97, 59.94])
def test_stamps_of_a_camera_need_no_name(tmp_path, rate):
    found = _camera(tmp_path, "x", np.delete(np.arange(900) / rate, 450))  # of which one frame is lost
    assert found.time.says == "is the first column and rises in nearly even steps"
    assert (found.time.index, found.time.unit, bool(found.time.guessed)) == (0, "s", True)
    assert found.rate == pytest.approx(rate, rel=1e-3)


@pytest.mark.parametrize(("off", "says"), [(0, "advances evenly"), (0.1, "rises in nearly even steps")])
def test_a_first_column_of_stamps_is_said_to_be_as_even_as_it_is(tmp_path, off, says):
    stamps = T + off / 1000 * RNG(2).uniform(-0.5, 0.5, N)
    assert _logged(tmp_path, stamps[:999], np.sin(9 * T)[:999]).time.says == f"is the first column and {says}"


@pytest.mark.parametrize("name", ["Tempo", "tempo_s", "czas"])
def test_time_is_known_by_its_name_in_other_languages(tmp_path, name):
    assert _camera(tmp_path, name, np.arange(300) / 30).time.says == "advances and is named like a time"


def _logged(folder, *columns):
    """A log without a header."""
    rows = (" ".join(f"{value:.9g}" for value in row) for row in zip(*columns, strict=True))
    (folder / "log.txt").write_text("\n".join(rows) + "\n")
    return inspect_table(read_table(folder / "log.txt"))


def test_stamps_without_a_name_in_any_column_go_on_by_one_whole_number(tmp_path):
    count = np.arange(400)
    falling, stamps = 900 * np.exp(-count / 150), 21527 + 20 * count + 20 * (count > 300)  # of which one row is lost
    found = _logged(tmp_path, falling, stamps)
    assert found.time.says == "goes on by the same whole number in nearly all rows"
    assert (found.time.index, found.time.unit, bool(found.time.guessed)) == (1, "ms", True)
    assert found.rate == pytest.approx(50, rel=0.01)
    turning = np.round(np.cumsum(20 + 3 * np.sin(count / 9)))  # counts of a shaft
    assert _logged(tmp_path, falling, turning).time is None
    assert _logged(tmp_path, falling, stamps, stamps).time is None  # either


def test_what_rises_evenly_and_may_be_something_else_is_no_time(tmp_path):
    times = np.arange(300) / 30
    for name, values in (("theta", 3 * times), ("speed", 7 * times), ("x", np.round(100 * times)), ("x", times % 5)):
        assert _camera(tmp_path, name, values).time is None, name
    np.savez(tmp_path / "b.npz", x=times + 0.1, y=np.cos(times), fs=np.array([30.0]))  # which says its rate itself
    assert inspect_table(read_table(tmp_path / "b.npz")).time is None


def test_a_still_sensor_about_the_edge_of_a_count_is_no_pulse_train(tmp_path):
    flickering = np.where(RNG(8).random(N) < 0.2, 0.02, 0.01)
    turns = np.mod(12 * T + 4 * T**2, 1) < 0.1  # a shaft that runs up
    found = inspected(tmp_path, time=T, u=flickering, tach=1.0 * turns)
    assert column(found, "u").kind == SIGNAL
    assert column(found, "tach").kind == PULSES


def test_whole_milliseconds_of_a_loop_that_waits_are_the_time(tmp_path):
    stamps = 281 + np.cumsum(RNG(9).choice([2, 3, 4], 400, p=[0.55, 0.4, 0.05]))
    rows = "\n".join(f"{stamp},{x}" for stamp, x in zip(stamps, np.round(100 * np.cos(0.05 * stamps)), strict=True))
    (tmp_path / "loop.csv").write_text(rows + "\n")
    found = inspect_table(read_table(tmp_path / "loop.csv"))
    assert found.time is not None
    assert (found.time.index, found.time.unit) == (0, "ms")


def _two_clocks(folder, names):
    """A force at 100 Hz and, beside it, half as many rows of a displacement at 50 Hz that swings at 1.5 Hz."""
    fast, slow = np.arange(1200) / 100, np.arange(600) / 50
    x = np.round(np.cos(3 * np.pi * slow) + 0.001 * RNG(10).normal(size=600), 5)
    slower = [f"{t:.2f},{value}" for t, value in zip(slow, x, strict=True)] + [","] * 600
    rows = (f"{t:.2f},{np.sin(9 * t):.5f},{other}" for t, other in zip(fast, slower, strict=True))
    (folder / "two.csv").write_text("\n".join([names, *rows]) + "\n")
    return guessed(read_table(folder / "two.csv"))


def test_a_channel_with_a_clock_of_its_own_beside_it_is_declared_with_that(tmp_path):
    found, system, listed = _two_clocks(tmp_path, "Time [s],Force [N],Time 2 [s],Disp [mm]")
    assert found.rate == pytest.approx(100)
    text = starting_yaml(found, system, listed)
    assert 'displacement: {column: "Disp [mm]", unit: mm, time: {column: "Time 2 [s]", unit: s}}' in text
    swings = column(found, "Disp [mm]").spectrum
    assert swings.frequency[1 + np.argmax(swings.density[1:])] == pytest.approx(1.5, abs=0.1)
    drawn = {panel.name: panel.curves[0].time for panel in _panels(found, listed)}
    assert [np.nanmax(drawn[name]) for name in ("Force [N]", "Disp [mm]")] == pytest.approx([11.99, 11.98])
    declared = tmp_path / "measurement.yaml"
    declared.write_text(text)
    assert load_measurement(declared).records[0].sampling_rate == pytest.approx(100)


def test_the_clock_of_all_that_is_declared_is_that_of_the_record(tmp_path):
    found, system, listed = _two_clocks(tmp_path, "X[s],EMG 1,X[s].1,Disp [mm]")
    assert found.rate == pytest.approx(50)
    assert found.rows == (0, 600)
    assert 'time: {column: "X[s].1", unit: s}' in starting_yaml(found, system, listed)


@pytest.mark.parametrize("names", ["time [s],time function [s]", "time function [s],time [s]", "time [s],t_part [s]"])
def test_of_two_clocks_the_one_that_runs_through_is_that_of_the_record(names, tmp_path):
    """Beside one that starts again with each of six parts of a test, wherever it stands."""
    t = np.cumsum(0.004 + 0.001 * RNG(3).uniform(size=1200))
    parts = (t - t[0]) % 0.9 + 2e-3 * RNG(4).uniform(size=t.size)
    clocks = {"time [s]": t, names.replace("time [s]", "").strip(","): parts}
    table = [clocks[name] for name in names.split(",")] + [np.sin(9 * t)]
    lines = [",".join(f"{cell:.6f}" for cell in row) for row in zip(*table, strict=True)]
    (tmp_path / "parts.csv").write_text("\n".join([f"{names},a1 position [rad]", *lines]) + "\n")
    found, system, listed = guessed(read_table(tmp_path / "parts.csv"))
    assert (found.rows, found.taken) == ((0, 1200), "")
    assert found.base.time[-1] - found.base.time[0] == pytest.approx(t[-1] - t[0], rel=1e-4)
    text = starting_yaml(found, system, listed)
    assert 'time: {column: "time [s]", unit: s}\n' in text
    assert text.count("time: {") == 1


RUN_NAMES = [
    ("Run 1: Time (s)", "Run 1: Position (m)", "Run 1: Force (N)"),
    ("Latest: Time (s)", "Latest: Position (m)", "Latest: Force (N)"),
]


@pytest.mark.parametrize("shorter", [0, 1])
@pytest.mark.parametrize("sizes", [(1.0, 1.0), (3.0, 0.2), (0.2, 3.0)])
def test_of_two_runs_side_by_side_the_columns_of_one_are_declared(shorter, sizes, tmp_path):
    """At one rate, the other run longer; the position of the second stands out most, and the force by its size."""
    time, cells = np.arange(800) / 100, []
    for run, size in enumerate(sizes):
        noise = RNG(run).normal(size=(2, 800))
        x, force = 0.01 * (1 + run) * np.cos(19 * time) + 1e-4 * noise[0], size * np.sin(40 * time) + 0.01 * noise[1]
        own = [f"{t:.2f},{a:.6f},{b:.5f}" for t, a, b in zip(time, x, force, strict=True)]
        cells.append([*own[:500], *[",,"] * 300] if run == shorter else own)
    rows = [",".join(row) for row in zip(*cells, strict=True)]
    (tmp_path / "two.csv").write_text("\n".join([",".join([*RUN_NAMES[0], *RUN_NAMES[1]]), *rows]) + "\n")
    found, system, listed = guessed(read_table(tmp_path / "two.csv"))
    names = [str(guess.column.reference) for guess in listed if guess.used]
    names.append(str(found.columns[found.time.index].reference))
    run = [{*one} for one in RUN_NAMES].index({*names})
    declared = tmp_path / "measurement.yaml"
    declared.write_text(starting_yaml(found, system, listed))
    assert load_measurement(declared).records[0].time.size == (500 if run == shorter else 800)


def test_a_steady_shaft_beside_stamps_is_no_other_clock(tmp_path):
    """Neither a name nor a unit says that it is one, however evenly it goes on."""
    found = _logged(tmp_path, 5 * np.arange(400), 3 * np.arange(400), np.round(900 * np.sin(np.arange(400) / 9)))
    assert found.time.index == 0
    assert [one.kind for one in found.columns[1:]] == [COUNTER, SIGNAL]


@pytest.mark.parametrize(("unit", "one"), [("s", 1.0), ("ms", 1e-3), ("us", 1e-6)])
@pytest.mark.parametrize("backward", [0, 1, 3])
def test_a_column_that_counts_from_1970_is_the_clock_though_some_stamps_go_back(tmp_path, unit, one, backward):
    stamps = 1544018294.436 + np.arange(400) / 20 + RNG(1).uniform(-2e-3, 2e-3, 400)
    stamps[[90, 200, 310][:backward]] -= 0.095
    values = np.column_stack([np.exp(-np.arange(400) / 90), np.round(stamps / one, 3 if unit == "s" else 0)])
    np.savetxt(tmp_path / "run.csv", values, "%.17g", ";")
    found = inspect_table(read_table(tmp_path / "run.csv"))
    assert (found.time.index, found.time.unit) == (1, unit)
    assert found.rate == pytest.approx(20, rel=2e-3)
    assert [fault.partition(",")[0] for fault in found.faults] == [f"{backward} backward time stamp(s)"] * (
        backward > 0
    )


@pytest.mark.parametrize(("name", "first"), [("n", 1.5e7), ("n", 1.5e11), ("angle", 1.544e12)])
def test_other_large_numbers_that_advance_are_no_clock(tmp_path, name, first):
    steps = 50 + np.round(9 * np.sin(np.arange(N) / 70))
    found = inspected(tmp_path, x=np.sin(9 * T), **{name: first + np.cumsum(steps)})
    assert found.time is None
    assert column(found, name).kind == COUNTER


@pytest.mark.parametrize("kind", ["pulse", "step", "blow"])
@pytest.mark.parametrize("noise", [0.0, 0.003])
def test_what_rests_while_another_column_rings_drives_it(tmp_path, kind, noise):
    put_in = {"pulse": 5.0 * (np.arange(N) == 40), "step": 5.0 * (np.arange(N) > 40)}
    put_in["blow"] = 5.0 * np.clip(np.sin((np.arange(N) - 40) / 3), 0, None) * (np.abs(np.arange(N) - 44) < 6)
    late = np.clip(np.arange(N) - 40, 0, None)
    rings = np.exp(-late / 900) * np.sin(late / 9)
    noisy = {name: values + noise * RNG(2).normal(size=N) for name, values in (("V_S", put_in[kind]), ("V_C", rings))}
    guess = {one.column.reference: one for one in guesses(inspected(tmp_path, time=T, **noisy), "oscillator")}
    assert (guess["V_S"].channel, guess["V_C"].channel) == ("force", "displacement")
    assert guess["V_S"].why == "rests but for jumps where 'V_C' moves on: an input?"


def test_of_two_columns_that_both_move_on_the_faster_one_may_drive(tmp_path):
    found = inspected(tmp_path, time=T, a1=np.sin(9 * T), b1=np.sin(60 * T))
    assert {one.column.reference: one.channel for one in guesses(found, "oscillator")} == {
        "a1": "displacement",
        "b1": "force",
    }


@pytest.mark.parametrize(("columns", "shown"), [(100, 100), (150, 20)])
def test_of_very_many_columns_the_first_ones_are_listed(tmp_path, columns, shown):
    values = RNG(0).normal(size=(60, columns))
    found = inspected(tmp_path, **{f"c{k}": values[:, k] for k in range(columns)})
    lines = list(_column_lines(found, []))
    assert sum(line.startswith("column ") for line in lines) == shown
    assert (f"and {columns - shown} columns more, which inspection.json lists" in lines) is (columns > shown)


@pytest.mark.parametrize(("name", "unit"), [("ms", "ms"), ("us", "us"), ("msec", "ms"), ("sec", "s"), ("tick", "ms")])
def test_a_column_that_is_named_as_a_unit_of_time_or_as_ticks_is_the_clock(name, unit, tmp_path):
    found = inspected(tmp_path, **{"x": np.sin(9 * T), name: 5.0 * np.arange(N)})
    assert (found.columns[found.time.index].reference, found.time.unit) == (name, unit)


def test_a_tick_that_was_rounded_is_a_clock(tmp_path):
    found = inspected(tmp_path, x=np.sin(9 * T), HAL_tick=np.round(5.03 * np.arange(N)))
    assert found.columns[found.time.index].reference == "HAL_tick"


def test_ticks_that_are_not_even_are_of_an_encoder(tmp_path):
    found = inspected(tmp_path, x=np.sin(9 * T), ticks=np.round(700 * T + np.sin(3 * T)))
    assert found.time is None
    assert column(found, "ticks").kind == COUNTER


def test_a_column_named_after_a_pinion_is_of_a_gear_pair(tmp_path):
    path = tmp_path / "lauf.csv"
    columns = np.column_stack([T, 40 + RNG(4).normal(size=N), 3 * np.sin(90 * T) + RNG(5).normal(size=N)])
    np.savetxt(path, columns, delimiter=",", header="t [s],M_Ritzel [Nm],v_Ritzel [mm/s]", comments="")
    found, system, listed = guessed(read_table(path))
    assert system == ("gear_pair", "the name of column 'M_Ritzel [Nm]'")
    assert [one.channel for one in listed] == ["pinion_torque", "pinion_speed"]
    text = starting_yaml(found, system, listed)
    assert 'radius: {value: "???", unit: mm}' in text, "a speed in mm/s is one at a radius"


def test_what_is_named_a_tacho_is_of_a_gear_pair_and_a_relay_is_not(tmp_path):
    pulses, bent = 5.0 * (np.mod(31 * T, 1) < 0.3), 3e-6 * np.sin(900 * T)
    for name, system in (("Tacho [V]", "gear_pair"), ("relay [V]", "oscillator")):
        np.savez(tmp_path / "a.npz", **{"t [s]": T, "way [um]": bent, name: pulses})
        assert guessed(read_table(tmp_path / "a.npz"))[1][0] == system


def test_an_angular_acceleration_beside_a_counter_asks_for_its_shaft_and_the_torque(tmp_path):
    np.savez(tmp_path / "a.npz", **{"t [s]": T, "alpha [rad/s^2]": 900 * np.sin(900 * T), "count": np.round(7e5 * T)})
    text = starting_yaml(*guessed(read_table(tmp_path / "a.npz")))
    assert 'unit: "rad/s^2", mounting: tangential, shaft: "???"' in text.replace("unit: rad/s^2", 'unit: "rad/s^2"')
    assert "pinion_torque: {value: " in text
    assert "casing" not in text


def test_the_step_of_an_angle_that_falls_back_is_none_of_its_speed(tmp_path):
    angle = np.round((1753.7 * T + 0.5 * np.sin(40 * T)) % 360, 3)
    assert column(inspected(tmp_path, t=T, phi=angle), "phi").step == pytest.approx(1e-3, rel=0.01)
