"""What an inspection says of columns that were made to be known."""

import h5py
import numpy as np
import openpyxl
import pytest
from scipy.io import savemat

from gear_damping.measurement.column_kinds import CONSTANT, COUNTER, PULSES, SIGNAL, TIME, TURNING
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.guessing import UNKNOWN, guessed, guesses, system_of
from gear_damping.measurement.inspection import inspect_table, of_columns
from gear_damping.measurement.spectral_floor import spectrum_of
from gear_damping.measurement.starting_yaml import starting_yaml
from tests.measurement.bare import column, inspected

RATE = 1000.0
N = 6000
T = np.arange(N) / RATE
RNG = np.random.default_rng


@pytest.mark.parametrize("n", [400, 6000, 50_000])
@pytest.mark.parametrize("sigma", [1e-4, 0.2])
def test_the_floor_of_the_spectrum_is_the_noise_below_a_strong_decay(n, sigma):
    time = np.arange(n) / RATE
    signal = 3 + time + np.exp(-0.2 * time) * np.cos(2 * np.pi * 13.3 * time)
    found = spectrum_of(signal + sigma * RNG(n).normal(size=n), RATE)
    assert found.noise == pytest.approx(sigma, rel=0.15)
    assert found.strongest == pytest.approx(13.3, abs=max(0.1, RATE / n))


@pytest.mark.parametrize("coasting", [np.exp(-T), (1 - T / 6) ** 2, np.maximum(1 - T / 4, 0), np.minimum(T, 1)])
def test_what_coasts_down_or_runs_up_is_strongest_nowhere(coasting):
    noise = 1e-3 * RNG(5).normal(size=N)
    assert spectrum_of(100 * coasting + noise, RATE).strongest is None
    assert spectrum_of(coasting + np.sin(2 * np.pi * 3 * T) + noise, RATE).strongest == pytest.approx(3, abs=0.2)


def test_noise_is_strongest_nowhere_and_a_tone_below_it_is_somewhere():
    time = np.arange(6000) / RATE
    named = [spectrum_of(RNG(seed).normal(size=6000), RATE).strongest for seed in range(40)]
    assert sum(name is not None for name in named) <= 2
    tone = 0.3 * np.sin(2 * np.pi * 13.3 * time)
    assert spectrum_of(tone + RNG(1).normal(size=6000), RATE).strongest == pytest.approx(13.3, abs=0.1)


@pytest.mark.parametrize("periods", [5.0, 5.3, 5.5, 5.8])
def test_the_strongest_line_lies_between_those_of_a_short_record(periods):
    time = np.arange(200) / RATE
    tone = np.sin(2 * np.pi * periods / time.size * RATE * time + 0.4)
    assert spectrum_of(tone, RATE).strongest == pytest.approx(periods * RATE / 200, abs=0.08 * RATE / 200)


def test_a_record_too_short_for_a_floor_has_none():
    assert spectrum_of(np.arange(63.0)) is None


def test_offset_step_and_constant_are_seen(tmp_path):
    wave = np.sin(2 * np.pi * 7 * T) + 5
    found = inspected(tmp_path, time=T, x=np.round(wave / 0.01) * 0.01, level=np.full(N, 3.0), y=wave)
    assert column(found, "x").step == pytest.approx(0.01, rel=1e-6)
    assert column(found, "x").inside.mean() == pytest.approx(5, abs=0.01)
    assert column(found, "y").step == 0
    assert (column(found, "level").kind, column(found, "time").kind) == (CONSTANT, TIME)
    assert [one.reference for one in found.measured] == ["x", "y"]


@pytest.mark.parametrize(("counts", "unit"), [(2000, 1.0), (2000, 0.18)])
def test_the_step_of_what_turns_by_many_with_every_sample_is_one_of_its_counter(counts, unit, tmp_path):
    turned = np.floor(counts * (3 * T + 0.002 * np.sin(40 * T)))
    assert column(inspected(tmp_path, time=T, x=unit * turned), "x").step == pytest.approx(unit, rel=1e-6)


