"""MATLAB files: up to version 7 by scipy, version 7.3 by pymatreader.

Fields of structures are `run.y`, elements of cells and of arrays of structures `c[0]`, `run.y[0]`, columns of a cell
array with names above its numbers `raw.t [s]`. Where each element of an array of structures has a name and one vector,
as in MAT files made of TDMS files, that is its name too. A text beside one, `Unit` or `x_unit`, is its unit, and a
list of texts beside the only matrix, `names`, names its columns.
"""

import re
import warnings
import zlib
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat
from scipy.io.matlab import MatlabFunction, MatlabOpaque, MatReadWarning, matfile_version

from gear_damping.measurement.formats.header import bracket_unit
from gear_damping.measurement.formats.mat_cells import MIXED, columns_of, is_scattered
from gear_damping.measurement.formats.names_beside import named_columns, text_lists
from gear_damping.measurement.formats.not_applied import said_beside
from gear_damping.measurement.formats.octave_text import BEGIN as OCTAVE
from gear_damping.measurement.formats.octave_text import octave_table
from gear_damping.measurement.formats.stated_rate import rate_beside
from gear_damping.measurement.formats.table import (
    ArrayTable,
    Table,
    extra_library,
    held_arrays,
    is_real,
    refuse_size,
    unreadable,
)
from gear_damping.measurement.formats.units_beside import units_beside

SUFFIXES = (".mat",)
DEADLY = True  # a damaged file may end the process

_HDF5_MAGIC = b"\x89HDF"
_COMPRESSED = 15  # the type of an element that is deflated
_WRITERS = {"table": "writetable", "timetable": "writetimetable"}  # by the class of an object, what saves it as text
_NAMELESS = "None"  # what scipy calls an object that is a variable of its own
_FIELD = re.compile(r"^(?P<array>.+)\.(?P<field>\w+)\[(?P<element>\d+)\]$")  # of an element of an array of structures
_STEP, _STEP_IN = ".x_values.increment", ".x_values.quantity.label"  # of the abscissa in files of Simcenter
_NAME = re.compile(r"^(channel_?)?(name|label)$", re.I)  # the field that says what an element is


class _Object(str):
    """What is said of an object of MATLAB, whose arrays are not read."""


def read(path: Path, max_bytes: int) -> Table:
    """The real arrays of a MAT file as columns, those in structures and cells too.

    Raises:
        InputError: an unreadable or too large file, no real numbers, or pymatreader is missing for version 7.3.
    """
    with unreadable(path, "not a readable MAT file", "save it in MATLAB with `save -v7`"):
        if (saved_as_text := _octave_text(path, max_bytes)) is not None:
            return saved_as_text
        content = _read_hdf5(path, max_bytes) if _is_hdf5(path) else _read_older(path, max_bytes)
        found = dict(_flat(content, ""))
    arrays = {name: value for name, value in found.items() if isinstance(value, np.ndarray)}
    held, left_out = held_arrays(arrays)
    vectors, words = _apart(found)
    own, units = _own_names(found), units_beside(vectors, words)
    held = [replace(one, unit=units.get(one.name)) for one in held]
    held = [replace(one, name=own[one.name], also=one.name) if one.name in own else one for one in held]
    held = [replace(one, unit=bracket_unit(one.name) or one.unit) for one in held]
    texts = {name: "text" if isinstance(value, np.str_) else value for name, value in found.items()}
    left_out += [f"{name} ({what})" for name, what in texts.items() if name not in arrays]
    table = ArrayTable(path, named_columns(held, text_lists(words, arrays)), left_out)
    table.notes += said_beside(path.name, {name: one.item() for name, one in arrays.items() if _is_number(one)})
    over_time = {name: one for name, one in arrays.items() if not _is_over_something(name, found)}
    table.stated_rate = rate_beside(over_time, words)
    return table


def _is_number(array: NDArray) -> bool:
    return array.size == 1 and is_real(array.dtype)


