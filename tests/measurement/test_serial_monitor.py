"""Lines that a serial monitor shows behind the clock at which they came and an arrow."""

import numpy as np
import pytest

from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.guessing import guessed

N = 400
COUNTS = np.round(9000 * np.sin(0.19 * np.arange(N))).astype(int)
MICROS = (4294000000 + 10_000 * np.arange(N)) % 2**32


def _table(folder, lines):
    shown = (f"10:{12 + k // 6000:02d}:{(k % 6000) / 100:06.3f} -> {line}" for k, line in enumerate(lines))
    (folder / "a.txt").write_text("\n".join(shown) + "\n")
    return read_table(folder / "a.txt")


@pytest.mark.parametrize("sign", [",", ";", "\t", " "])
def test_the_clock_before_an_arrow_is_a_column_of_its_own(sign, tmp_path):
    table = _table(tmp_path, [f"{us}{sign}{count}" for us, count in zip(MICROS, COUNTS, strict=True)])
    assert (table.unit(0), table.begins(0)) == ("s", pytest.approx(10 * 3600 + 12 * 60))
    assert table.values(1).tolist() == MICROS.tolist()
    assert table.values(2).tolist() == COUNTS.tolist()


def test_a_single_number_behind_it_and_names_are_read(tmp_path):
    table = _table(tmp_path, ["weg_mm", *COUNTS])
    assert table.names == ("clock", "weg_mm")
    assert table.values(1).tolist() == COUNTS.tolist()


def test_microseconds_beside_the_clock_are_another_clock_and_no_encoder(tmp_path):
    found, system, listed = guessed(_table(tmp_path, [f"{us},{x}" for us, x in zip(MICROS, COUNTS, strict=True)]))
    assert (system[0], found.rate) == ("oscillator", pytest.approx(100.0))
    assert [guess.column.reference for guess in listed] == [2]
    assert found.columns[1].says == "goes on with the time stamps, in us: another clock"


@pytest.mark.parametrize("sign", [", ", "; ", "\t", " "])
def test_the_clock_of_pythons_logging_has_a_comma_that_parts_no_cells(sign, tmp_path):
    """`2021-12-27 18:06:19,663 -0.015, -0.05`, as `%(asctime)s %(message)s` writes it."""
    angle, command = -0.001 * COUNTS, 0.05 * (-1.0) ** (np.arange(N) // 100)
    rows = (f"2021-12-27 18:06:{5 + k // 100:02d},{k % 100 * 10:03d} {x:.3f}{sign}{u:.2f}" for k, (x, u) in
            enumerate(zip(angle, command, strict=True)))  # fmt: skip
    (tmp_path / "run.log").write_text("\n".join(rows) + "\n")
    table = read_table(tmp_path / "run.log")
    values = [table.values(k) for k in range(len(table.names) - 3, len(table.names))]  # of blanks, behind a date
    assert values[1] == pytest.approx(angle, abs=1e-9)
    assert values[2] == pytest.approx(command, abs=1e-9)
    assert np.diff(values[0]) == pytest.approx(0.01, abs=1e-9)