def test_groups_with_members_of_the_same_names_are_records_of_their_own(tmp_path):
    with h5py.File(tmp_path / "campaign.h5", "w") as file:
        for group, rows in (("low", 900), ("high", 1000), ("up", 1000)):
            file.create_group(group).attrs["fs"] = 2000.0
            file[f"{group}/acc"] = np.sin(0.3 * np.arange(rows))
            file[f"{group}/volt"] = np.cos(0.3 * np.arange(rows))
    found = inspect_table(read_table(tmp_path / "campaign.h5"))
    assert {str(c.reference) for c in found.measured} == {"high/acc", "high/volt"}
    assert (found.length, found.rate) == (1000, pytest.approx(2000.0))
    text = starting_yaml(found, system_of(found), guesses(found, "oscillator"))
    assert "# further records: low/acc, low/volt, up/acc, up/volt" in text
    assert "guess: what the file calls fs" in text


def test_sheets_of_the_same_columns_are_records_of_their_own(tmp_path):
    """Of four sheets the draft took time and torque from one and the angle from another, which had as many rows."""
    book = openpyxl.Workbook()
    for place, (title, rows) in enumerate((("run-up", 900), ("steps", 700), ("steady", 700))):
        sheet = book.create_sheet(title, place)
        sheet.append(["t [s]", "x [mm]", "F [N]"])
        for k in range(rows):
            sheet.append([k / 1000, np.sin(0.3 * k + place), np.cos(0.3 * k)])
    del book["Sheet"]
    book.save(tmp_path / "runs.xlsx")
    found = inspect_table(read_table(tmp_path / "runs.xlsx"))
    names = {str(c.reference) for c in found.measured} | {str(found.columns[found.time.index].reference)}
    assert names == {"run-up/t [s]", "run-up/x [mm]", "run-up/F [N]"}
    text = starting_yaml(found, system_of(found), guesses(found, "oscillator"))
    assert '# further records: "steps/t [s]", "steps/x [mm]"' in text


def test_of_groups_with_rates_of_their_own_that_of_the_proposed_column_is_taken(tmp_path):
    with h5py.File(tmp_path / "campaign.h5", "w") as file:
        for group, rate in (("low", 500.0), ("high", 1000.0)):
            file.create_group(group).attrs["fs"] = rate
            file[f"{group}/acc"] = np.sin(0.3 * np.arange(900))
    found = inspect_table(read_table(tmp_path / "campaign.h5"))
    assert [one.reference for one in found.measured] == ["high/acc"]
    assert (found.rate, found.rate_of) == (1000.0, "fs of high")


def test_groups_with_rates_of_their_own_in_one_record_state_none(tmp_path):
    with h5py.File(tmp_path / "campaign.h5", "w") as file:
        for group, name, rate in (("low", "acc", 500.0), ("high", "force", 1000.0)):
            file.create_group(group).attrs["fs"] = rate
            file[f"{group}/{name}"] = np.sin(0.3 * np.arange(900))
    assert inspect_table(read_table(tmp_path / "campaign.h5")).rate is None


@pytest.mark.parametrize(("unit", "rate"), [("s", 500.0), ("Hz", None)])
def test_the_step_of_an_abscissa_in_a_structure_is_one_of_time_where_its_unit_says_so(unit, rate, tmp_path):
    over = {"start_value": 0.0, "increment": 0.002, "quantity": {"label": unit}}
    savemat(tmp_path / "a.mat", {"Signal": {"x_values": over, "y_values": {"values": np.sin(0.3 * np.arange(900))}}})
    assert inspect_table(read_table(tmp_path / "a.mat")).rate == rate


def test_groups_of_one_signal_each_are_one_record(tmp_path):
    with h5py.File(tmp_path / "one.h5", "w") as file:
        for group in ("speed", "volt"):
            file[f"{group}/value"] = np.sin(0.3 * np.arange(900) + len(group))
    assert len(inspect_table(read_table(tmp_path / "one.h5")).measured) == 2


