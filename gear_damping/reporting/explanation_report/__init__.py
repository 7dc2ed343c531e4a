"""The report of an explanation: `render(ReportInput(…))` gives one self-contained HTML page."""

from gear_damping.reporting.explanation_report.render import render, write_report
from gear_damping.reporting.explanation_report.report_input import (
    Candidate,
    ForceMap,
    ForceSurface,
    Overlay,
    ReportInput,
    ResidualSpectrum,
)

__all__ = [
    "Candidate",
    "ForceMap",
    "ForceSurface",
    "Overlay",
    "ReportInput",
    "ResidualSpectrum",
    "render",
    "write_report",
]
