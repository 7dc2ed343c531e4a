"""What is written by libraries and read back: a wave, three columns of it, and what a table says of them."""

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.formats.table import Table

TIME = np.arange(60) / 1000
WAVE = np.sin(2 * np.pi * 20 * TIME)
MATRIX = np.column_stack([WAVE, 2 * WAVE, 3 * WAVE])


def values_of(table: Table, name: str) -> NDArray[np.float64]:
    """The values of a column by its name."""
    return table.values(table.index(name, "column"))


def shapes_of(table: Table) -> dict[str, tuple[int, ...]]:
    """Of every array, by its name."""
    return dict(table.shapes)