def test_a_counter_that_begins_again_is_an_encoder_of_as_many_counts(tmp_path):
    counts = (np.arange(4000) * 37) % 2048
    found = inspected(tmp_path, time=np.arange(4000) / 1e4, TE_arcsec=np.sin(0.2 * np.arange(4000)), encoder=counts)
    assert column(found, "encoder").spectrum.noise < 20, "what falls back is no noise"
    text = starting_yaml(found, system_of(found), guesses(found, "gear_pair"))
    assert "pinion: {column: encoder, counts_per_revolution: 2048}" in text
    assert 'transmission_error: {column: TE_arcsec, unit: arcsec, shaft: "???"}' in text


def test_a_rate_above_a_table_may_have_a_decimal_comma(tmp_path):
    rows = ["Delta t;4.0E-5", "a;b", *(f"{np.sin(0.3 * k):.4f};{np.cos(k**2):.4f}" for k in range(60))]
    (tmp_path / "scope.csv").write_text("\n".join(rows).replace(".", ","))
    assert inspect_table(read_table(tmp_path / "scope.csv")).rate == pytest.approx(25e3)


@pytest.mark.parametrize("counts", [2**20, 3600, 7200])
def test_what_pulses_once_a_turn_of_a_counter_is_its_index(counts, tmp_path):
    turned = np.arange(8000) * 0.0021 + 0.3
    index = (np.diff(np.floor(turned), prepend=0.0) > 0).astype(float)
    found = inspected(tmp_path, time=np.arange(8000) / 2e4, c1=np.floor(counts * turned), z1=index)
    text = starting_yaml(found, system_of(found), guesses(found, "gear_pair"))
    assert f"pinion: {{column: c1, counts_per_revolution: {counts}, index: z1}}" in text
    assert "tacho:" not in text


def test_each_of_two_encoders_has_its_own_index(tmp_path):
    turned = np.arange(9000) * 0.0021 + 0.3
    shafts = {"one": (turned, 4096), "two": (turned * 41 / 24 + 0.2, 4096)}
    columns = {}
    for name, (turns, counts) in shafts.items():
        columns |= {f"c_{name}": np.floor(counts * turns)}
        columns |= {f"z_{name}": (np.diff(np.floor(turns), prepend=np.floor(turns[0])) > 0).astype(float)}
    found = guesses(inspected(tmp_path, time=np.arange(9000) / 2e4, **columns), "gear_pair")
    index = {g.column.reference: (g.counts, g.index.reference) for g in found if g.index is not None}
    assert index == {"c_one": (4096, "z_one"), "c_two": (4096, "z_two")}


@pytest.mark.parametrize(("name", "unit", "channel"), [("n_out", "rpm", "gear_speed"), ("n_in", "rpm", "pinion_speed")])
def test_the_speed_of_a_shaft_is_told_by_its_unit(name, unit, channel, tmp_path):
    rows = ["t,phi,X", f"s,deg,{unit}"]
    rows += [f"{k / 1e4:.4f},{0.9 * k:.4f},{1500 + 9 * np.sin(0.2 * k):.4f}" for k in range(2000)]
    (tmp_path / "run.csv").write_text("\n".join(rows).replace("X", name))
    found = inspect_table(read_table(tmp_path / "run.csv"))
    assert {g.channel for g in guesses(found, "gear_pair")} == {"pinion_angle", channel}


def test_a_drive_that_is_switched_to_and_fro_is_neither_pulses_nor_an_angle(tmp_path):
    on = np.where(np.arange(1600) % 80 < 40, 4.0, -4.0)
    on[np.arange(1600) % 80 == 79] = 0.0  # off for a sample before it is switched forth
    assert column(inspected(tmp_path, time=np.arange(1600) / 100, current=on), "current").kind == SIGNAL


