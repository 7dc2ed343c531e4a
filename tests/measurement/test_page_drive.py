"""The drive of docs/measurement.md is read as the page declares it, and its remarks on gains are right."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from gear_damping.measurement.files import DATA_VARIABLE
from gear_damping.measurement.load import load_measurement

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "measurement.md").read_text(encoding="utf-8")
DRIVE = PAGE.split("## A motor, a drive, something without a spring")[1].split("```")[1].removeprefix("yaml\n")
TIME = np.arange(4000) / 1000.0
MASS, NEWTONS_PER_VOLT = 95.1, 35.15


@pytest.fixture
def drive(tmp_path, monkeypatch):
    """The measurement of the page, of a slide of that mass whose files are made up."""
    monkeypatch.setenv(DATA_VARIABLE, str(tmp_path))
    (tmp_path / "emps").mkdir()
    for number, name in enumerate(("DATA_EMPS", "DATA_EMPS_PULSES"), start=1):
        place = 0.1 * np.sin(2 * np.pi * number * TIME)
        volts = -MASS * (2 * np.pi * number) ** 2 * place / NEWTONS_PER_VOLT
        savemat(tmp_path / "emps" / f"{name}.mat", {"t": TIME, "vir": volts, "qm": place})
    (tmp_path / "measurement.yaml").write_text(DRIVE)
    return load_measurement(tmp_path / "measurement.yaml")


def test_the_drive_of_the_page_is_read(drive):
    assert [(record.name, record.role) for record in drive.records] == [("trajectory", "fit"), ("pulses", "holdout")]
    assert (drive.system, drive.segment_s, drive.parameters["stiffness"].value) == ("oscillator", 2.0, 0.0)
    assert not [finding for finding in drive.findings if finding.severity == "data_problem"]


def test_its_force_gain_times_its_force_is_its_acceleration(drive):
    channels, gain = drive.records[1].channels, drive.parameters["force_gain"].value
    wanted = np.gradient(np.gradient(channels["displacement"].values, TIME), TIME)[10:-10]
    assert gain * channels["force"].values[10:-10] == pytest.approx(wanted, rel=5e-3, abs=1e-3 * np.abs(wanted).max())


def test_the_mean_over_an_interval_is_late_by_half_of_it_and_takes_little():
    rate, frequency, fine = 50.0, 5.0, 1000
    time = np.arange(0, 2, 1 / (rate * fine))
    mean = np.sin(2 * np.pi * frequency * time).reshape(-1, fine).mean(axis=1)
    at_end = (np.arange(mean.size) + 1) / rate
    late = np.sin(2 * np.pi * frequency * (at_end - 0.5 / rate))
    assert mean == pytest.approx(late, abs=0.02)
