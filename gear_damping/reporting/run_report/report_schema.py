"""What the report of a run is made of."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gear_damping.reporting.page.picture import Picture, file_uri
from gear_damping.reporting.page.table import Table

FINE, DOUBTFUL, FAILED = "finished", "doubtful", "failed"  # what the report's first sentence is


@dataclass(frozen=True)
class Section:
    """A part of the page.

    Args:
        heading: Of the part.
        sentences: Below it.
        tables: After the sentences.
        pictures: After the tables.
    """

    heading: str
    sentences: Sequence[str] = ()
    tables: Sequence[Table] = ()
    pictures: Sequence[Picture] = ()


@dataclass(frozen=True)
class RunReport:
    """Everything that the page of a run shows.

    Args:
        kind: What sort of run it was.
        title: Which one.
        lead: What came out, the most important sentence first.
        state: What the first sentence is: FINE, DOUBTFUL, FAILED.
        sections: The parts, in order.
        provenance: What made the report: command, versions, inputs.
    """

    kind: str
    title: str
    lead: Sequence[str]
    state: str = FINE
    sections: Sequence[Section] = ()
    provenance: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Left:
    """What a run has left in its folder.

    Args:
        folder: The folder.
        record: The content of its run.json.
    """

    folder: Path
    record: Mapping[str, Any]

    @property
    def name(self) -> str:
        """Of the experiment."""
        return str(self.record["config"]["name"])

    def read(self, name: str) -> dict[str, Any] | None:
        """A JSON file; None where the run left none of that name."""
        path = self.folder / name
        return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None

    def picture(self, name: str, caption: str, alt: str) -> list[Picture]:
        """A PNG file; none where the run left none of that name."""
        path = self.folder / name
        return [Picture(file_uri(path), caption, alt)] if path.exists() else []