def test_shafts_counters_and_pulses_are_told_from_signals(tmp_path):
    turns = 11.3 * T + 0.01 * np.sin(9 * T)
    found = inspected(
        tmp_path,
        time=T,
        wrapped=np.mod(2 * np.pi * turns, 2 * np.pi),
        in_degrees=-np.mod(360 * turns, 360),
        theta=2 * np.pi * turns,
        counts=np.floor(1024 * turns),
        tacho=4.0 * (np.mod(turns, 1) < 0.2) + 0.05 * RNG(1).normal(size=N),
        wave=np.sin(2 * np.pi * 7 * T),
        saw_of_noise=RNG(2).normal(size=N),
        drift=np.exp(-T) + 0.001 * RNG(3).normal(size=N),
    )
    kinds = {one.reference: one.kind for one in found.columns}
    assert kinds == {
        "time": TIME, "wrapped": TURNING, "in_degrees": TURNING, "theta": TURNING, "counts": COUNTER, "tacho": PULSES,
        "wave": SIGNAL, "saw_of_noise": SIGNAL, "drift": SIGNAL,
    }  # fmt: skip
    assert "6.28" in column(found, "wrapped").says
    assert "rad" in column(found, "wrapped").says
    assert "deg" in column(found, "in_degrees").says


@pytest.mark.parametrize(
    ("stamps", "unit"),
    [(T, "s"), (1.7e9 + T, "s"), (1.7e12 + 1000 * T, "ms"), (np.arange(N) * 2.0, "ms"), (1.7e15 + 1e6 * T, "us")],
)
def test_the_unit_of_stamps_is_guessed(stamps, unit, tmp_path):
    found = inspected(tmp_path, x=np.sin(9 * T), timestamp=stamps)
    assert (found.time.index, found.time.unit) == (1, unit)
    assert found.time.guessed
    assert found.rate == pytest.approx(500 if stamps[1] == 2 else RATE, rel=1e-3)


@pytest.mark.parametrize(("name", "unit"), [("time_ms", "ms"), ("t us", "us"), ("elapsed_s", "s")])
def test_a_name_says_the_unit_of_stamps(name, unit, tmp_path):
    assert inspected(tmp_path, **{name: T, "x": np.sin(9 * T)}).time.unit == unit


def test_jitter_gaps_and_repeats_are_said(tmp_path):
    wave = np.sin(9 * T)
    jitter = inspected(tmp_path, time=T + 1e-6 * RNG(1).normal(size=N), x=wave)
    assert "vary by up to" in jitter.base.notes[0]
    kept = np.r_[0:2000, 2004:N]
    gap = inspected(tmp_path, time=T[kept], x=wave[kept])
    assert [finding.kind for finding in gap.base.findings] == ["dropped_samples"]
    repeated = T.copy()
    repeated[77] = repeated[76]
    twice = inspected(tmp_path, time=repeated, x=wave)
    assert twice.faults == ("1 repeated time stamp(s), the first at sample 77",)
    assert twice.rate == pytest.approx(RATE, rel=1e-3)


def test_gaps_in_values_leave_the_longest_stretch(tmp_path):
    x, y = np.sin(9 * T), np.cos(9 * T)
    x[100], y[5000:5003] = np.nan, np.inf
    found = inspected(tmp_path, time=T, x=x, y=y, empty=np.full(N, np.nan))
    assert found.rows == (101, 5000)
    assert found.base.time.size == 4899


def test_the_first_column_of_a_matrix_may_be_the_time(tmp_path):
    path = tmp_path / "data.mat"
    savemat(path, {"data": np.column_stack([T, np.sin(9 * T), np.cos(4 * T)])})
    found = inspect_table(read_table(path))
    assert found.time.index == 0
    assert found.rate == pytest.approx(RATE)


