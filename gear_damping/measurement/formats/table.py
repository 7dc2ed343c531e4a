"""What every reader returns: the real numeric arrays of a file as columns, read when they are asked for."""

import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from math import isfinite
from numbers import Real
from pathlib import Path
from types import ModuleType
from unicodedata import normalize

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.measurement.formats.blocks import Block
from gear_damping.measurement.formats.unit_words import as_ours

CLOCK = 2  # numbers of a clock: the first time and the rate
_SHOWN = 20  # arrays that a message lists
_UNIT_AT_ONCE = re.compile(r"/\(?[^/()\s]+(/\w+[²³^\d]*)?\)?$")  # `x/mm`, `a/(m/s²)`
_UNIT_BEHIND = re.compile(r"\s*([(\[](?![\d, ]*[)\]])[^()\[\]]*[)\]](\s*run\s*#?\s*\d+)?|\s/\s*\S+)$", re.I)
_OF_ARRAY = re.compile(r"^(.+)\[(\d+)\]\.(\w+)$")  # `runs[0].t`, the member of a structure in an array of them
_SMALL = 5e5  # bytes, below which a size in whole MB is said as none
_INDEXED = re.compile(r"^(.*)\[[\d, ]+\]$")
_OF_MATLAB = re.compile(r"\((?::,\s*)?([1-9]\d*)\)")  # `runs(2).te`, `data(:,2)`, which count from 1


