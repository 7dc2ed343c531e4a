"""What the report of an explanation is made of: the content of `explanation.json` and the arrays behind its figures.

`explanation` is a mapping with the keys of `gear_damping.explanation.report_schema` (docs/explanation.md); one that is
absent, None or empty leaves its section out. Only `verdict` must be there.

Units are as in `gear_damping.units`; what is not a number (NaN) counts as not known.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from gear_damping.explanation.casing.report_fields import CasingStudy
from gear_damping.explanation.report_schema import VERDICTS
from gear_damping.reporting.figures import ForceMap, ForceSurface, Overlay, ResidualSpectrum


@dataclass(frozen=True, eq=False)
class ReportInput:
    """Everything that a report shows; only title and explanation are needed.

    Args:
        title: What was measured.
        explanation: The content of `explanation.json`, see above.
        quantity: What the explained channel is.
        unit: Its unit.
        overlays: Records to show, held-out ones first.
        spectrum: Spectrum of the residual.
        needed_share: Share of the excess that a cause has to take.
        force_map: Residual force by tooth and mesh phase.
        force_surface: Residual force by displacement and velocity.
        parameters: Fitted parameters: name -> {before, after: {value, unit, interval95} or None}.
        equations: Effect of the simulation -> its term of the equation of motion as text.
        descriptions: Effect -> sentence about it, for effects that are not in the catalogue.
        provenance: What made the report: command, versions, inputs.
        casing: What was heard through a casing, instead of all the figures above.
    """

    title: str
    explanation: Mapping[str, Any]
    quantity: str = "transmission error"
    unit: str = "µm"
    overlays: Sequence[Overlay] = ()
    spectrum: ResidualSpectrum | None = None
    needed_share: float | None = None
    force_map: ForceMap | None = None
    force_surface: ForceSurface | None = None
    parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    equations: Mapping[str, str] = field(default_factory=dict)
    descriptions: Mapping[str, str] = field(default_factory=dict)
    provenance: Mapping[str, str] = field(default_factory=dict)
    casing: CasingStudy | None = None

    def __post_init__(self) -> None:
        verdict = self.explanation.get("verdict")
        if verdict not in VERDICTS:
            raise ValueError(f"explanation['verdict'] must be one of {', '.join(VERDICTS)}, got {verdict!r}")
