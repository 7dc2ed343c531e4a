"""Rates and names that files of recorders state in ways of their own: Yokogawa, Vicon, Testlab, SLIST and TSPAIR."""

import numpy as np
import pytest
from scipy.io import savemat

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.inspection import inspect_table
from gear_damping.measurement.load import load_measurement

MOTION = np.exp(-0.01 * np.arange(302)) * np.cos(0.3 * np.arange(302))
RATE = 1000.0


def written(folder, text, name="a.csv"):
    (folder / name).write_text(text, encoding="utf-8")
    return read_table(folder / name)


YOKOGAWA = (
    '"Model","DL850E"\n"BlockNumber",1\n"TraceName","CH1","CH2"\n"BlockSize",302,302\n"VUnit","V","N"\n'
    '"SampleRate",1.0000000E+03,1.0000000E+03\n"HResolution",1.0000000E-03,1.0000000E-03\n"HOffset",-1.0,-1.0\n'
    '"HUnit","s","s"\n\n'
)


def test_a_recorder_that_leaves_the_cells_under_its_settings_empty(tmp_path):
    found = written(tmp_path, YOKOGAWA + "".join(f",{x:.6e},{x * x:.6e}\n" for x in MOTION))
    assert found.names == ("", "CH1", "CH2")
    assert [found.unit(k) for k in range(3)] == [None, "V", "N"]
    np.testing.assert_allclose(found.values(1), MOTION, atol=1e-6)
    np.testing.assert_allclose(found.values(2), MOTION**2, atol=1e-6)
    assert found.stated_rate == ("SampleRate", RATE)
    assert found.notes == ("a.csv: 9 line(s) above the values are left out",)


def test_a_recorder_of_two_rates_states_none(tmp_path):
    settings = YOKOGAWA.replace("E+03,1.0000000E+03", "E+03,5.0000000E+02").replace("E-03,1.0", "E-03,2.0")
    found = written(tmp_path, settings + "".join(f",{x:.6e},{x * x:.6e}\n" for x in MOTION))
    assert (found.names, found.stated_rate) == (("", "CH1", "CH2"), None)


@pytest.mark.parametrize(("title", "beside", "rate"), [("Trajectories", "Sub Frame", RATE), ("Notes", "y", None)])
def test_frames_have_the_rate_below_their_title(title, beside, rate, tmp_path):
    text = f"{title}\n1000\n,,Ped:M1,,\nFrame,{beside},X,Y,Z\n,,mm,mm,mm\n"
    found = written(tmp_path, text + "".join(f"{k + 1},0,{x:.6f},{x * x:.6f},0.5\n" for k, x in enumerate(MOTION)))
    assert found.names == ("Frame", beside, "X", "Y", "Z")
    assert found.unit(2) == "mm"
    assert found.stated_rate == (rate and (title, rate))


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_several_tables_of_frames_are_refused_by_their_titles(ends, tmp_path):
    """The second one was told as rows with too few cells."""
    rows = "".join(f"{k + 1},0,{x:.6f},{x * x:.6f}\n" for k, x in enumerate(MOTION))
    text = f"Devices\n1000\n,,Plate,\nFrame,Sub Frame,Fx,Fy\n,,N,N\n{rows}"
    assert written(tmp_path, text.replace("\n", ends)).stated_rate == ("Devices", RATE)
    text += f"\nTrajectories\n100\n,,Ped:M1,\nFrame,Sub Frame,X,Y\n,,mm,mm\n{rows}"
    with pytest.raises(
        InputError, match=r"holds 2 tables one below .*: Devices, Trajectories; remedy: put each"
    ) as said:
        written(tmp_path, text.replace("\n", ends))
    assert len(said.value.problems) == 1


@pytest.mark.parametrize(("label", "rate"), [("s", RATE), ("m", None)])
def test_a_number_in_the_name_of_a_signal_is_not_its_step(label, rate, tmp_path):
    steps = {"start_value": 0.0, "increment": 1e-3, "number_of_values": 302.0, "quantity": {"label": label}}
    savemat(tmp_path / "a.mat", {"Signal_0": {"x_values": steps, "y_values": {"values": MOTION}}})
    found = read_table(tmp_path / "a.mat")
    assert found.stated_rate == (rate and ("x_values.increment", rate))


HEAD = "TIMESERIES XX_STA__HHZ_D, {} samples, 1000 sps, 2024-03-01T12:00:{}, {}, FLOAT, {}\n"


def rows(layout, values, first=0):
    if layout == "SLIST":
        return "".join("\t".join(f"{x:.8f}" for x in values[k : k + 6]) + "\n" for k in range(0, len(values), 6))
    return "".join(f"2024-03-01T12:00:00.{k:03d}000  {x:.8f}\n" for k, x in enumerate(values, first))


