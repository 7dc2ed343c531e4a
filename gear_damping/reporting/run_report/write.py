"""From what a run has left to report.html in its folder."""

from collections.abc import Mapping
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

from gear_damping.errors import written_whole
from gear_damping.reporting.page.render import render_page
from gear_damping.reporting.run_report import REPORT, REPORTED
from gear_damping.reporting.run_report.report_schema import Left, RunReport
from gear_damping.reporting.run_report.sweep import SweepLeft, sweep_report

PACKAGE = "gear_damping.reporting.run_report"


def write_report(folder: Path, record: Mapping[str, Any]) -> Path:
    """Write the report of a run of a task in REPORTED; returns its path.

    Args:
        folder: Of the run, with its files.
        record: The content of its run.json.

    Raises:
        OSError: it cannot be written.
    """
    report = import_module(f"{PACKAGE}.{REPORTED[record['task']]}").report_of(Left(folder, record))
    return _write(folder, replace(report, provenance=_provenance(record)))


def write_sweep_report(left: SweepLeft) -> Path:
    """Write the report of a sweep; returns its path.

    Raises:
        OSError: it cannot be written.
    """
    return _write(left.folder, sweep_report(left))


def _write(folder: Path, report: RunReport) -> Path:
    path, page = folder / REPORT, render_page(PACKAGE, "run.html", report=report)
    with written_whole(path) as unfinished:
        unfinished.write_text(page, encoding="utf-8")
    return path


def _provenance(record: Mapping[str, Any]) -> dict[str, str]:
    git, inputs = record["git"], record["inputs"]
    found = {"Command": f"`{record['command']}`", "Begun": record["started"], "Seed": str(record["seed"])}
    if git["revision"]:
        found["Revision"] = git["revision"] + (", changed" if git["dirty"] else "")
    found["Versions"] = ", ".join(f"{name} {version}" for name, version in record["versions"].items())
    if inputs:
        found["Inputs"] = "; ".join(f"{path} (SHA-256 {digest})" for path, digest in inputs.items())
    return found
