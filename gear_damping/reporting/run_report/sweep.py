"""The report of a sweep: a row a job, small multiples and the heat map."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gear_damping.reporting.headline import ranked
from gear_damping.reporting.numbers import NOTHING, number
from gear_damping.reporting.page.picture import Picture
from gear_damping.reporting.page.table import Link, Table
from gear_damping.reporting.run_report.report_schema import DOUBTFUL, FINE, Left, RunReport, Section

SPREAD = "_std"  # how the name of a deviation over seeds ends: of one seed it is 0, and tells nothing
MOST_FIGURES = 5  # columns of the table; sweep.csv has all


@dataclass(frozen=True)
class SweepLeft:
    """What a sweep has left in its folder.

    Args:
        folder: The folder.
        keys: The keys that it varies.
        jobs: How many jobs are known of.
        rows: One row a job, as in sweep.csv: `job`, `status`, the keys, the figures, `error`.
        pages: Job -> where a click on it leads.
        command: What was typed.
    """

    folder: Path
    keys: Sequence[str]
    jobs: int
    rows: Sequence[Mapping[str, Any]]
    pages: Mapping[str, str]
    command: str


def sweep_report(left: SweepLeft) -> RunReport:
    """What a sweep has come to."""
    done = sum(row["status"] == "finished" for row in left.rows)
    swept = " and ".join(f"`{key}`" for key in left.keys) or "nothing"
    lead = [f"{done} of {left.jobs} jobs are finished.", f"Swept over {swept}."]
    shown = Left(left.folder, {})
    pictures = _small_multiples(shown, left) + _heat_map(shown, left)
    sections = [Section("What it found", pictures=pictures)] if pictures else []
    sections.append(Section("Job by job", ["Every figure of every job stands in `sweep.csv`."], [_table(left)]))
    failed = [row for row in left.rows if row["error"]]
    if failed:
        rows = [(row["job"], row["error"].removeprefix("- ")) for row in failed]
        table = Table("Jobs that failed, with the reason.", ("job", "reason"), rows, [])
        sections.append(Section("What failed", (), [table]))
    name = left.folder.parent.name or left.folder.name
    state = FINE if done == left.jobs else DOUBTFUL
    return RunReport("Sweep", f"Sweep of {name}", lead, state, sections, {"Command": f"`{left.command}`"})


def _table(left: SweepLeft) -> Table:
    figures = _figures(left)
    rows = [
        (
            Link(row["job"], left.pages[row["job"]]),
            row["status"],
            *(_text(row.get(key)) for key in left.keys),
            *(_text(row.get(name)) for name in figures),
        )
        for row in left.rows
    ]
    headings = ("job", "status", *left.keys, *figures)
    return Table("The jobs, their swept values and their first figures.", headings, rows, range(2, len(headings)))


def _figures(left: SweepLeft) -> list[str]:
    known = {"job", "status", "error", *left.keys}
    names = list(dict.fromkeys(name for row in left.rows for name in row if name not in known))
    spread = [name for name in names if not (name.endswith(SPREAD) and not any(row.get(name) for row in left.rows))]
    return ranked(spread)[:MOST_FIGURES]


def _text(value: Any) -> str:
    if value is None:
        return NOTHING
    return number(value) if isinstance(value, float) else str(value)


def _small_multiples(shown: Left, left: SweepLeft) -> list[Picture]:
    key = left.keys[0] if left.keys else "the job"
    names = [name for name in _figures(left) if any(isinstance(row.get(name), float) for row in left.rows)]
    ends = [f"{name} {_range(row.get(name) for row in left.rows)}" for name in names]
    alt = f"Line charts over {key}: {'; '.join(ends) or 'no figures'}."
    caption = f"Figures of the jobs against {key}; over seeds means are drawn, with the standard deviation as a band."
    return shown.picture("sweep.png", caption, alt)


def _heat_map(shown: Left, left: SweepLeft) -> list[Picture]:
    axes = " and ".join(left.keys[:2])
    alt = f"Heat map over {axes}; the figures are those of the table below."
    return shown.picture("sweep_map.png", f"The same over {axes} together.", alt)


def _range(values: Any) -> str:
    known = [value for value in values if isinstance(value, float)]
    return f"from {number(min(known), 3)} to {number(max(known), 3)}"