@pytest.mark.parametrize(
    "stamps",
    [np.round(10 * T + 4.9e-3 * np.sin(7 * T), 2), T + 2e-4 * np.sin(99 * T), np.floor(22e3 * T + 3 * np.sin(T))],
)
def test_a_first_column_of_stamps_that_jitter_or_are_rounded_is_the_time(stamps, tmp_path):
    np.savetxt(tmp_path / "a.txt", np.column_stack([stamps, np.sin(20 * T)]))
    found = inspect_table(read_table(tmp_path / "a.txt"))
    assert [one.kind for one in found.columns] == [TIME, SIGNAL]


def test_the_first_column_of_a_matrix_among_others_may_be_the_time(tmp_path):
    path = tmp_path / "data.mat"
    savemat(path, {"gain": 3.0, "side": np.cos(3 * T), "data": np.column_stack([T, np.sin(9 * T)])})
    found = inspect_table(read_table(path))
    assert found.columns[found.time.index].reference == "data[0]"
    assert found.rate == pytest.approx(RATE)


def test_stamps_of_data_that_came_in_bursts_are_the_time_and_their_mean_the_rate(tmp_path):
    found = inspected(tmp_path, elapsed_s=np.floor(T / 0.02) * 0.02, x=np.sin(9 * T))
    assert found.columns[found.time.index].reference == "elapsed_s"
    assert found.rate == pytest.approx(RATE, rel=0.01)
    assert "repeated" in found.faults[0]


@pytest.mark.parametrize("name", ["SampFreq", "fs", "sampling_rate", "Sample Rate", "rate"])
def test_a_number_named_like_a_rate_may_be_it(name, tmp_path):
    found = inspected(tmp_path, **{name: np.array([RATE]), "x": np.sin(9 * T), "offset": np.array([3.0])})
    assert found.rate == RATE
    text = starting_yaml(found, system_of(found), guesses(found, "oscillator"))
    assert f"sampling_rate: {{value: 1000.0, unit: Hz}}   # guess: what the file calls {name}" in text.replace('"', "")
    assert "# not declared: single numbers: " in text
    stamped = inspected(tmp_path, fs=np.array([50.0]), time=T, x=np.sin(9 * T))
    assert stamped.rate == pytest.approx(RATE)
    assert stamped.rate_of == ""


@pytest.mark.parametrize(
    ("above", "rate"),
    [
        ("Delta t,4.0E-5,4.0E-5", 25e3), ("Sample Interval,40,us", 25e3), ("Delta_X (ms),0.04", 25e3),
        ("# sampling rate: 25 kHz", 25e3), ("fs = 25000", 25e3), ("Abtastintervall,4e-05", 25e3),
        ("Delta t,4.0E-5,8.0E-5", None), ("Sample rate of the second board was never noted in 2019", None),
        ("Record Length,2500", None), ("Sample Interval,0", None), ("Sample Interval,1e999", None),
    ],
)  # fmt: skip
def test_a_rate_above_a_table_of_texts_may_be_that_of_its_rows(above, rate, tmp_path):
    values = np.sin(0.3 * np.arange(60.0)) + 0.1 * np.cos(np.arange(60.0) ** 2)
    rows = [above, "a,b", *(f"{x:.6f},{-x * x:.6f}" for x in values)]
    (tmp_path / "scope.csv").write_text("\n".join(rows))
    found = inspect_table(read_table(tmp_path / "scope.csv"))
    assert found.rate == (None if rate is None else pytest.approx(rate))
    assert found.columns[0].values.size == 60
    rows[1:] = ["t,b", *(f"{k / 50:.3f},{x:.6f}" for k, x in enumerate(values))]
    (tmp_path / "timed.csv").write_text("\n".join(rows))
    assert inspect_table(read_table(tmp_path / "timed.csv")).rate == pytest.approx(50.0)