class Table(ABC):
    """The columns of one file; they may differ in length.

    Args:
        path: The file.
        shapes: The arrays in the order of the file, each with its name ("" for none) and its shape. A vector is a
            column under its name; a matrix gives the columns `name[0]`, `name[1]`, ... along its shorter side.
        left_out: What the file holds besides real numbers, for messages.
    """

    def __init__(self, path: Path, shapes: Sequence[tuple[str, tuple[int, ...]]], left_out: Sequence[str] = ()) -> None:
        self.path, self.shapes, self.left_out = path, tuple(shapes), tuple(left_out)
        columns = [
            (_column_name(name, rest), array, rest, max(shape))
            for array, (name, shape) in enumerate(self.shapes)
            for rest in np.ndindex(*_beside_time(shape))
        ]
        self.names = tuple(column[0] for column in columns)
        self.lengths = tuple(column[3] for column in columns)
        self._place = [(column[1], column[2]) for column in columns]
        self.sampling_rate: float | None = None  # Hz, where the format itself holds one for the whole file
        self.stated_rate: tuple[str, float] | None = None  # its name in lines above, or attributes; Hz; a guess
        self.unread_rate = ""  # the line above that states one whose number or unit is not read
        self.blocks: tuple[Block, ...] = ()  # rows below headers of their own, where these state other rates
        self.stated_rates: dict[str, tuple[str, float]] = {}  # the same of groups, by their path
        self.full_scale: float | None = None  # the value of full scale, where samples are fractions of it
        self.not_applied: dict[str, dict[str, float]] = {}  # factors and zeros beside arrays, by the name of these
        self.notes: tuple[str, ...] = ()
        self.has_groups = False  # whether names are paths, of groups of arrays or sheets of columns

    @abstractmethod
    def values(self, index: int) -> NDArray[np.float64]:
        """(n,) float64: the column at a 0-based index; raises InputError where it cannot be read."""

    def cells(self, index: int) -> NDArray:
        """(n,) the cells of a column as they stand: numbers, or texts where not every cell is one."""
        return self.values(index)

    def unit(self, index: int) -> str | None:
        """The unit that the file itself gives for a column, or None."""
        return None

    def also(self, index: int) -> tuple[str, ...]:
        """Other names by which a column may be asked for."""
        return ()

    def clock(self, index: int) -> tuple[float, float] | None:
        """The time of a column's first sample in s and its rate in Hz, where the file gives them."""
        return None if self.sampling_rate is None else (0.0, self.sampling_rate)

    def begins(self, index: int) -> float | None:
        """When the first stamp of a column was, in s on a clock of the file, where its stamps count from that one."""
        return None

    def index(self, column: str | int, key: str) -> int:
        """The 0-based index of `column`, a name or an index.

        Raises:
            InputError: there is no such column, it is a matrix, or several bear the name.
        """
        if isinstance(column, int):
            if 0 <= column < len(self.names):
                return column
            rule, remedy = f"{self.path.name} has {len(self.names)} columns", f"count from 0: {self.listing(True)}"
            raise InputError(Problem(key, rule, column, remedy, str(self.path)))
        found = self._named(column) or self._of_array(column)
        if not found and column.strip().isdecimal() and not any(self.names):
            return self.index(int(column), key)
        if len(found) == 1:
            return found[0]
        if found:
            rule, remedy = f"{len(found)} columns bear this name", f"give the 0-based index: one of {found}"
            raise InputError(Problem(key, rule, column, remedy, str(self.path)))
        raise InputError(self._absent(column, key))

    def bad_cells(self, index: int, first: int, stop: int) -> list[Problem]:
        """What is wrong with cells of a column in some rows; of a table of numbers nothing."""
        return []

    def empty_cells(self, index: int) -> list[int]:
        """The rows in which a column has a cell with nothing in it; of a table of numbers none."""
        return []

    def scales(self, index: int) -> dict[str, float]:
        """The factors and zeros that the file states beside a column, by their names: values are without them."""
        return self.not_applied.get(self.shapes[self._place[index][0]][0], {})

    def _named(self, column: str) -> list[int]:
        """Those of the very name, else of its letters in other codes (µ and μ), of the last part of its path, or of
        all of it before a unit in brackets or behind a stroke.
        """
        own = [normalize("NFKC", name) for name in self.names]
        last = [name.rpartition("/")[2] for name in own]
        alike, bare = normalize("NFKC", column), [_UNIT_BEHIND.sub("", name) for name in own]
        before = [_UNIT_AT_ONCE.sub("", name) for name in own]
        for names, sought in ((self.names, column), (own, alike), (last, alike), (bare, alike), (before, alike)):
            if found := [index for index, name in enumerate(names) if name and name == sought]:
                return found
        return [index for index in range(len(self.names)) if column.strip() in self.also(index)]

    def _of_array(self, column: str) -> list[int]:
        """The member of a structure in an array of them, `runs[0].t`, which is `runs.t[0]`."""
        return self._named(_OF_ARRAY.sub(r"\1.\3[\2]", column.strip().strip("/")))

    def _absent(self, column: str, key: str) -> Problem:
        named = [name for name in self.names if name]
        if not named:
            return Problem(key, "no such column", column, f"give a 0-based index: {self.listing(True)}", str(self.path))
        indexed = _INDEXED.match(column)
        shapes = dict(self.shapes)
        base = (indexed[1] if indexed else column).strip().strip("/")
        if base in shapes and len(_beside_time(shapes[base])) > 0:
            choice = [name for name in named if name.startswith(f"{base}[")]
            rule = f"'{base}' is {_shape(shapes[base])}, and one column of it is needed"
            return Problem(key, rule, column, f"write one of {choice[0]} to {choice[-1]}", str(self.path))
        counted = _OF_MATLAB.sub(lambda one: f"[{int(one[1]) - 1}]", column.strip())
        if counted != column.strip() and len(self._of_array(counted)) == 1:
            return Problem(key, "no such column", column, f"write {counted}: here it counts from 0", str(self.path))
        sought = column.strip().casefold()
        begun = next((name for name in named if name.casefold().startswith(sought)), None)
        meant = f"did you mean '{begun}'" if begun else nearest(column, named).rstrip("?")
        remedy = meant + f"? {self.path.name} holds {self.listing()}"
        if not remedy.startswith("did you mean"):
            remedy = f"{self.path.name} holds {self.listing()}"
        return Problem(key, "no such column", column, remedy, str(self.path))

    def listing(self, numbered: bool = False) -> str:
        """What the file holds with shapes, in one line for messages; `numbered` puts the index before each."""
        shown, first = [], 0
        for name, shape in self.shapes[:_SHOWN]:
            label = f"{first} '{name}'" if numbered and name else name or str(first)
            shown.append(f"{label} ({_shape(shape)})")
            first += int(np.prod(_beside_time(shape)))
        if len(self.shapes) > _SHOWN:
            shown.append(f"... ({len(self.shapes)} in all)")
        unread = f"; no real numbers: {', '.join(self.left_out[:_SHOWN])}" if self.left_out else ""
        return ", ".join(shown) + unread


