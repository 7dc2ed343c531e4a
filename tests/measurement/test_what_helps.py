"""Remedies that name what the file itself says: its rate, its clock, the factor beside a channel."""

import json

import h5py
import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.load import load_measurement
from gear_damping.units import to_si

TIME = np.arange(400) * 0.01
MOTION = np.exp(-0.3 * TIME) * np.cos(9 * TIME)


def loaded(folder, file, channels, more=""):
    (folder / "m.yaml").write_text(
        f"system: oscillator\nrecords:\n  - file: {file}\n{more}    channels: {{{channels}}}\n"
    )
    return load_measurement(folder / "m.yaml").records[0]


def clocked(folder):
    rows = "\n".join(f"12:00:{t:05.2f},{x:.6f}" for t, x in zip(TIME, MOTION, strict=True))
    (folder / "a.csv").write_text(f"t,x\n{rows}\n")
    return "a.csv", "time: {column: t}, displacement: {column: x, unit: mm}"


def test_where_no_time_is_given_the_rate_that_the_file_states_helps(tmp_path):
    (tmp_path / "a.csv").write_text("Delta_X,0.01\nx,y\n" + "\n".join(f"{x:.6f},1" for x in MOTION) + "\n")
    with pytest.raises(InputError, match=r"neither time .* write sampling_rate: 100 Hz, as 'Delta_X' in the file says"):
        loaded(tmp_path, "a.csv", "displacement: {column: x, unit: mm}")
    content = {"sampleRate": 250, "x": MOTION.tolist()}
    (tmp_path / "a.json").write_text(json.dumps(content))
    with pytest.raises(InputError, match="write sampling_rate: 250 Hz, as 'sampleRate' in the file says"):
        loaded(tmp_path, "a.json", "displacement: {column: x, unit: mm}")


@pytest.mark.parametrize("start", ["12:00:01", '"12:00:01"', "12:00"])
def test_a_window_of_clocks_is_in_seconds_from_the_first(start, tmp_path):
    with pytest.raises(
        InputError, match=r"in s from the record's first sample, .* write s from there, for example 5 s"
    ):
        loaded(tmp_path, *clocked(tmp_path), f"    window: {{from: {start}, to: 3, unit: s}}\n")


def test_a_window_in_seconds_of_the_day_is_told_in_those_of_the_record(tmp_path):
    with pytest.raises(InputError, match=r"from the first sample, .* of the same day these are 1 to 3 s"):
        loaded(tmp_path, *clocked(tmp_path), "    window: {from: 43201, to: 43203, unit: s}\n")
    with pytest.raises(InputError, match="dates and clocks count"):
        loaded(tmp_path, *clocked(tmp_path), "    window: {from: 1, to: 30, unit: s}\n")
    assert loaded(tmp_path, *clocked(tmp_path), "    window: {from: 1, to: 3, unit: s}\n").time.size == 200


def test_an_angle_beside_the_gears_encoder_is_to_be_the_other_encoder(bench):
    """Two remedies contradicted each other: keep one of the two, and declare the other beside it."""
    bench.columns["g"] = np.arange(400.0)
    del bench.channels["transmission_error"]
    bench.record["encoders"] = {"gear": {"column": "g", "counts_per_revolution": 360}}
    (said,) = bench.problems()
    assert "encoders.gear: has no meaning without encoders.pinion beside channels.pinion_angle" in said
    assert "remedy: declare encoders.pinion in the place of channels.pinion_angle, with counts_per_rev" in said


@pytest.mark.parametrize("shape", [(1, 400), (400, 1), (400,)])
def test_a_mat_file_that_is_hdf5_alone_is_read(shape, tmp_path):
    with h5py.File(tmp_path / "a.mat", "w") as file:
        run = file.create_group("rec")
        run["t"], run["y"], run["note"] = TIME.reshape(shape), np.stack([MOTION, -MOTION]), "by hand"
    table = read_table(tmp_path / "a.mat")
    assert set(table.names) == {"rec.t", "rec.y[0]", "rec.y[1]"}
    np.testing.assert_allclose(table.values(table.index("rec.y[1]", "")), -MOTION)
    assert any("rec.note" in one for one in table.left_out)


@pytest.mark.parametrize(("scale", "is_said"), [(0.5, True), (1, False)])
def test_a_factor_beside_a_channel_of_json_is_not_applied_and_said(scale, is_said, tmp_path):
    channel = {"name": "x", "unit": "mm", "scale": scale, "offset": 0, "values": MOTION.tolist()}
    (tmp_path / "a.json").write_text(json.dumps({"channels": [channel]}))
    record = loaded(tmp_path, "a.json", "sampling_rate: 100 Hz, displacement: {column: x}")
    said = [one.message for one in record.findings if one.kind == "not_applied"]
    assert [one.startswith("column 'x' has an attribute scale = 0.5, which is not") for one in said] == [True] * is_said
    np.testing.assert_allclose(record.channels["displacement"].values, MOTION)


@pytest.mark.parametrize("rate", ["50 Hz", "20 ms", "{value: 20, unit: ms}"])
def test_a_lower_rate_may_be_the_time_from_one_sample_to_the_next(rate, tmp_path):
    (tmp_path / "a.csv").write_text("x\n" + "\n".join(f"{x:.6f}" for x in MOTION) + "\n")
    channels = "sampling_rate: 100 samples/s, displacement: {column: x, unit: mm}"
    assert loaded(tmp_path, "a.csv", channels, f"    resample: {rate}\n").sampling_rate == pytest.approx(50)


@pytest.mark.parametrize(("unit", "factor"), [("samples/s", 1.0), ("samples/sec", 1.0), ("ks/s", 1e3), ("kS/s", 1e3)])
def test_samples_a_second_are_a_rate(unit, factor):
    assert to_si(3.0, unit, "Hz") == pytest.approx(3 * factor)
