"""Tables for the terminal and logs, for Markdown and for spreadsheets."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from gear_damping.reporting.numbers import NOTHING, number, percent, pretty_unit

COLUMNS = ("estimator", "RMSE / %", "paper's form", "median rel. error", "skill", "epochs")
QUANTITY_COLUMNS = ("quantity", "value", "95 % interval", "unit")
WIDTH = 100  # columns of a terminal that does not wrap
_SCALARS = {
    "damping_ratio_percent": "damping ratio",
    "natural_frequency_hz": "natural frequency",
    "log_decrement": "log-decrement",
}
_UNITS = {"damping_ratio_percent": "% of critical", "natural_frequency_hz": "Hz", "log_decrement": "1"}


def results_table(results: Mapping[str, Any]) -> str:
    """The table of an experiment as text of fixed width.

    Args:
        results: The content of `results.json`: experiment, protocol, family, seeds, models and controls, each
            name -> {rmse_percent: {mean, std}, rmse_paper, median_relative_error, skill, epochs}.
    """
    title = f"{results['experiment']}: protocol {results['protocol']}, family {results['family']}, "
    title += f"seeds {', '.join(map(str, results['seeds']))}"
    return _text(title, COLUMNS, results_rows(results), left=("estimator",))


def results_markdown(results: Mapping[str, Any]) -> str:
    """The same table for a README."""
    return markdown(COLUMNS, results_rows(results), right=len(COLUMNS) - 1)


def markdown(columns: Sequence[str], rows: Iterable[Sequence[object]], right: int = 0) -> str:
    """Any table as Markdown.

    Args:
        columns: What stands above.
        rows: Cells; their text is taken as it is.
        right: How many of the last columns are set flush right.
    """
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * (len(columns) - right) + "---:|" * right]
    lines += ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def parameter_table(title: str, rows: Iterable[Sequence[str]]) -> str:
    """Quantities as text of fixed width; each row has quantity, value, 95 % interval and unit as text."""
    return _text(title, QUANTITY_COLUMNS, rows, left=("quantity", "unit"))


def damping_table(rows: Iterable[Sequence[str]]) -> str:
    """What estimators say of records as text of fixed width.

    Args:
        rows: Record, estimator, damping ratio, 95 % interval, frequency and amplitudes with their unit as text.
    """
    columns = ("record", "estimator", "zeta / %", "95 % interval", "f / Hz", "amplitude")
    return _text("damping ratio zeta of free vibrations, in % of critical", columns, rows, left=("record", "estimator"))


def plan_table(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Tests of a plan as text of fixed width; names of sensors and of tests stand on the left."""
    return _text(title, columns, rows, left=("sensors", "tests"))


def identification_table(identification: Mapping[str, Any], title: str = "identified") -> str:
    """The table of an identification as text of fixed width.

    Args:
        identification: The content of `identification.json`: damping_ratio_percent, natural_frequency_hz and
            log_decrement as {value, interval95}, parameters as name -> {value, unit, interval95}, residual as
            {fit, holdout: {rmse, unit}}; what is absent or None is left out.
        title: What stands above it.
    """
    rows = []
    for key, name in _SCALARS.items():
        if identification.get(key):
            rows.append(_quantity_row(name, identification[key] | {"unit": _UNITS[key]}))
    for name, entry in identification.get("parameters", {}).items():
        rows.append(_quantity_row(name.replace("_", " "), entry))
    for role, words in (("fit", "residual where fitted"), ("holdout", "residual on held-out records")):
        entry = (identification.get("residual") or {}).get(role)
        if entry:
            rows.append((words, number(entry["rmse"]), "", pretty_unit(entry["unit"])))
    return parameter_table(title, rows)


def write_csv(rows: Sequence[Mapping[str, Any]], path: Path | str) -> Path:
    """One line a row; columns in the order in which they first come up, empty where a row lacks one."""
    path = Path(path)
    columns = list(dict.fromkeys(column for row in rows for column in row))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)
    return path


def results_rows(results: Mapping[str, Any]) -> list[tuple[str, ...]]:
    """The rows of an experiment below COLUMNS: networks, then controls."""
    several = len(results["seeds"]) > 1
    groups = (("models", ""), ("controls", " (control)"))
    return [_row(name + mark, found, several) for key, mark in groups for name, found in results[key].items()]


def _row(name: str, found: Mapping[str, Any], several: bool) -> tuple[str, ...]:
    error, epochs, skill = found["rmse_percent"], found["epochs"], found["skill"]
    std = f" ± {error['std']:.4f}" if several and error["std"] is not None else ""
    return (
        name,
        number(error["mean"]) + std,
        number(found["rmse_paper"]),
        percent(found["median_relative_error"]),
        NOTHING if skill is None else f"{round(skill, 3) + 0.0:.3f}",
        number(epochs, 3) if epochs else NOTHING,
    )


def _quantity_row(name: str, entry: Mapping[str, Any]) -> tuple[str, ...]:
    low, high = entry.get("interval95") or (None, None)
    interval = "" if low is None else f"{number(low, 5)} … {number(high, 5)}"
    return name, number(entry["value"], 5), interval, pretty_unit(entry.get("unit", ""))


def _text(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]], left: Sequence[str]) -> str:
    """Plain text: no colours, no terminal, nothing in the cells is taken for markup."""
    table = Table(title=Text(title), title_justify="left", box=box.SIMPLE_HEAD)
    for column in columns:
        table.add_column(column, justify="left" if column in left else "right", overflow="fold")
    for row in rows:
        table.add_row(*(Text(str(cell)) for cell in row))
    text = io.StringIO()
    Console(file=text, width=WIDTH, color_system=None, force_terminal=False, legacy_windows=False).print(table)
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines()) + "\n"