def _apart(found: Mapping[str, NDArray | str]) -> tuple[list[str], dict[str, str]]:
    """The names of the arrays of more than one real number, and the texts by their names."""
    arrays = {name: value for name, value in found.items() if isinstance(value, np.ndarray)}
    vectors = [name for name, value in arrays.items() if is_real(value.dtype) and value.size > 1]
    return vectors, {name: str(value) for name, value in found.items() if isinstance(value, np.str_)}


def _is_over_something(name: str, found: Mapping[str, NDArray | str]) -> bool:
    """Whether a number is the step of an abscissa that is no time in s, as its unit says."""
    return name.endswith(_STEP) and str(found.get(f"{name.removesuffix(_STEP)}{_STEP_IN}", "")) != "s"


def _own_names(found: Mapping[str, NDArray | str]) -> dict[str, str]:
    """What elements of arrays of structures are called by a field of theirs, where each has one vector beside it."""
    names: dict[tuple[str, str], str] = {}
    vectors: dict[str, dict[str, dict[str, str]]] = {}
    for path, value in found.items():
        place = _FIELD.match(path)
        if place is None:
            continue
        if isinstance(value, np.str_) and _NAME.match(place["field"]):
            names[place["array"], place["element"]] = str(value).strip()
        elif isinstance(value, np.ndarray) and is_real(value.dtype) and value.size > 1:
            vectors.setdefault(place["array"], {}).setdefault(place["field"], {})[path] = place["element"]
    own = {
        path: names.get((array, element), "")
        for array, fields in vectors.items()
        if len(fields) == 1
        for path, element in next(iter(fields.values())).items()
    }
    borne = Counter(own.values())
    return {path: name for path, name in own.items() if name and borne[name] == 1 and name not in found}


def _octave_text(path: Path, max_bytes: int) -> Table | None:
    """What Octave saves as text whatever the ending, even of one variable; None of any other file."""
    with path.open("rb") as file:
        if file.read(len(OCTAVE)) != OCTAVE:
            return None
    refuse_size(path, path.stat().st_size, max_bytes)
    return octave_table(path, path.read_bytes(), fewest=1)


def _is_hdf5(path: Path) -> bool:
    with path.open("rb") as file:
        head = file.read(128)
        file.seek(512)
        return head.startswith((b"MATLAB 7.3", _HDF5_MAGIC)) or file.read(4) == _HDF5_MAGIC


def _read_older(path: Path, max_bytes: int) -> dict[str, Any]:
    refuse_size(path, _unpacked_size(path, max_bytes), max_bytes)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MatReadWarning)  # of what it cannot hold; what is missing is not listed
        content = loadmat(path, squeeze_me=True)
    content = {name: value for name, value in content.items() if not name.startswith("__")}
    if isinstance(one := content.get(_NAMELESS), MatlabOpaque):
        del content[_NAMELESS]
        content[_word(one["s0"])] = one
    return content


def _word(value: Any) -> str:
    """The one word that a field of an object holds."""
    word = np.ravel(value)[0]
    return word.decode("utf-8", "replace") if isinstance(word, bytes) else str(word)


def _said_of(kind: str, name: str) -> _Object:
    """What is said of an object of a class, and how its numbers are saved in MATLAB."""
    if kind in _WRITERS:
        return _Object(f"MATLAB object; in MATLAB write it as text, {_WRITERS[kind]}({name}, 'data.csv')")
    return _Object(f"MATLAB object; in MATLAB save its arrays, as t = {name}.Time; y = {name}.Data")


def _unpacked_size(path: Path, limit: int) -> int:
    """The bytes of the unpacked elements of a version 5 to 7 file, counted until they pass `limit`."""
    if matfile_version(path)[0] != 1:
        return path.stat().st_size
    total = 0
    with path.open("rb") as file:
        order = "little" if file.read(128)[126:128] == b"IM" else "big"
        while len(tag := file.read(8)) == 8 and total <= limit:
            kind, size = int.from_bytes(tag[:4], order), int.from_bytes(tag[4:], order)
            packed = file.read(size)
            if kind != _COMPRESSED:
                total += size
                continue
            unpack = zlib.decompressobj()
            while packed and total <= limit:
                total += len(unpack.decompress(packed, 2**20))
                packed = unpack.unconsumed_tail
    return total


