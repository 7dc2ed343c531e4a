"""The explanation as one page that needs nothing beside itself."""

from typing import Any

from gear_damping.reporting.explanation_report import casing, evidence, rows, sentences, vocabulary
from gear_damping.reporting.explanation_report.report_input import ReportInput
from gear_damping.reporting.page.render import render_page

PACKAGE = "gear_damping.reporting.explanation_report"


def render(report: ReportInput) -> str:
    """The report as HTML: pictures and style are inside, nothing is fetched, text of the user is escaped."""
    return render_page(PACKAGE, "explanation.html", **_content(report))


def _content(report: ReportInput) -> dict[str, Any]:
    explanation = report.explanation
    return {
        "title": report.title,
        "verdict": explanation["verdict"],
        "verdict_sentences": sentences.verdict_sentences(explanation),
        "causes": [_cause(cause, report) for cause in explanation.get("causes") or ()],
        "next_experiment": sentences.next_experiment_sentences(explanation.get("next_experiment")),
        "noise": sentences.noise_sentences(explanation.get("noise")),
        "calibration": sentences.calibration_sentences(explanation.get("calibration")),
        "unexplained_residual": rows.unexplained_sentence(report),
        "equations": {name: f"`{term}`" for name, term in report.equations.items()},
        "provenance": dict(report.provenance),
        "tables": {
            "records": rows.records(report),
            "parameters": rows.parameters(report),
            "not_observable": rows.not_observable(report),
            "unexplained": rows.unexplained(report),
            "findings": rows.findings(report),
        },
        "overlays": evidence.overlays(report),
        "misfit": evidence.misfit(report),
        "spectrum": evidence.spectrum(report),
        "candidates": evidence.candidates(report),
        "visible": evidence.visible(report),
        "random": sentences.random_sentences(explanation.get("random"), explanation.get("visible")),
        "casing": casing.shown(report),
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
        "forest": evidence.forest(cause),
        "one_size": sentences.one_size_sentence(cause.get("homogeneous")),
    }
