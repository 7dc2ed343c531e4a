"""What is written is read back to the same numbers, and nothing is overwritten."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.record import Channel, Quantity, Record
from gear_damping.measurement.write import write_measurement


def _record(name: str = "run_1", role: str | None = "fit") -> Record:
    rng = np.random.default_rng(11)
    time = 0.1 + np.arange(300) / 51200
    channels = {
        "transmission_error": Channel(
            "transmission_error", 1e-5 * rng.standard_normal(300), "m", lowpass=2e4, noise=1e-8, polarity=-1,
            coupling="AC", delay=1e-6, range=1e-3, uncertainty=0.01, datum="arbitrary",
        ),
        "pinion_torque": Channel("pinion_torque", 150 + rng.standard_normal(300), "N*m"),
        "pinion_angle": Channel("pinion_angle", 480.1 * time, "rad"),  # whose zero is that of the mesh
        "acceleration": Channel(
            "acceleration", rng.standard_normal(300), "m/s^2", mounting="tangential", shaft="gear", radius=0.03
        ),
    }  # fmt: skip
    conditions = {"pinion_speed": Quantity(480.123456789012345, "rad/s")}
    return Record(name, Path("-"), "", role, 51200.0, time, channels, conditions, "balanced", True)


def _same(read: Record, written: Record) -> None:
    np.testing.assert_array_equal(read.time, written.time)
    assert read.sampling_rate == pytest.approx(written.sampling_rate, rel=1e-10)
    assert (read.name, read.role) == (written.name, written.role)
    assert (read.gear_torque_mode, read.mesh_index) == (written.gear_torque_mode, written.mesh_index)
    assert dict(read.conditions) == dict(written.conditions)
    assert set(read.channels) == set(written.channels)
    for name, channel in written.channels.items():
        np.testing.assert_array_equal(read.channels[name].values, channel.values)
        told = {key: value for key, value in vars(channel).items() if key != "values"}
        assert {key: vars(read.channels[name])[key] for key in told} == told


def test_a_gear_record_comes_back_the_same(tmp_path):
    records = [_record(), _record("run_2", "holdout"), _record("run_3", None)]
    parameters = {"module": Quantity(0.003, "m"), "torque_gain": Quantity(1.0, "1", 0.05)}
    path = write_measurement(tmp_path / "new" / "folder", "gear_pair", records, parameters)
    measurement = load_measurement(path)
    assert dict(measurement.parameters) == parameters
    for read, written in zip(measurement.records, records, strict=True):
        _same(read, written)
        assert read.notes == ()


def test_an_oscillator_in_volts_comes_back_the_same(tmp_path):
    rng = np.random.default_rng(5)
    channels = {
        "force": Channel("force", rng.standard_normal(200), "mV"),
        "displacement": Channel("displacement", rng.standard_normal(200), "V"),
    }
    record = Record("multisine", Path("-"), "", "fit", 610.3515625, np.arange(200) / 610.3515625, channels)
    parameters = {"stiffness": Quantity(1.9e5, "1/s^2"), "force_gain": Quantity(18.5, "own")}
    path = write_measurement(tmp_path, "oscillator", [record], parameters)
    measurement = load_measurement(path)
    assert dict(measurement.parameters) == parameters
    _same(measurement.records[0], record)


def test_a_large_uncertainty_comes_back_the_same(tmp_path):
    parameters = {"torque_gain": Quantity(1.0, "1", 2.5)}
    channel = replace(_record().channels["transmission_error"], uncertainty=1.5)
    record = replace(_record(), channels=_record().channels | {"transmission_error": channel})
    measurement = load_measurement(write_measurement(tmp_path, "gear_pair", [record], parameters))
    assert dict(measurement.parameters) == parameters
    assert measurement.records[0].channels["transmission_error"].uncertainty == 1.5


def test_nothing_is_overwritten_and_nothing_half_written(tmp_path):
    (tmp_path / "run_2.csv").write_text("precious")
    with pytest.raises(InputError, match=r"run_2\.csv.*exists already|exists already.*run_2\.csv") as caught:
        write_measurement(tmp_path, "gear_pair", [_record(), _record("run_2")])
    assert len(caught.value.problems) == 1
    assert (tmp_path / "run_2.csv").read_text() == "precious"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run_2.csv"]


@pytest.mark.parametrize(
    ("system", "records", "said"),
    [
        ("gears", [_record()], "system must be one of"),
        ("gear_pair", [], "at least one"),
        ("gear_pair", [_record(), _record()], "each with its own name"),
        ("gear_pair", [_record("../escape")], "no file name"),
        ("oscillator", [_record()], "that no oscillator has"),
    ],
)
def test_what_cannot_be_written_is_refused(tmp_path, system, records, said):
    with pytest.raises(ValueError, match=said):
        write_measurement(tmp_path, system, records)
    assert not list(tmp_path.iterdir())


def test_records_hold_together():
    record = _record()
    with pytest.raises(ValueError, match="share its time"):
        replace(record, time=record.time[:-1])
    with pytest.raises(ValueError, match="role must be"):
        replace(record, role="test")
    with pytest.raises(ValueError, match="sampling_rate must be positive"):
        replace(record, sampling_rate=0.0)
    with pytest.raises(ValueError, match="one-dimensional"):
        Channel("displacement", np.zeros((3, 1)), "m")
    assert record.duration == pytest.approx(299 / 51200)