def _is_matlabs(path: Path) -> bool:
    """Whether MATLAB's head stands before the HDF5 of a file; other programs may leave it out."""
    with path.open("rb") as file:
        return file.read(4) != _HDF5_MAGIC


def _tree(h5py: Any, group: Any) -> dict[str, Any]:
    """The groups and arrays of a file that is HDF5 alone, by their names; what holds no numbers is a word on it."""
    found: dict[str, Any] = {}
    for name, item in group.items():
        if isinstance(item, h5py.Group):
            found[name] = _tree(h5py, item)
        else:
            found[name] = np.squeeze(item[()]) if item.dtype.kind in "fiubc" and item.size else "text"
    return found


def _read_hdf5(path: Path, max_bytes: int) -> dict[str, Any]:
    h5py, pymatreader = extra_library("h5py", path), extra_library("pymatreader", path)
    sizes, objects = [], {}

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            sizes.append(item.size * item.dtype.itemsize if item.size else 0)
        if "MATLAB_object_decode" in item.attrs:
            objects[name] = _word(item.attrs.get("MATLAB_class", b""))

    with h5py.File(path, "r") as file:
        file.visititems(visit)
        names = [name for name in file if not name.startswith("#")]
    refuse_size(path, sum(sizes), max_bytes)
    if not _is_matlabs(path):
        with h5py.File(path, "r") as file:
            return _tree(h5py, file)
    plain = [name for name in names if name not in objects]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of classes, which are left out here and said
        content = pymatreader.read_mat(path, variable_names=plain) if plain else {}
    for place, kind in objects.items():
        *parents, last = place.split("/")
        inner = content
        for parent in parents:
            inner = inner.get(parent) if isinstance(inner, dict) else None
        if isinstance(inner, dict):
            inner[last] = _said_of(kind, place.replace("/", "."))
    return {name: content[name] for name in names}


def _flat(value: Any, name: str) -> Iterator[tuple[str, NDArray | str]]:
    """Every array and text (`np.str_`) in nested structures and cells under its name; a `str` says what else it is."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _flat(inner, f"{name}.{key}" if name else key)
    elif isinstance(value, MatlabOpaque):
        yield name, _said_of(_word(value["s2"]), name)
    elif isinstance(value, _Object):
        yield name, value
    elif isinstance(value, MatlabFunction):
        yield name, "MATLAB function"
    elif isinstance(value, np.ndarray) and value.dtype.names:
        for field in value.dtype.names:
            yield from _flat(value[field], f"{name}.{field}")
    elif isinstance(value, list) or (isinstance(value, np.ndarray) and value.dtype == object):
        yield from _flat_cells(value, name)
    elif isinstance(value, np.ndarray | int | float | complex | np.number | np.bool_):
        yield name, np.asarray(value)
    else:
        yield name, np.str_(value) if isinstance(value, str) else type(value).__name__


def _flat_cells(cells: list | NDArray, name: str) -> Iterator[tuple[str, NDArray | str]]:
    """The columns of a cell array that holds a table, else its elements in MATLAB's linear order.

    Where each holds one number, the row or the column of them is a vector.
    """
    table = columns_of(cells) if isinstance(cells, np.ndarray) else None
    if table is not None:
        yield from ((f"{name}.{heading}" if heading else name, column) for heading, column in table)
        return
    elements = cells if isinstance(cells, list) else list(cells.flatten(order="F"))
    if len(elements) == 1 and isinstance(cells, np.ndarray):
        yield from _flat(elements[0], name)
    elif elements and all(isinstance(one, int | float | np.number) for one in elements):
        yield name, np.asarray(elements)
    elif isinstance(cells, np.ndarray) and is_scattered(cells):
        yield name, MIXED
    else:
        for k, one in enumerate(elements):
            yield from _flat(one, f"{name}[{k}]")
