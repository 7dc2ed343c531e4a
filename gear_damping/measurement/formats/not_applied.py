"""Factors and zeros that a file states beside values, which nothing says to be applied to them or not."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

_FACTORS = ("scale", "scale_factor", "factor", "gain", "sensitivity", "calibration", "calibration_factor", "slope")
_OF_A_SENSOR = ("scale", "scale_factor", "sensitivity", "calibration", "calibration_factor")  # and of nothing else
_ABOVE = re.compile(  # of lines above a table: `Sensitivity: 100 mV/g`, `# Sensor 2 scale factor = 0.1`
    r"^[#%/;*! ]*(?:\w+[ _.\-]+){0,3}?(?:sensitivit\w*|empfindlichkeit|sensibilit\w*|scal(?:e|ing)[ _]?factor|"
    r"calibration[ _]?(?:factor|constant)|(?:kalibrier|skalierungs)faktor)\b"
    r"[^\d.+\-]*(?P<number>[-+.\d][-+.,\de]*)(?P<behind>.*)$",
    re.I,
)
_LONGEST_LINE = 60  # characters of a line that are told
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


def left_above(rows: Iterable[Sequence[str]]) -> tuple[str, ...]:
    """What is noted of the first line above a table that states the sensitivity of a sensor or a factor but 1."""
    lines = [" ".join(cell.strip().strip('"') for cell in row if cell.strip()).lstrip("#%/;*! ") for row in rows]
    found = [one for line in lines if (one := _ABOVE.match(line))]
    told = [one[0][:_LONGEST_LINE] for one in found if one["behind"].strip() or not _is_one(one["number"])]
    return (_left(told[0], "above the table"),) if told else ()


def said_beside(file: str, single: Mapping[str, Any]) -> tuple[str, ...]:
    """What is noted of single numbers beside arrays that are named like the factor of a sensor."""
    found = not_applied({name: value for name, value in single.items() if name.lower() in _OF_A_SENSOR})
    return tuple(f"{file}: {_left(f'{name} = {value:g}', 'beside the arrays')}" for name, value in found.items())


def _left(said: str, where: str) -> str:
    return (
        f"'{said}' {where} is not applied; where values are without it, declare gain: what the file holds for one unit"
    )


def _is_one(number: str) -> bool:
    try:
        return float(number.replace(",", ".")) == 1
    except ValueError:
        return False
