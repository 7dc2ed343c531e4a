"""What a drive was asked for is no measurement of what it did."""

import numpy as np
import pytest

from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.guessing import guessed

T = np.arange(4000) / 100.0


def declared(folder, **columns):
    path = folder / "drive.csv"
    np.savetxt(path, np.c_[T, *columns.values()], delimiter=",", header=",".join(["time", *columns]), comments="")
    _, _, listed = guessed(read_table(path))
    return {guess.channel: guess.column.reference for guess in listed if guess.used and guess.channel}


@pytest.mark.parametrize(
    "asked", ["velocity_cmd", "velocity_setpoint", "target_velocity", "v_soll_velocity", "ref_speed"]
)
def test_a_measured_speed_stands_before_the_one_that_was_asked_for(tmp_path, asked):
    """The command has no noise, and stands out most."""
    command = 8 * np.sign(np.sin(0.4 * T)) * np.minimum(1, np.abs(5 * np.sin(0.4 * T)))
    noise = np.random.default_rng(4).normal(size=(2, T.size))
    found = declared(
        tmp_path,
        **{asked: command},
        velocity=0.9 * np.roll(command, 30) + 0.05 * noise[0],
        command_raw=command,
        torque_feedback=np.gradient(command) + 0.1 * noise[1],
    )
    assert found["velocity"] == "velocity"
    assert found["force"] == "torque_feedback"


def test_a_command_is_the_input_where_none_was_measured(tmp_path):
    command = np.sign(np.sin(0.4 * T)) + 0.3 * np.sin(3 * T)
    found = declared(tmp_path, command=command, position=np.cumsum(command) / 100)
    assert found["force"] == "command"
    assert found["displacement"] == "position"


def test_a_data_set_is_no_set_point(tmp_path):
    found = declared(tmp_path, **{"Position Set 1": np.exp(-0.1 * T) * np.sin(9 * T)})
    assert found["displacement"] == "Position Set 1"
