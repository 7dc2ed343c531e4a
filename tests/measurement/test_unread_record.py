"""A record that cannot be read is refused by its own message, whatever the others show."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.load import load_measurement

TEXT = """system: oscillator
records:
- {file: seen.csv, channels: {sampling_rate: 100 Hz, acceleration: {column: a, unit: g}}}
- {file: gone.csv, channels: {sampling_rate: 100 Hz, displacement: {column: x, unit: mm}}}
"""


def test_a_missing_file_beside_an_acceleration_is_what_is_said(tmp_path):
    np.savetxt(tmp_path / "seen.csv", np.sin(np.arange(200) / 9), header="a", comments="")
    (tmp_path / "measurement.yaml").write_text(TEXT)
    with pytest.raises(InputError, match=r"gone\.csv"):
        load_measurement(tmp_path / "measurement.yaml")
