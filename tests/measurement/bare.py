"""A bare file of columns, inspected."""

import numpy as np

from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.inspection import inspect_table


def inspected(tmp_path, **columns):
    np.savez(tmp_path / "a.npz", **columns)
    return inspect_table(read_table(tmp_path / "a.npz"))


def column(found, name):
    return next(one for one in found.columns if one.reference == name)
