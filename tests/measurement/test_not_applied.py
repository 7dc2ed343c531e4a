"""Sensitivities and factors above a table or beside arrays are not applied, and said."""

import numpy as np
import pytest
from scipy.io import savemat

from gear_damping.measurement.formats.registry import read_table

ROWS = "".join(f"{k / 100:.2f},{np.cos(k / 9):.5f}\n" for k in range(100))


def notes_of(folder, head):
    (folder / "a.csv").write_text(head + ROWS, encoding="utf-8")
    return [note for note in read_table(folder / "a.csv").notes if "not applied" in note]


@pytest.mark.parametrize(
    "line",
    [
        "Sensitivity: 100 mV/g", "# Sensor 2 sensitivity = 9.8 mV/(m/s^2)", "Empfindlichkeit;100;mV/g",
        "Scale factor: 0.1", "Sensor scale_factor 2,5", "Calibration factor,12.5", "sensitivity (mV/g): 100.2",
        "Sensitivity: 1 V/N",
    ],
)  # fmt: skip
def test_a_line_above_a_table_is_said(tmp_path, line):
    (note,) = notes_of(tmp_path, f"{line}\nt,u\n")
    assert "above the table is not applied" in note
    assert "declare gain: what the file holds for one unit" in note


@pytest.mark.parametrize(
    "line",
    ["Scale factor: 1.0", "Sensitivity: high", "Vertical Scale,0.5", "Probe Attenuation,10", "Trigger sensitive 5"],
)
def test_what_changes_nothing_is_not(tmp_path, line):
    assert not notes_of(tmp_path, f"{line}\nt,u\n")


@pytest.mark.parametrize("ending", ["mat", "npz"])
def test_so_is_a_number_beside_arrays(tmp_path, ending):
    arrays = {"x": np.arange(50.0), "scale": 0.001, "gain": 3.0, "sensitivity": 1.0}
    (savemat if ending == "mat" else lambda path, one: np.savez(path, **one))(tmp_path / f"a.{ending}", arrays)
    (note,) = read_table(tmp_path / f"a.{ending}").notes
    assert "'scale = 0.001' beside the arrays is not applied" in note
