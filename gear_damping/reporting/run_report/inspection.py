"""The report of task=inspect: what a bare file or a measurement.yaml holds."""

from collections.abc import Mapping, Sequence
from typing import Any

from gear_damping.errors import with_article
from gear_damping.reporting.numbers import NOTHING
from gear_damping.reporting.page.picture import Picture
from gear_damping.reporting.page.render import words
from gear_damping.reporting.page.table import Table
from gear_damping.reporting.run_report.report_schema import DOUBTFUL, FINE, Left, RunReport, Section

NAME = "inspection.json"
YAML = "measurement.yaml"  # of a bare file: what is written to start from


def report_of(left: Left) -> RunReport:
    """What an inspection has come to."""
    content = left.read(NAME)
    return _of_file(left, content) if "columns" in content else _of_measurement(left, content)


def _of_file(left: Left, content: Mapping[str, Any]) -> RunReport:
    blanks = content["open"]
    open_ones = f"{blanks} blank{'' if blanks == 1 else 's'}"
    todo = f"fill in its {open_ones}, correct its guesses" if blanks else "nothing is left open; check its guesses"
    lead = [
        f"{content['file']} holds {_counted(content['columns'], 'column')} of {content['rows']} rows.",
        f"Time: {content['time']}.",
        f"`{YAML}` declares it: {todo}.",
    ]
    rows = [
        (f"`{one['column']}`", one["shape"], one["unit"], one["kind"], one["guess"] or NOTHING, "; ".join(one["looks"]))
        for one in content["columns"]
    ]
    headings = ("column", "values", "unit", "looks like", "may be", "what is in it")
    sections = [
        Section("Every channel", pictures=_picture(left, [one["column"] for one in content["columns"]])),
        Section("Column by column", content["notes"], [Table("The columns of the file.", headings, rows, [])]),
    ]
    return RunReport("Inspection", f"Inspection of {content['file']}", lead, DOUBTFUL if blanks else FINE, sections)


def _of_measurement(left: Left, content: Mapping[str, Any]) -> RunReport:
    faults = content["data_problems"]
    records, system = _counted(content["records"], "record"), words(content["system"])
    first = f"{content['file']} declares {records} of {with_article(system)}."
    found = f"{faults} data problems were found in them." if faults else "No data problem was found in them."
    channels = list(dict.fromkeys(name for one in content["records"] for name, _ in one["channels"]))
    sections = [Section("Every channel", pictures=_picture(left, channels))]
    for one in content["records"]:
        rows = [(f"`{name}`", said) for name, said in one["channels"]]
        table = Table(f"Channels of {one['name']}: {one['says']}.", ("channel", "what is in it"), rows, [])
        sections.append(Section(f"Record {one['name']}", [f"{said}." for said in one["notes"]], [table]))
    sections.append(Section("The measurement", [f"{said}." for said in content["says"]]))
    return RunReport(
        "Inspection", f"Inspection of {content['file']}", [first, found], DOUBTFUL if faults else FINE, sections
    )


def _counted(listed: Sequence[Any], word: str) -> str:
    return f"{len(listed)} {word}{'' if len(listed) == 1 else 's'}"


def _picture(left: Left, names: list[str]) -> list[Picture]:
    alt = f"Line charts, a row a channel: its values over time, and beside them its spectrum: {', '.join(names)}."
    caption = "Every channel over time, and its spectrum. The dashed line is the floor of the noise."
    return left.picture("inspection.png", caption, alt)
