"""HDF5 files: every dataset of real numbers under its path, fields of compound datasets as `path.field`."""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.formats.names_beside import named_columns
from gear_damping.measurement.formats.not_applied import not_applied, said_of
from gear_damping.measurement.formats.stated_rate import beside_their_units, stated_rate
from gear_damping.measurement.formats.table import (
    ArrayTable,
    Held,
    Table,
    extra_library,
    is_real,
    kind_of,
    refuse_size,
    squeezed,
    unreadable,
)

SUFFIXES = (".h5", ".hdf5", ".hdf")
DEADLY = True  # a damaged file may end the process

_SINCE = re.compile(r"\s+since\s.*$", re.I | re.S)  # a time counts from
_UNIT_ATTRIBUTES = ("unit", "units", "Unit", "Units", "unit_string")


def read(path: Path, max_bytes: int) -> Table:
    """The datasets of an HDF5 file as columns.

    Raises:
        InputError: not an HDF5 file, too large when unpacked, no real numbers, or h5py is missing.
    """
    h5py = extra_library("h5py", path)
    held, left_out = [], []
    with unreadable(path, "not a readable HDF5 file", "export it again"), h5py.File(path, "r") as file:
        items = _items(file)
        datasets = [item for item in items if isinstance(item, h5py.Dataset)]
        refuse_size(path, sum(one.size * one.dtype.itemsize for one in datasets if one.size), max_bytes)
        for dataset in datasets:
            found = [field for field in _fields(dataset) if is_real(field[2])]
            if not found or not dataset.size:
                kind = "text" if h5py.check_string_dtype(dataset.dtype) else kind_of(dataset.dtype)
                left_out.append(f"{dataset.name.strip('/')} ({kind if dataset.size else 'empty'})")
                continue
            held += [_held(h5py, path, dataset, field) for field in found]
        lists = _text_lists(h5py, datasets)
        groups = [one for one in items if not isinstance(one, h5py.Dataset)]
        settings = _settings(groups)
        rates = {one.name.strip("/"): stated for one in groups if (stated := stated_rate(_settings([one])))}
        left = {name: scales for one in datasets if (scales := not_applied(one.attrs)) for name, *_ in _fields(one)}
    table = ArrayTable(path, named_columns(held, lists), left_out)
    table.stated_rate = stated_rate(settings)
    table.stated_rates = rates
    table.not_applied = left
    table.notes += said_of(path.name, left)
    return table


def _items(file: Any) -> list[Any]:
    """The file, its groups and datasets in the order of their paths; links to other files are not followed."""
    found = [file]
    file.visititems(lambda _, item: found.append(item))
    return found


def _settings(groups: Iterable[Any]) -> list[list[str]]:
    """The attributes of groups or datasets, each with its name, its value and its unit."""
    return [row for group in groups for row in beside_their_units(dict(group.attrs))]


def _text_lists(h5py: Any, datasets: Iterable[Any]) -> dict[str, list[str]]:
    """The lists of texts in a file by their names: datasets of texts, and attributes of datasets."""
    lists = {}
    for one in datasets:
        found = {name: value for name, value in one.attrs.items() if np.ndim(value) == 1}
        if h5py.check_string_dtype(one.dtype) and one.ndim == 1:
            found[one.name] = one[()]
        for name, value in found.items():
            texts = [text.decode("utf-8", "replace") if isinstance(text, bytes) else text for text in value]
            if all(isinstance(text, str) for text in texts):
                lists[f"{one.name}/{name}"] = texts
    return lists


def _fields(dataset: Any) -> Iterator[tuple[str, str | None, np.dtype, tuple[int, ...]]]:
    """Name, field, kind and shape of what a dataset holds: itself, or the fields of a compound one."""
    name, dtype = dataset.name.strip("/"), dataset.dtype
    if dtype.names is None:
        yield name, None, dtype, dataset.shape
        return
    for field in dtype.names:
        yield f"{name}.{field}", field, dtype[field].base, (*dataset.shape, *dtype[field].shape)


def _held(h5py: Any, path: Path, dataset: Any, field: tuple[str, str | None, np.dtype, tuple[int, ...]]) -> Held:
    name, part, _, shape = field
    place = dataset.name

    def read() -> NDArray:
        with h5py.File(path, "r") as file:
            return file[place][()] if part is None else file[place][part]

    stated = stated_rate(_settings([dataset]))
    clock = (0.0, stated[1]) if stated else None
    return Held(name, squeezed(shape), read, _unit(dataset) if part is None else None, clock)


def _unit(dataset: Any) -> str | None:
    """The unit that an attribute gives; of `milliseconds since 2024-01-01`, as climate and pandas have it, ms."""
    for name in _UNIT_ATTRIBUTES:
        value = dataset.attrs.get(name)
        value = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
        if isinstance(value, str) and value.strip():
            return _SINCE.sub("", value.strip())
    return None
