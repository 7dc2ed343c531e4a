"""The report of an explanation as one self-contained HTML page."""

from gear_damping.reporting.explanation_report.from_explanation import report_input, write_report
from gear_damping.reporting.explanation_report.render import render
from gear_damping.reporting.explanation_report.report_input import (
    ForceMap,
    ForceSurface,
    Overlay,
    ReportInput,
    ResidualSpectrum,
)

__all__ = [
    "ForceMap",
    "ForceSurface",
    "Overlay",
    "ReportInput",
    "ResidualSpectrum",
    "render",
    "report_input",
    "write_report",
]
