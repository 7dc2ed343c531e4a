"""What the report of an explanation is made of: the content of `explanation.json` and the arrays behind its figures.

`explanation` is a mapping with these keys; one that is absent or None leaves its section out:

    verdict         consistent, explained, ambiguous, partly_explained, unexplained or data_problem (required)
    causes          list, strongest first: {name, parameters: {name: {value, unit, interval95}}, excess_explained
                    (share of the held-out excess), confusable_with: [names], status: established or suggested}
    misfit          {before, after, floor, records: {record: {role, before, after, floor}}}: held-out mean squared
                    residual over the noise variance
    residual        {fit: {before, after, unit}, holdout: {before, after, unit}}: RMSE in the channel's unit
    gain            {nrmse: {before, after, floor}, damping_ratio_percent: {before: {value, interval95}, after: …}}
    noise           {channel: {level, unit, method} or a sentence}
    not_observable  list of {name, smallest, unit}; smallest None or infinite: not at any size
    next_experiment {description, separates: [names], predicted_separation} or a sentence
    unexplained     {share, orders, contact_phase, state_dependence, families: {family: share}, …} or a sentence

Units are as in `gear_damping.units`; what is not a number (NaN) counts as not known.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import ArrayLike

VERDICTS = ("consistent", "explained", "ambiguous", "partly_explained", "unexplained", "data_problem")


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
        mesh_order: Teeth of the pinion; None: no gears.
        gear_order: Turns of the gear per turn of the pinion.
        natural_frequency_hz: Marked over frequencies.
        highest_hz: End of the frequency axis.
    """

    places: ArrayLike
    before: ArrayLike
    after: ArrayLike | None = None
    measured: ArrayLike | None = None
    floor: ArrayLike | None = None
    mesh_order: float | None = None
    gear_order: float | None = None
    natural_frequency_hz: float | None = None
    highest_hz: float | None = None


@dataclass(frozen=True)
class Candidate:
    """An effect that was tried.

    Args:
        name: The effect.
        share: Share of the held-out excess that it explains; None: it was not fitted.
        status: established, confusable, suggested or rejected.
    """

    name: str
    share: float | None
    status: str = "rejected"


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
        candidates: What was tried.
        needed_share: Share of the excess that a cause has to take.
        force_map: Residual force by tooth and mesh phase.
        force_surface: Residual force by displacement and velocity.
        parameters: Fitted parameters beyond the causes: name -> {before, after: {value, unit, interval95} or None}.
        equations: Name of a simulation -> its equation of motion as text.
        calibration: Sentences about how the nominal simulation was calibrated, in order.
        findings: Sentences about the data: faults of a data problem, and notes.
        descriptions: Effect -> sentence about it, for effects that are not in the catalogue.
        provenance: What made the report: command, versions, inputs.
    """

    title: str
    explanation: Mapping[str, Any]
    quantity: str = "transmission error"
    unit: str = "µm"
    overlays: Sequence[Overlay] = ()
    spectrum: ResidualSpectrum | None = None
    candidates: Sequence[Candidate] = ()
    needed_share: float | None = None
    force_map: ForceMap | None = None
    force_surface: ForceSurface | None = None
    parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    equations: Mapping[str, str] = field(default_factory=dict)
    calibration: Sequence[str] = ()
    findings: Sequence[str] = ()
    descriptions: Mapping[str, str] = field(default_factory=dict)
    provenance: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        verdict = self.explanation.get("verdict")
        if verdict not in VERDICTS:
            raise ValueError(f"explanation['verdict'] must be one of {', '.join(VERDICTS)}, got {verdict!r}")
