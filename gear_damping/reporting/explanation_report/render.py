"""The explanation as one page that needs nothing beside itself."""

from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from gear_damping.reporting.explanation_report import evidence, rows, sentences, vocabulary
from gear_damping.reporting.explanation_report.report_input import ReportInput

PACKAGE = "gear_damping.reporting.explanation_report"


def render(report: ReportInput) -> str:
    """The report as HTML: pictures and style are inside, nothing is fetched, text of the user is escaped."""
    environment = Environment(
        loader=PackageLoader(PACKAGE), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["words"] = vocabulary.words
    style = files(PACKAGE).joinpath("templates", "style.css").read_text(encoding="utf-8")
    return environment.get_template("report.html").render(style=style, **_content(report)).lstrip()


def write_report(report: ReportInput, path: Path | str) -> Path:
    """Write the page; returns its path."""
    path = Path(path)
    path.write_text(render(report), encoding="utf-8")
    return path


def _content(report: ReportInput) -> dict[str, Any]:
    explanation = report.explanation
    return {
        "title": report.title,
        "verdict": explanation["verdict"],
        "headline": sentences.HEADLINES[explanation["verdict"]],
        "verdict_sentences": sentences.verdict_sentences(explanation, report.descriptions),
        "misfit_sentence": sentences.misfit_sentence(explanation.get("misfit")),
        "damping_sentence": sentences.damping_sentence(explanation.get("gain")),
        "causes": [_cause(cause, report) for cause in explanation.get("causes") or ()],
        "next_experiment": sentences.next_experiment_sentences(explanation.get("next_experiment")),
        "findings": list(report.findings),
        "calibration": list(report.calibration),
        "equations": dict(report.equations),
        "provenance": dict(report.provenance),
        "records_have_total": rows.has_total(report),
        "tables": {
            "records": rows.records(report),
            "residuals": rows.residuals(report),
            "parameters": rows.parameters(report),
            "not_observable": rows.not_observable(report),
            "noise": rows.noise(report),
            "unexplained": rows.unexplained(report),
        },
        "overlays": evidence.overlays(report),
        "misfit": evidence.misfit(report),
        "spectrum": evidence.spectrum(report),
        "candidates": evidence.candidates(report),
        "residual_forces": list(evidence.residual_forces(report)),
    }


def _cause(cause: dict[str, Any], report: ReportInput) -> dict[str, Any]:
    name = cause["name"]
    return {
        "name": name,
        "status": cause.get("status", "suggested"),
        "sentences": sentences.cause_sentences(cause, report.descriptions),
        "equation": vocabulary.equation(name),
        "parameters": rows.cause_parameters(cause),
    }
