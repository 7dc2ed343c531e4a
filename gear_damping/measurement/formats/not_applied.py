"""Factors and zeros that a file states beside values, which nothing says to be applied to them or not."""

from collections.abc import Mapping
from typing import Any

import numpy as np

_FACTORS = ("scale", "scale_factor", "factor", "gain", "sensitivity", "calibration", "calibration_factor", "slope")
_ZEROS = ("add_offset", "offset", "intercept")  # that values may have to be moved by


def not_applied(beside: Mapping[str, Any]) -> dict[str, float]:
    """Those of single values, by their names, by which numbers may have to be multiplied or moved."""
    neutral = {**dict.fromkeys(_FACTORS, 1), **dict.fromkeys(_ZEROS, 0)}
    found = {name: value for name, value in beside.items() if name.lower() in neutral and np.size(value) == 1}
    return {name: value for name, value in found.items() if value != neutral[name.lower()]}


def said_of(file: str, left: Mapping[str, Mapping[str, float]]) -> tuple[str, ...]:
    """What is noted of them, by the names of the columns that they stand beside."""
    return tuple(
        f"{file}: '{name}' has an attribute {attribute} = {value}, which is not applied"
        for name, scales in left.items()
        for attribute, value in scales.items()
    )
