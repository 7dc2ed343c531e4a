"""The index as HTML; its rows as `tasks` finds them."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files

from gear_damping.reporting.page.render import render_page

PACKAGE = "gear_damping.reporting.run_index"
LOOKS = {"finished": "finished", "failed": "failed", "unreadable": "failed"}  # status -> how it is coloured
OPEN = "doubtful"  # how every other is


@dataclass(frozen=True)
class IndexRow:
    """One run, or one sweep.

    Args:
        folder: Path of its folder, relative to that of the index.
        started: Date and time (UTC) as ISO 8601, which sorts; empty where nobody knows.
        task: What it did.
        name: Of the experiment.
        status: As in run.json, or how many jobs of a sweep are finished.
        result: Its first figures, or of a run that failed the reason.
        seconds: How long it took; None: not known.
        figure: Path of its main figure, relative to that of the index; None: it has none.
        report: Path of its report, relative to that of the index; None: it has none.
    """

    folder: str
    started: str
    task: str
    name: str
    status: str
    result: str = ""
    seconds: float | None = None
    figure: str | None = None
    report: str | None = None

    @property
    def look(self) -> str:
        """How the status is coloured."""
        return LOOKS.get(self.status, OPEN)

    @property
    def date(self) -> str:
        """Date and time as they are read."""
        return self.started[:19].replace("T", " ")

    @property
    def duration(self) -> str:
        """How long it took, as it is read."""
        if self.seconds is None:
            return "–"
        minutes, seconds = divmod(round(self.seconds), 60)
        hours, minutes = divmod(minutes, 60)
        return (
            f"{hours} h {minutes:02} min" if hours else f"{minutes} min {seconds:02} s" if minutes else f"{seconds} s"
        )


def index_page(rows: Sequence[IndexRow]) -> str:
    """The page; the newest run stands first."""
    script = files(PACKAGE).joinpath("templates", "sort.js").read_text(encoding="utf-8")
    newest = sorted(rows, key=lambda row: (row.started, row.folder), reverse=True)
    return render_page(PACKAGE, "index.html", script=script, rows=newest)
