"""Blocks of a text table, each below a header of its own, where these state other rates (LabVIEW's segments)."""

from bisect import bisect
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from gear_damping.measurement.formats.stated_rate import stated_rate, unread_rate

_LISTED = 6  # blocks that a message lists


@dataclass(frozen=True)
class Block:
    """Rows first to stop - 1, the words that state their rate, and the rate in Hz; None where it is not read."""

    first: int
    stop: int
    said: str
    rate: float | None


def blocks_of(
    lines: Sequence[int],
    headers: Sequence[tuple[int, list[list[str]]]],
    stated: tuple[str, float] | None,
    decimal: str,
) -> tuple[Block, ...]:
    """The blocks of a table; () where all of them are of one rate, or none is stated.

    Args:
        lines: The line of the file that each row of values stands in.
        headers: The line and the cells of every header but the first.
        stated: The words of the first one that state a rate, and the rate in Hz.
        decimal: The decimal sign of the file.
    """
    found = [Block(0, 0, *(stated or ("", None)))]
    for line, rows in headers:
        if own := stated_rate(rows, decimal=decimal):
            found.append(Block(bisect(lines, line), 0, *own))
        else:
            unread = unread_rate(rows, decimal)
            found.append(Block(bisect(lines, line), 0, unread or found[-1].said, None if unread else found[-1].rate))
    ends = [*(one.first for one in found), len(lines)]
    found = [replace(one, stop=stop) for one, (first, stop) in zip(found, pairwise(ends), strict=True) if stop > first]
    return tuple(found) if len({one.rate and f"{one.rate:.5g}" for one in found}) > 1 else ()


def overlapping(blocks: Sequence[Block], first: int, stop: int) -> list[Block]:
    """Those that have one of the rows first to stop - 1."""
    return [one for one in blocks if one.first < stop and first < one.stop]


def listed(blocks: Sequence[Block]) -> str:
    """The rows of some blocks with their rates, as a message lists them."""
    said = (f"[{one.first}, {one.stop}] ({f'{one.rate:.6g} Hz' if one.rate else one.said})" for one in blocks[:_LISTED])
    return ", ".join(said) + (" and so on" if len(blocks) > _LISTED else "")
