"""Tables for the terminal, for Markdown and for spreadsheets."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

COLUMNS = ("estimator", "RMSE / %", "paper's form", "median rel. error", "skill", "epochs")
WIDTH = 100


def results_table(results: Mapping[str, Any]) -> str:
    """The table of an experiment as text of fixed width."""
    title = f"{results['experiment']}: protocol {results['protocol']}, family {results['family']}, "
    title += f"seeds {', '.join(map(str, results['seeds']))}"
    table = Table(title=title, title_justify="left")
    for column in COLUMNS:
        table.add_column(column, justify="left" if column == "estimator" else "right")
    for row in _rows(results):
        table.add_row(*row)
    text = io.StringIO()
    Console(file=text, width=WIDTH).print(table)
    return text.getvalue()


def results_markdown(results: Mapping[str, Any]) -> str:
    """The same table for a README."""
    lines = ["| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
    lines += ["| " + " | ".join(row) + " |" for row in _rows(results)]
    return "\n".join(lines)


def _rows(results: Mapping[str, Any]) -> list[tuple[str, ...]]:
    rows = []
    for group, mark in (("models", ""), ("controls", " (control)")):
        for name, found in results[group].items():
            error = found["rmse_percent"]
            spread = f" ± {error['std']:.4f}" if len(results["seeds"]) > 1 else ""
            relative, epochs = found["median_relative_error"], found["epochs"]
            rows.append(
                (
                    name + mark,
                    f"{error['mean']:.4g}{spread}",
                    _number(found["rmse_paper"], ".4g"),
                    "–" if relative is None else f"{100 * relative:.3g} %",
                    _number(found["skill"], ".3f"),
                    "–" if not epochs else f"{epochs:.3g}",
                )
            )
    return rows


def _number(value: float | None, form: str) -> str:
    return "–" if value is None else format(value, form)


def parameter_table(title: str, rows: Iterable[Sequence[str]]) -> str:
    """Names, values and 95 % intervals as text."""
    table = Table(title=title, title_justify="left")
    for column in ("quantity", "value", "95 % interval", "unit"):
        table.add_column(column, justify="left" if column in ("quantity", "unit") else "right")
    for row in rows:
        table.add_row(*row)
    text = io.StringIO()
    Console(file=text, width=WIDTH).print(table)
    return text.getvalue()


def write_csv(rows: Sequence[Mapping[str, Any]], path: Path) -> Path:
    """One line a row; columns in the order in which they first come up."""
    columns = list(dict.fromkeys(column for row in rows for column in row))
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)
    return path
