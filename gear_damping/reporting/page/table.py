"""A table of a page."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Link:
    """A cell that leads to a file beside the page.

    Args:
        text: Of the cell.
        href: Path of the file, relative to that of the page.
    """

    text: str
    href: str


@dataclass(frozen=True)
class Table:
    """Rows below headings.

    Args:
        caption: What the table tells.
        headings: Of its columns.
        rows: Text or links; what stands in backticks is set as code.
        numbers: Places of the columns that are set flush right; None: all but the first.
    """

    caption: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str | Link]]
    numbers: Sequence[int] | None = None

    def is_number(self, column: int) -> bool:
        """Whether a column is set flush right."""
        return column > 0 if self.numbers is None else column in self.numbers