@pytest.mark.parametrize("layout", ["SLIST", "TSPAIR"])
@pytest.mark.parametrize(("unit", "known"), [("COUNTS", None), ("m/s", "m/s")])
def test_values_of_a_station_are_one_column_with_its_rate(layout, unit, known, tmp_path):
    found = written(tmp_path, HEAD.format(302, "00.000000", layout, unit) + rows(layout, MOTION), "a.asc")
    assert (found.names, found.unit(0), found.notes) == (("XX_STA__HHZ_D",), known, ())
    np.testing.assert_allclose(found.values(0), MOTION, atol=1e-8)
    assert inspect_table(found).rate == RATE
    (tmp_path / "m.yaml").write_text(
        "system: oscillator\nrecords:\n  - file: a.asc\n    channels:\n      displacement: {column: 0, unit: V}\n"
    )
    (record,) = load_measurement(tmp_path / "m.yaml").records
    assert (record.sampling_rate, record.channels["displacement"].values.size) == (RATE, 302)


def test_stretches_of_a_station_have_a_clock_each(tmp_path):
    parts = ((MOTION[:100], "00.000000"), (MOTION[150:], "00.150000"))
    text = "".join(HEAD.format(len(one), at, "SLIST", "COUNTS") + rows("SLIST", one) for one, at in parts)
    found = written(tmp_path, text, "a.asc")
    assert found.names == tuple(f"XX_STA__HHZ_D 2024-03-01T12:00:{at}" for _, at in parts)
    assert [found.clock(k) for k in range(2)] == [(0.0, RATE), (0.15, RATE)]
    np.testing.assert_allclose(found.values(1), MOTION[150:], atol=1e-8)


def test_a_station_whose_values_are_cut_is_said(tmp_path):
    found = written(tmp_path, HEAD.format(302, "00.000000", "SLIST", "COUNTS") + rows("SLIST", MOTION[:200]), "a.asc")
    assert found.notes == ("a.asc: 'XX_STA__HHZ_D' is said to have 302 samples, and has 200",)


@pytest.mark.parametrize(("below", "said"), [("1 2 gap 3\n", "something is no number"), ("\n", "no values below it")])
def test_a_station_without_numbers_is_refused(below, said, tmp_path):
    with pytest.raises(InputError, match=said):
        written(tmp_path, HEAD.format(302, "00.000000", "SLIST", "COUNTS") + below, "a.asc")


SCOPE = (  # three settings of numbers come first, and the line above the values has one cell
    "Memory Length,302,\nIntpDistance,0,\nTrigger Level,0,\nSource,CH1,\nVertical Units,V,\nVertical Scale,1.0,\n"
    "Sampling Period,1.000e-03,\nFirmware,V1,\nMode,Detail,\nWaveform Data,\n"
)


def test_settings_of_numbers_above_a_line_of_one_cell_are_no_rows(tmp_path):
    found = written(tmp_path, SCOPE + "".join(f"{k / RATE:.6e},{x:.6e},\n" for k, x in enumerate(MOTION)))
    np.testing.assert_allclose(found.values(0), np.arange(302) / RATE, atol=1e-9)
    np.testing.assert_allclose(found.values(1), MOTION, atol=1e-6)
    assert found.unit(1) == "V"
    assert inspect_table(found).rate == pytest.approx(RATE)


@pytest.mark.parametrize("rate", [1000.0, 2560.0])
@pytest.mark.parametrize("above", ["X-Axis unit:\ts\nY-Axis unit:\tm/s^2\n", "X-axis: [s] (Time)\n"])
def test_behind_the_numbers_of_the_rows_comes_the_time(rate, above, tmp_path):
    """As an analyser exports a time record: the numbers of the rows are no milliseconds."""
    rows = "".join(f"{k + 1}\t{k / rate:.6E}\t{x:.6E}\n" for k, x in enumerate(MOTION))
    found = inspect_table(written(tmp_path, f"Title1:\tInput\nX-Axis size:\t302\n{above}{rows}", "a.txt"))
    assert (found.time.index, found.time.unit) == (1, "s")
    assert found.rate == pytest.approx(rate, rel=1e-3)
    assert found.columns[2].unit == ("m/s^2" if "unit" in above else None)


def test_whole_numbers_behind_those_of_the_rows_may_be_counts_of_a_shaft(tmp_path):
    rows = "".join(f"{k + 1}\t{500 * k}\t{x:.6E}\n" for k, x in enumerate(MOTION))
    assert inspect_table(written(tmp_path, rows, "a.txt")).time.index == 0
