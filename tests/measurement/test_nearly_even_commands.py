"""A command that switches stays as it was put out where the stamps are a few thousandths of a step off a grid."""

import numpy as np
import pytest
import yaml

from gear_damping.errors import InputError
from gear_damping.measurement.load import load_measurement


def declared(folder, hold=None, wave=False, **more):
    rng, n = np.random.default_rng(0), 3000
    stamps = np.arange(n) / 150 + 2e-5 * rng.uniform(-1, 1, n)
    force = 4 * np.sign(np.sin(2 * np.pi * 0.7 * stamps))
    force = np.sin(2 * np.pi * 0.7 * stamps) + 0.01 * rng.normal(size=n) if wave else force
    place = np.cumsum(np.cumsum(force)) / 150**2
    np.savez(folder / "a.npz", t=stamps, u=force, x=place + 1e-4 * rng.normal(size=n))
    command = {"column": "u", "unit": "A"} | ({} if hold is None else {"hold": hold})
    channels = {"time": {"column": "t", "unit": "s"}, "force": command, "displacement": {"column": "x", "unit": "m"}}
    said = {"system": "oscillator", "records": [{"file": "a.npz", "channels": channels} | more]}
    (folder / "measurement.yaml").write_text(yaml.safe_dump(said))
    return force


def loaded(folder, hold=None, wave=False):
    force = declared(folder, hold, wave)
    (record,) = load_measurement(folder / "measurement.yaml").records
    assert any("resampled to a uniform grid" in note for note in record.notes)
    return record.channels["force"], force


@pytest.mark.parametrize("hold", [None, True])
def test_it_is_held_and_no_spline_swings_about_its_jumps(tmp_path, hold):
    channel, force = loaded(tmp_path, hold)
    assert channel.hold
    np.testing.assert_array_equal(channel.values, force)


def test_what_is_not_held_is_moved_as_it_was(tmp_path):
    assert np.abs(loaded(tmp_path, hold=False)[0].values).max() > 4.001


def test_a_wave_is_no_command(tmp_path):
    channel, force = loaded(tmp_path, wave=True)
    assert not channel.hold
    assert np.any(channel.values != force)


def test_one_that_is_filtered_is_said_to_ring(tmp_path):
    declared(tmp_path, resample="50 Hz")
    (record,) = load_measurement(tmp_path / "measurement.yaml").records
    assert record.channels["force"].values.max() > 4.1  # of 4
    (note,) = (note for note in record.notes if "lets ring" in note)
    assert note.startswith("force: comes in steps")
    declared(tmp_path, wave=True, resample="50 Hz")
    (record,) = load_measurement(tmp_path / "measurement.yaml").records
    assert not any("lets ring" in note for note in record.notes)


def test_one_that_is_filtered_cannot_be_held(tmp_path):
    declared(tmp_path, hold=True, resample="50 Hz")
    with pytest.raises(InputError, match=r"force\.hold.*leave out resample, or hold"):
        load_measurement(tmp_path / "measurement.yaml")
