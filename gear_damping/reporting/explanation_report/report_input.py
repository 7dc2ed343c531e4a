"""What the report of an explanation is made of: the content of `explanation.json` and the arrays behind its figures.

`explanation` is a mapping with the keys of `gear_damping.explanation.schema` (docs/explanation.md); one that is absent,
None or empty leaves its section out. Only `verdict` must be there.

Units are as in `gear_damping.units`; what is not a number (NaN) counts as not known.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import ArrayLike

from gear_damping.explanation.casing.content import CasingStudy
from gear_damping.explanation.schema import VERDICTS


@dataclass(frozen=True, eq=False)
class Overlay:
    """A record with its simulations, for `overlay_figure`; arrays of shape (time,) in the channel's unit.

    Args:
        record: Its name, with the operating condition.
        time: In s.
        measured: The record.
        nominal: The calibrated nominal simulation.
        extended: The simulation with its causes; None: nothing was added.
        noise: Standard deviation of the noise; None: unknown.
    """

    record: str
    time: ArrayLike
    measured: ArrayLike
    nominal: ArrayLike
    extended: ArrayLike | None = None
    noise: float | None = None


@dataclass(frozen=True, eq=False)
class ResidualSpectrum:
    """Spectrum of the residual, for `residual_orders_figure` or, of a rig without shafts, over Hz.

    Args:
        places: Orders of the pinion, or frequencies (Hz) where `mesh_order` is None; shape (place,).
        before: Amplitudes of the nominal simulation's residual.
        after: Those of the extended simulation; None: nothing was added.
        measured: Amplitudes of the record.
        floor: Amplitudes of the noise alone.
        mesh_order: Teeth of the pinion; None: no gears, or no whole turn.
        gear_order: Turns of the gear per turn of the pinion.
        natural_frequency_hz: Marked over frequencies.
        record: Whose spectrum it is.
    """

    places: ArrayLike
    before: ArrayLike
    after: ArrayLike | None = None
    measured: ArrayLike | None = None
    floor: ArrayLike | None = None
    mesh_order: float | None = None
    gear_order: float | None = None
    natural_frequency_hz: float | None = None
    record: str = ""


@dataclass(frozen=True, eq=False)
class ForceMap:
    """Residual force (phase, tooth) by mesh phase (phase,) in mesh periods, for `residual_force_map_figure`."""

    mesh_phase: ArrayLike
    force: ArrayLike
    unit: str = "N"


@dataclass(frozen=True, eq=False)
class ForceSurface:
    """Residual force (velocity, displacement) over the state, for `residual_force_surface_figure`."""

    displacement: ArrayLike
    velocity: ArrayLike
    force: ArrayLike
    displacement_unit: str = "µm"
    velocity_unit: str = "m/s"
    force_unit: str = "N"
    visits: ArrayLike | None = None


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