def _shape(shape: tuple[int, ...]) -> str:
    return " x ".join(str(size) for size in shape)


def _beside_time(shape: tuple[int, ...]) -> tuple[int, ...]:
    """The sides of an array besides its longest one, which is time."""
    time = int(np.argmax(shape))
    return shape[:time] + shape[time + 1 :]


def _column_name(name: str, rest: tuple[int, ...]) -> str:
    return f"{name}[{','.join(str(k) for k in rest)}]" if name and rest else name


@dataclass(frozen=True, eq=False)
class Held:
    """An array that a file holds.

    Args:
        name: Its name or path in the file; "" for none.
        shape: Its shape without sides of one element.
        read: Gives the array itself, of any shape with those elements.
        unit: Its unit, where the file says it.
        clock: The time of its first sample in s and its rate in Hz, where the file says them.
        begins: When the first was, of stamps that count from it, as `Moments` has it.
        also: Another name, by which it may be asked for too.
    """

    name: str
    shape: tuple[int, ...]
    read: Callable[[], NDArray]
    unit: str | None = None
    clock: tuple[float, float] | None = None
    begins: Callable[[], float] | None = None
    also: str = ""

    def __post_init__(self) -> None:
        """Say at once what a reader hands over wrongly."""
        if not isinstance(self.name, str):
            raise ValueError(f"the name of an array is a text, and not {self.name!r}")
        if not isinstance(self.unit, str | None):
            raise ValueError(f"the unit of '{self.name}' is a text or None, and not {self.unit!r}")
        if not callable(self.read):
            raise ValueError(f"read of '{self.name}' gives the array when it is called: write array.copy for it")
        if self.clock is None:
            return
        numbers = [end for end in self.clock if isinstance(end, Real)] if isinstance(self.clock, tuple) else []
        if len(numbers) != CLOCK or not all(map(isfinite, numbers)) or numbers[1] <= 0:
            raise ValueError(f"the clock of '{self.name}' is (first sample in s, rate in Hz), and not {self.clock!r}")


class ArrayTable(Table):
    """Columns of arrays, each of which is read once, when it is first asked for.

    Raises:
        InputError: the file holds no real numbers.
    """

    def __init__(self, path: Path, held: Sequence[Held], left_out: Sequence[str] = ()) -> None:
        super().__init__(path, [(one.name, one.shape) for one in held], left_out)
        if not held:
            rule = "holds no array of real numbers" + (f", only {', '.join(left_out[:_SHOWN])}" if left_out else "")
            raise InputError(Problem("file", rule, str(path), "save the channels as numeric vectors or matrices"))
        self._held, self._arrays, self.has_groups = list(held), {}, True
        clocks = {one.clock for one in held}
        if len(clocks) == 1 and None not in clocks:
            self.sampling_rate = held[0].clock[1]

    def also(self, index: int) -> tuple[str, ...]:
        """The other name of the column's array, where it has one."""
        return tuple(filter(None, (self._held[self._place[index][0]].also,)))

    def values(self, index: int) -> NDArray[np.float64]:
        """(n,) float64: the column at a 0-based index; raises InputError where the file is damaged there."""
        array, rest = self._place[index]
        one = self._held[array]
        if array not in self._arrays:
            with unreadable(self.path, f"'{one.name or array}' cannot be read", "export the file again"):
                self._arrays[array] = np.reshape(_real(one.read()), one.shape)
        whole = self._arrays[array]
        return np.asarray(np.moveaxis(whole, int(np.argmax(one.shape)), 0)[(slice(None), *rest)], dtype=np.float64)

    def unit(self, index: int) -> str | None:
        """The unit that the file gives for the column's array, or None."""
        said = self._held[self._place[index][0]].unit
        return said and as_ours(said)

    def clock(self, index: int) -> tuple[float, float] | None:
        """The time of the column's first sample in s and its rate in Hz, where the file gives them."""
        return self._held[self._place[index][0]].clock or super().clock(index)

    def begins(self, index: int) -> float | None:
        """When the first stamp of the column's array was, where its stamps count from that one."""
        begins = self._held[self._place[index][0]].begins
        return begins() if begins else None