@pytest.mark.parametrize(
    ("above", "rate"),
    [
        (["trigger_deg, sample_rate, duration", "90, 1000, 5"], 1000.0),
        (["trigger_deg,duration", "90,5"], None),
        (["trigger_deg,sample_rate", "90"], None),
    ],
)
def test_a_rate_may_stand_in_a_row_below_its_name(above, rate, tmp_path):
    values = np.sin(0.3 * np.arange(60.0)) + 0.1 * np.cos(np.arange(60.0) ** 2)
    (tmp_path / "a.txt").write_text("\n".join([*above, *(f"{x:.6f}" for x in values)]))
    found = inspect_table(read_table(tmp_path / "a.txt"))
    assert found.rate == (None if rate is None else pytest.approx(rate))


def test_an_empty_line_before_a_last_comment_is_no_lost_row(tmp_path):
    rows = [f"{x:.6f},{-x:.6f}" for x in np.sin(0.3 * np.arange(60.0))]
    (tmp_path / "a.csv").write_text("\n".join([*rows, "", "# completed at noon", ""]))
    assert read_table(tmp_path / "a.csv").notes == ()
    (tmp_path / "a.csv").write_text("\n".join([*rows[:30], "", *rows[30:], "# completed at noon", ""]))
    assert any(
        "1 empty row(s) among its values, the first in line 31" in n for n in read_table(tmp_path / "a.csv").notes
    )


def test_what_is_not_declared_cuts_no_stretch(tmp_path):
    x, spectrum = np.sin(9 * T), np.cos(5 * T)
    x[5990:], spectrum[4000:] = np.nan, np.nan
    found = inspected(tmp_path, time=T, x=x, spectrum=spectrum)
    assert found.rows == (0, 4000)
    found = of_columns(found, [column(found, "x")])
    assert found.rows == (0, 5990)
    assert found.base.time.size == 5990


def test_a_first_column_that_goes_back_is_no_time(tmp_path):
    np.savetxt(tmp_path / "a.txt", np.column_stack([T + 2e-3 * np.sin(900 * T), np.sin(20 * T)]))
    assert inspect_table(read_table(tmp_path / "a.txt")).columns[0].kind != TIME


def test_a_column_that_is_filled_here_and_there_cuts_no_stretch(tmp_path):
    rare = np.where(np.arange(N) % 50 == 0, 1.0 + T, np.nan)
    found = inspected(tmp_path, time=T, x=np.sin(9 * T), rate=rare)
    assert found.rows == (0, N)
    assert found.base.time.size == N


def test_columns_of_other_lengths_are_no_part_of_the_record(tmp_path):
    found = inspected(tmp_path, mass=np.array([3.5]), time=T, x=np.sin(9 * T), index=np.arange(40) / 3)
    assert found.length == N
    assert [one.reference for one in found.measured] == ["x"]


def channels(tmp_path, **columns):
    found = inspected(tmp_path, **columns)
    system = system_of(found)[0]
    return system, {g.column.reference: g.channel for g in guesses(found, system) if g.used}


def test_the_input_is_guessed_by_its_higher_content(tmp_path):
    noise = RNG(4).normal(size=N)
    answer = np.convolve(noise, np.exp(-np.arange(200) / 40) * np.sin(np.arange(200) / 6), "full")[:N]
    assert channels(tmp_path, time=T, a1=noise, b1=answer) == ("oscillator", {"b1": "displacement", "a1": "force"})


def test_the_slope_of_a_displacement_is_not_declared_beside_it(tmp_path):
    noise = 1e-3 * RNG(5).normal(size=N)
    x, v = np.sin(20 * T), 20 * np.cos(20 * T)
    assert channels(tmp_path, time=T, pos=x + noise, vel=v + noise)[1] == {"pos": "displacement"}
    other = channels(tmp_path, time=T, pos=x + noise, vel=np.cos(33 * T) + noise)[1]
    assert other == {"pos": "displacement", "vel": "velocity"}


def test_of_several_displacements_the_one_that_swings_is_declared(tmp_path):
    noise = 1e-3 * RNG(6).normal(size=(3, N))
    swings = np.exp(-0.3 * T) * np.sin(20 * T)
    used = channels(tmp_path, time=T, x=noise[0] + 9, y=noise[1] + T**2, phi=noise[2] + swings)[1]
    assert used == {"phi": "displacement"}


