"""Packs what the equation needs of each member into the rows of one tensor, and back.

One tensor of shape (rows, batch) can be gathered by member and handed to a compiled kernel.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

from gear_damping.physics.model import Prepared

Named = dict[str, Tensor]
BASE = ""  # the group of the system's own values
INTERVAL_ROW = 0  # of the natural time between two outputs


@dataclass(frozen=True)
class Entry:
    """The rows of one value; `vector` keeps its leading dimension."""

    group: str
    name: str
    start: int
    stop: int
    vector: bool


class Layout:
    """Which rows hold which value; the same for every batch of one model."""

    def __init__(self, prepared: Prepared) -> None:
        """Number the rows of everything in `prepared`, after the output interval in its row."""
        self.entries: list[Entry] = []
        self.groups = (BASE, *prepared.terms)
        row = 1
        for group, name, value in _walk(prepared):
            height = value.shape[0] if value.ndim == 2 else 1
            self.entries.append(Entry(group, name, row, row + height, value.ndim == 2))
            row += height
        self.rows = row

    def pack(self, prepared: Prepared, interval: Tensor) -> Tensor:
        """Everything in one tensor (rows, batch); `interval` has shape (batch,)."""
        found = {(group, name): value for group, name, value in _walk(prepared)}
        parts = [interval.unsqueeze(0)]
        for entry in self.entries:
            value = found[entry.group, entry.name]
            parts.append(value if entry.vector else value.unsqueeze(0))
        return torch.cat(parts)

    def unpack(self, packed: Tensor) -> tuple[Tensor, Named, dict[str, Named]]:
        """The output interval, the system's values and those of each effect."""
        groups: dict[str, Named] = {group: {} for group in self.groups}
        for entry in self.entries:
            value = packed[entry.start : entry.stop] if entry.vector else packed[entry.start]
            groups[entry.group][entry.name] = value
        base = groups.pop(BASE)
        return packed[0], base, groups


def _walk(prepared: Prepared) -> list[tuple[str, str, Tensor]]:
    groups: dict[str, Mapping[str, Tensor]] = {BASE: prepared.base, **prepared.terms}
    return [(group, name, value) for group, values in groups.items() for name, value in values.items()]
