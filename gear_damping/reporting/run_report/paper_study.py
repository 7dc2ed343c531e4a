"""The report of task=paper: every figure and table that was repeated, beside what is printed."""

from collections.abc import Mapping
from typing import Any

from gear_damping.reporting.page.picture import Picture
from gear_damping.reporting.page.table import Table
from gear_damping.reporting.paper.page import NUMBERS
from gear_damping.reporting.paper.printed import EFFECTS
from gear_damping.reporting.paper.tables import TABLES
from gear_damping.reporting.run_report.report_schema import FINE, Left, RunReport, Section

ONE_RUN, UNSEEN = "on one run, as the paper cuts it", "on runs that were not trained on"
SHOWS = {  # what a figure draws, for those who do not see it
    "figure_04": "Line chart of the mesh stiffness over time in three readings of the paper",
    "figure_05": "Scalograms of the response by the right equations and as printed, above their mean magnitude",
    "figure_10": "Scalograms of the response under eccentricity and as printed, above their mean magnitude",
    **dict.fromkeys(("figure_06", "figure_11"), f"Line charts of the error over epochs {ONE_RUN}, and {UNSEEN}"),
    "figure_09": f"Line charts of the error over the signal-to-noise ratio of the load {ONE_RUN}, and {UNSEEN}",
    "figure_14": f"Predicted over true damping ratio {ONE_RUN}, and {UNSEEN}",
}
OF_AN_EFFECT = f"Predictions along one run, predicted over true damping ratio of unseen runs, and errors {ONE_RUN}"
LEADS, OVERVIEW = "leads", "overview"  # tables over all effects: only where all were asked for
TOLD = 3  # rows of a table that the alternative text of its figure tells


def report_of(left: Left) -> RunReport:
    """What a study has come to."""
    content = left.read(NUMBERS)
    wanted = sorted(left.record["config"].get("figures") or EFFECTS)
    said = TABLES["settings"](content).partition("\n\n")[2]
    lead = [f"{len(wanted)} figures and tables of Yousfi et al. (2026) are repeated.", " ".join(said.split())]
    sections = _over_all(content) if set(EFFECTS) <= set(wanted) else []
    sections += [_section(left, content, name) for name in wanted]
    return RunReport("Study", "Figures and tables of the paper, repeated", lead, FINE, sections)


def _over_all(content: Mapping[str, Any]) -> list[Section]:
    overview = as_table(TABLES[OVERVIEW](content), "Every figure with a printed error: printed, on one run, unseen.")
    leads = as_table(TABLES[LEADS](content), "By how much the error of cwt_lstm lies below that of raw_lstm.")
    return [Section("All effects", tables=[overview]), Section("Which network leads", tables=[leads])]


def _section(left: Left, content: Mapping[str, Any], name: str) -> Section:
    title = f"{name.replace('_0', ' ').replace('_', ' ').capitalize()}: {EFFECTS[name]}"
    tables = [as_table(TABLES[name](content), f"{title}; printed beside repeated.")] if name in TABLES else []
    return Section(title, tables=tables, pictures=_picture(left, name, tables))


def _picture(left: Left, name: str, tables: list[Table]) -> list[Picture]:
    told = [_told(table, row) for table in tables for row in table.rows[:TOLD]]
    caption = f"{SHOWS.get(name, OF_AN_EFFECT)}."
    return left.picture(f"{name}.png", caption, f"{caption} {'; '.join(told)}".strip())


def _told(table: Table, row: Any) -> str:
    cells = [f"{head} {cell}" for head, cell in zip(table.headings[1:], row[1:], strict=True) if cell.strip()]
    return f"{row[0]}: {', '.join(cells)}" if cells else str(row[0])


def as_table(markdown: str, caption: str) -> Table:
    """A table of Markdown as one of a page."""
    head, _, *rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in markdown.splitlines()]
    return Table(caption, head, rows)