@pytest.mark.parametrize(
    "names", [("ENTRADA", "ANGULO"), ("Corriente", "ángulo"), ("tensão", "desplazamiento"), ("courant", "Déplacement")]
)
def test_names_in_other_languages_are_understood(names, tmp_path):
    swing = np.exp(-0.3 * T) * np.sin(20 * T) + 1e-3 * RNG(8).normal(size=N)
    pushed = np.sign(np.sin(3 * T)) + 1e-3 * RNG(9).normal(size=N)
    answer, push = names[1], names[0]
    assert channels(tmp_path, tiempo=T, **{push: pushed, answer: swing})[1] == {answer: "displacement", push: "force"}


@pytest.mark.parametrize(
    ("faster", "used"),
    [(None, {"Voltage": "displacement"}), ("current", {"Voltage": "displacement", "current": "force"})],
)
def test_an_input_by_its_name_that_nothing_answers_is_the_answer(faster, used, tmp_path):
    more = {faster: RNG(7).normal(size=N)} if faster else {}
    assert channels(tmp_path, time=T, Voltage=np.exp(-T) * np.sin(20 * T), **more)[1] == used


def test_the_even_advance_of_an_angle_is_no_step_of_a_converter(tmp_path):
    ramp = 2 * np.pi * 11.3 * T
    found = inspected(tmp_path, time=T, theta=ramp, coarse=np.round(ramp / 0.1) * 0.1)
    assert column(found, "theta").step == 0
    assert column(found, "coarse").step == pytest.approx(0.1)


def test_a_unit_that_nobody_knows_stays_open(tmp_path):
    found = inspected(tmp_path, time=T, x=np.sin(20 * T), angle=np.sin(9 * T), travel_mm=np.cos(7 * T), v1=-T, V2=T**2)
    units = {g.column.reference: g.unit for g in guesses(found, "oscillator")}
    assert units == {"x": UNKNOWN, "angle": "rad", "travel_mm": "mm", "v1": UNKNOWN, "V2": "V"}


def test_stamps_closer_than_anything_is_sampled_give_no_rate(tmp_path):
    """Of a damaged file: their rate would be infinite."""
    rows = "".join(f"{k}e-320,{np.sin(k)}\n" for k in (0, 2, 1, *range(3, 60)))
    (tmp_path / "run.csv").write_text("t (s),x\n" + rows)
    found = inspect_table(read_table(tmp_path / "run.csv"))
    assert found.base is None
    assert found.rate is None


def test_a_unit_behind_a_stroke_is_no_name(tmp_path):
    header = "Zeit t / s,Weg a / rad,Spannung U_B1 / V,Frequenz f / Hz"
    rows = np.column_stack([T, np.sin(9 * T), np.sin(40 * T), T**2])
    np.savetxt(tmp_path / "a.csv", rows, "%.9g", ",", header=header, comments="")
    found = inspect_table(read_table(tmp_path / "a.csv"))
    known = {g.column.reference.split()[0]: g.channel for g in guesses(found, "oscillator")}
    assert known == {"Weg": "displacement", "Spannung": "force", "Frequenz": None}


@pytest.mark.parametrize(
    ("name", "channel", "why"),
    [
        ("/imu/angular_velocity/x", "velocity", "by its name"),
        ("imu.linear_acceleration.y", "acceleration", "by its name"),
        ("/pose/position/z", "displacement", "by its name"),
        ("run1/x", "displacement", "by its name"),
        ("run1.x", "displacement", "by its name"),
        ("/imu/magnetic_field/x", "displacement", "the slowest column; what it is, only you know"),
        ("/imu/orientation/w", "displacement", "the slowest column; what it is, only you know"),
    ],
)
def test_the_letter_of_a_component_is_no_name(name, channel, why, tmp_path):
    time = np.arange(500) * 0.01
    rows = "\n".join(f"{t:.3f},{x:.6f}" for t, x in zip(time, np.exp(-0.2 * time) * np.cos(9 * time), strict=True))
    (tmp_path / "a.csv").write_text(f"time,{name}\n{rows}\n")
    _, _, (guess,) = guessed(read_table(tmp_path / "a.csv"))
    assert (guess.channel, guess.why) == (channel, why)


