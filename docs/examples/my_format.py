"""A file format of one's own: a line of names with units, the rate, then 32-bit floats, channel by channel."""

from pathlib import Path

import numpy as np

from gear_damping.measurement.formats.table import ArrayTable, Held, Table, unreadable

SUFFIXES = (".rig",)


def read(path: Path, max_bytes: int) -> Table:
    """The channels of a recorder's file as columns, with their units and their rate.

    Raises:
        InputError: the file is not what it should be.
    """
    with unreadable(path, "not a readable file of the recorder", "export it again"):
        names, rate, values = path.read_bytes().split(b"\n", 2)
        channels = [name.strip("] ").split(" [") for name in names.decode().split(";")]
        columns = np.frombuffer(values, "<f4").reshape(len(channels), -1)
        clock = (0.0, float(rate))
    pairs = zip(channels, columns, strict=True)
    return ArrayTable(path, [Held(name, column.shape, column.copy, unit, clock) for (name, unit), column in pairs])
