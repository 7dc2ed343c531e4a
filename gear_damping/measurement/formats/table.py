"""What every reader returns: named columns, read when they are asked for."""

from abc import ABC, abstractmethod
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem, nearest


class Table(ABC):
    """The columns of one file.

    Args:
        path: The file.
        names: Column names in the order of the file; "" for one without a name.
    """

    def __init__(self, path: Path, names: tuple[str, ...]) -> None:
        self.path = path
        self.names = names
        self.sampling_rate: float | None = None  # Hz, where the format itself holds it
        self.full_scale: float | None = None  # the value of full scale, where samples are fractions of it
        self.notes: tuple[str, ...] = ()

    @abstractmethod
    def values(self, index: int) -> NDArray[np.float64]:
        """(n,) float64: the column at a 0-based index; raises InputError where it cannot be read."""

    def unit(self, index: int) -> str | None:
        """The unit that the file itself gives for a column, or None."""
        return None

    def index(self, column: str | int, key: str) -> int:
        """The 0-based index of `column`, a name or an index.

        Raises:
            InputError: there is no such column, or several bear the name.
        """
        if isinstance(column, int):
            if 0 <= column < len(self.names):
                return column
            rule = f"{self.path.name} has {len(self.names)} columns"
            raise InputError(Problem(key, rule, column, f"count from 0: {self.listing()}", str(self.path)))
        found = [index for index, name in enumerate(self.names) if name == column]
        if len(found) == 1:
            return found[0]
        if found:
            rule, remedy = f"{len(found)} columns bear this name", f"give the 0-based index: one of {found}"
            raise InputError(Problem(key, rule, column, remedy, str(self.path)))
        named = [name for name in self.names if name]
        remedy = nearest(column, named) if named else f"give a 0-based index: {self.listing()}"
        raise InputError(Problem(key, "no such column", column, remedy, str(self.path)))

    def listing(self) -> str:
        """The columns in one line, for messages."""
        shown = [f"{index} '{name}'" if name else str(index) for index, name in enumerate(self.names[:20])]
        return ", ".join(shown) + (", ..." if len(self.names) > 20 else "")


class ArrayTable(Table):
    """Columns that are in memory already."""

    def __init__(self, path: Path, columns: dict[str, NDArray] | list[NDArray]) -> None:
        named = columns if isinstance(columns, dict) else {str(i): c for i, c in enumerate(columns)}
        super().__init__(path, tuple(named) if isinstance(columns, dict) else ("",) * len(named))
        self._columns = list(named.values())

    def values(self, index: int) -> NDArray[np.float64]:
        """(n,) float64: the column at a 0-based index."""
        return np.asarray(self._columns[index], dtype=np.float64)


def split_arrays(arrays: dict[str, NDArray]) -> dict[str, NDArray]:
    """Real numeric arrays as columns: vectors under their name, matrices as `name[0]`, `name[1]`, ...

    The longer side of a matrix is taken as time; what is no real numbers is left out.
    """
    columns: dict[str, NDArray] = {}
    for name, array in arrays.items():
        if array.dtype.kind not in "fiub" or array.ndim > 2 or array.size == 0:
            continue
        if array.ndim < 2 or 1 in array.shape:
            columns[name] = array.reshape(-1)
            continue
        matrix = array if array.shape[0] >= array.shape[1] else array.T
        columns.update({f"{name}[{k}]": matrix[:, k] for k in range(matrix.shape[1])})
    return columns


def refuse_size(path: Path, size: int, limit: int) -> None:
    """Raise InputError where a file would take more than `limit` bytes."""
    if size > limit:
        rule = f"{size / 1e6:.0f} MB are more than the {limit / 1e6:.0f} MB that are read at once"
        raise InputError(Problem("file", rule, str(path), "cut it into several records, or resample it"))