def test_values_that_rise_and_are_of_another_number_may_be_the_times_of_pulses(tmp_path):
    """A laser on a rim beside 6839 stamps of a counter was drafted as an oscillator, without a word of them."""
    edges = np.cumsum(40 + np.random.default_rng(1).uniform(0, 1, 300))
    np.savez(tmp_path / "m1.npz", speed=4377 + np.sin(0.3 * np.arange(1200)), edges=edges)
    found, system, listed = guessed(read_table(tmp_path / "m1.npz"))
    assert column(found, "edges").kind == "times of pulses"
    assert system[0] == "gear_pair"
    text = starting_yaml(found, system, listed)
    assert 'pinion: {timestamps: edges, unit: "???", counts_per_revolution: "???"}' in text
    assert "not declared: column edges" not in text


def test_times_of_pulses_of_both_shafts_have_a_key_each(tmp_path):
    drawn = np.random.default_rng(1).uniform(0, 1, 500)
    arrays = {"speed": np.sin(0.3 * np.arange(1200)), "e1": np.cumsum(40 + drawn), "e2": np.cumsum(90 + drawn[:200])}
    np.savez(tmp_path / "m1.npz", **arrays)
    text = starting_yaml(*guessed(read_table(tmp_path / "m1.npz")))
    assert "pinion: {timestamps: e1," in text
    assert "gear: {timestamps: e2," in text


def test_a_spectrum_beside_the_samples_is_no_shaft(tmp_path):
    uneven = np.cumsum(1 + np.random.default_rng(1).uniform(0, 1, 400))
    np.savez(tmp_path / "m1.npz", x=np.sin(0.3 * np.arange(1200)), f=uneven, power=np.exp(-uneven))
    found, system, _ = guessed(read_table(tmp_path / "m1.npz"))
    assert column(found, "f").kind != "times of pulses"
    assert system[0] == "oscillator"


@pytest.mark.parametrize(
    "values", [np.arange(300.0), np.arange(8.0) ** 2, np.sin(np.arange(300.0)), 0.5 * np.arange(300.0)]
)
def test_numbers_axes_few_values_and_those_that_fall_are_none(tmp_path, values):
    np.savez(tmp_path / "m1.npz", speed=np.sin(0.3 * np.arange(1200)), edges=values)
    found, system, _ = guessed(read_table(tmp_path / "m1.npz"))
    assert column(found, "edges").kind != "times of pulses"
    assert system[0] == "oscillator"


def test_of_several_answers_to_a_pulse_the_slowest_is_proposed_and_clocks_that_are_one_say_so(tmp_path):
    """An oscilloscope writes a column of time for each of its channels; a pulse of 10 us was taken for the motion."""
    time = np.arange(500) * 2e-6
    ring = np.exp(-8000 * time) * np.sin(2 * np.pi * 14.7e3 * time)
    pulse = np.where((time > 2e-5) & (time < 3e-5), 5.0, 0.0)
    columns = {"TimeV_S": time, "AmplitudeV_S": pulse, "TimeV_C": time, "AmplitudeV_C": 3 * ring}
    columns |= {"TimeV_R": time, "AmplitudeV_R": np.gradient(ring)}
    np.savez(tmp_path / "ring.npz", **columns)
    found, _, listed = guessed(read_table(tmp_path / "ring.npz"))
    assert column(found, "TimeV_C").says == "the same as 'TimeV_S'"
    used = {guess.channel: guess.column.reference for guess in listed if guess.used}
    assert used == {"force": "AmplitudeV_S", "displacement": "AmplitudeV_C"}
