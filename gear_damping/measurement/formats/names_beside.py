"""Names and units of the columns of a matrix that stand in a list of texts beside it: `names`, `labels`, `units`."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.formats.header import bracket_unit
from gear_damping.measurement.formats.table import Held

_NAMES = re.compile(
    r"(col(umn)?|chan(nel)?|ch|signal|sensor|var(iable)?|data)?_?(names?|labels?|headers?|legends?|titles?)|columns|channels|signals|header",
    re.I,
)
_UNITS = re.compile(r"((col(umn)?|chan(nel)?|ch|signal|sensor|var(iable)?|data)_?)?(units?|einheit(en)?)", re.I)
_SIDES = 2  # of a matrix: one of samples, one of channels
_ELEMENT = re.compile(r"^(?P<list>.+)\[(?P<place>\d+)\]$")  # of a list of texts, `names[0]`


def named_columns(held: Sequence[Held], lists: Mapping[str, Sequence[str]]) -> list[Held]:
    """The arrays of a file; the only matrix as columns with names of their own, where a list beside it names them.

    What else it is called, `data[0]`, each column may be asked for by too.

    Args:
        held: The arrays.
        lists: The lists of texts by their names.
    """
    matrices = [one for one in held if len(one.shape) == _SIDES]
    if len(matrices) != 1:
        return list(held)
    matrix, width = matrices[0], min(matrices[0].shape)
    names, units = _only(lists, _NAMES, width), _only(lists, _UNITS, width)
    others = {one.name for one in held if one is not matrix}
    if len(set(names)) != width or not all(names) or others & set(names):
        return list(held)
    columns = [_column(matrix, k, name, unit) for k, (name, unit) in enumerate(zip(names, units, strict=True))]
    return [part for one in held for part in (columns if one is matrix else [one])]


def text_lists(texts: Mapping[str, str], arrays: Mapping[str, NDArray]) -> dict[str, list[str]]:
    """The lists of texts of a file by their names: its arrays of texts, and texts that are elements of one.

    Args:
        texts: The single texts by their names, `names[0]` in the order of their list.
        arrays: The arrays of the file.
    """
    lists = {
        name: [str(one) for one in array]
        for name, array in arrays.items()
        if array.dtype.kind == "U" and array.ndim == 1
    }
    for name, text in texts.items():
        if place := _ELEMENT.match(name):
            lists.setdefault(place["list"], []).append(text)
    return lists


def _only(lists: Mapping[str, Sequence[str]], named: re.Pattern[str], width: int) -> list[str]:
    """The one list of as many texts that is named so; as many empty ones where there is none, or more."""
    found = [
        texts for name, texts in lists.items() if len(texts) == width and named.fullmatch(re.split(r"[./]", name)[-1])
    ]
    return [text.strip() for text in found[0]] if len(found) == 1 else [""] * width


def _column(matrix: Held, place: int, name: str, unit: str) -> Held:
    side = 1 - int(np.argmax(matrix.shape))

    def read() -> NDArray:
        return np.take(np.reshape(matrix.read(), matrix.shape), place, axis=side)

    unit = unit or bracket_unit(name) or matrix.unit
    return replace(matrix, name=name, shape=(max(matrix.shape),), read=read, unit=unit, also=f"{matrix.name}[{place}]")
