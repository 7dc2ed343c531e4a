"""Files of markers (TRC): names of markers and of coordinates in two rows, the unit among settings."""

import numpy as np
import pytest

from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.inspection import inspect_table

SETTINGS = ["DataRate", "CameraRate", "NumFrames", "NumMarkers", "Units", "OrigDataRate"]
SETTINGS += ["OrigDataStartFrame", "OrigNumFrames"]


@pytest.mark.parametrize("markers", [1, 2, 3])  # with two there are as many settings as columns
def test_columns_bear_the_names_of_markers_and_their_unit(tmp_path, markers):
    named = "".join(f"\tM{k}\t\t" for k in range(1, markers + 1))
    parts = "".join(f"\tX{k}\tY{k}\tZ{k}" for k in range(1, markers + 1))
    values = ["100", "100", "60", str(markers), "mm", "100", "1", "60"]
    rows = [
        f"{k + 1}\t{k / 100:.2f}" + "".join(f"\t{np.sin(0.3 * k + j):.4f}" for j in range(3 * markers))
        for k in range(60)
    ]
    head = [
        "PathFileType\t4\t(X/Y/Z)\ta.trc",
        "\t".join(SETTINGS),
        "\t".join(values),
        f"Frame#\tTime{named}",
        f"\t{parts}",
        "",
    ]
    (tmp_path / "a.trc").write_text("\n".join([*head, *rows]) + "\n")
    table = read_table(tmp_path / "a.trc")
    found = inspect_table(table)
    assert table.names[:4] == ("Frame#", "Time", "M1.X1", "M1.Y1")
    assert table.names[-1] == f"M{markers}.Z{markers}"
    assert len(table.names) == 2 + 3 * markers
    assert (found.rate, found.time.guessed) == (pytest.approx(100), "")
    assert {table.unit(k) for k in range(2, len(table.names))} == {"mm"}
    assert found.length == 60
