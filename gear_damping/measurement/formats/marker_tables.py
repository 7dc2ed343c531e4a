"""The head of a file of markers (TRC, of motion capture): two rows of names, and the unit in a row of settings."""

from collections.abc import Sequence

_FIRST, _NAMES = "PathFileType", "Frame#"  # the words that the file and its row of names begin with
_SETTINGS = 3  # rows of them: what the file is, names of settings, their values
_UNITS = "Units"  # the name of that of the coordinates


def of_markers(rows: Sequence[Sequence[str]]) -> tuple[tuple[str, ...], tuple[str, ...], int] | None:
    """Names, `Knee.X1`, and units of the columns, and the row that the values may begin in; None of any other file."""
    begun = next((k for k, row in enumerate(rows) if row and row[0].strip() == _NAMES), len(rows))
    if not _SETTINGS <= begun < len(rows) - 1 or rows[0][0].strip() != _FIRST:
        return None
    unit = dict(zip(rows[1], rows[2], strict=False)).get(_UNITS, "").strip()
    markers, parts = ([cell.strip() for cell in row] for row in rows[begun : begun + 2])
    names, marker = [], ""
    for k, part in enumerate(parts):
        own = markers[k] if k < len(markers) else ""
        marker = own or marker
        names.append(f"{marker}.{part}" if part else own)
    while names and not names[-1]:
        names.pop()
    return tuple(names), ("", "s", *[unit] * (len(names) - 2)), begun + 2