def _real(array: NDArray) -> NDArray:
    """Refuse what is complex, of which a copy as real numbers would lose a part, and what is no numbers."""
    if np.iscomplexobj(array):
        raise ValueError("it is complex, and a channel is real: write its real part, its size or its phase")
    return np.asarray(array, dtype=np.float64) if np.asarray(array).dtype.kind in "USO" else array


def squeezed(shape: Sequence[int]) -> tuple[int, ...]:
    """A shape without sides of one element; (1,) where nothing else is left."""
    return tuple(int(size) for size in shape if size != 1) or (1,)


def is_real(dtype: np.dtype) -> bool:
    """Whether values of this kind are real numbers."""
    return dtype.kind in "fiub"


def held_arrays(arrays: Mapping[str, NDArray]) -> tuple[list[Held], list[str]]:
    """Arrays in memory as columns, and what of them is left out because it is empty or no real numbers."""
    held, left_out = [], []
    for name, array in arrays.items():
        if is_real(array.dtype) and array.size:
            held.append(Held(name, squeezed(array.shape), lambda array=array: array))
        elif array.dtype.kind in "mM" and array.size:
            held.append(_stamps(name, array))
        else:
            left_out.append(f"{name} ({'empty' if not array.size else kind_of(array.dtype)})")
    return held, left_out


def _stamps(name: str, array: NDArray) -> Held:
    """Dates and durations of numpy, in s: dates from the first one, what is none as nan."""
    first = array.flat[0] if array.dtype.kind == "M" else np.timedelta64(0, "s")
    begun = float((first - np.datetime64("2000-01-01")) / np.timedelta64(1, "s")) if array.dtype.kind == "M" else None
    begins = None if begun is None else lambda: begun
    return Held(name, squeezed(array.shape), lambda: (array - first) / np.timedelta64(1, "s"), "s", begins=begins)


def kind_of(dtype: np.dtype) -> str:
    """What values of this kind are, for messages."""
    return {"c": "complex", "U": "text", "S": "text", "O": "objects"}.get(dtype.kind, str(dtype))


@contextmanager
def unreadable(path: Path, rule: str, remedy: str) -> Iterator[None]:
    """Turn whatever a library raises over a damaged file into an InputError with the reason in brackets."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:  # libraries raise whatever a damaged file leads them to
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError(Problem("file", f"{rule} ({reason})", str(path), remedy)) from None


def extra_library(name: str, path: Path) -> ModuleType:
    """A library of the extra [formats]; raises InputError that names it where its import fails."""
    try:
        return import_module(name)
    except ImportError as error:
        rule = f"reading this file needs the library '{name}', which cannot be imported ({error})"
        remedy = "pip install 'gear-damping[formats]', or export the channels as CSV, MAT v7, NPZ or WAV"
        raise InputError(Problem("file", rule, str(path), remedy)) from None


def refuse_size(path: Path, size: int, limit: int) -> None:
    """Raise InputError where a file would take more than `limit` bytes."""
    if size > limit:
        places = 6 if size < _SMALL else 0
        rule = f"{size / 1e6:.{places}f} MB are more than the {limit / 1e6:.{places}f} MB that are read at once"
        raise InputError(Problem("file", rule, str(path), "cut it into several records, or resample it"))
