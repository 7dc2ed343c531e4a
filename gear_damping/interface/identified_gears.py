"""Gear pairs, and any model of one's own, fitted to whatever channels respond."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any

from torch import Tensor

from gear_damping.errors import InputError, Problem, with_article
from gear_damping.explanation.answer.gain import damping_ratio, final_parameters, nrmse, rmse
from gear_damping.explanation.answer.other_shafts_torque import torque_of_the_other_shaft
from gear_damping.explanation.answer.unexplained import first_channel
from gear_damping.explanation.casing.heard import is_casing
from gear_damping.explanation.evidence.excess import WHOLE, Excess, excess
from gear_damping.explanation.evidence.noise import NoiseLevel
from gear_damping.explanation.evidence.records import Evidence, evidence_of, with_own_angles
from gear_damping.explanation.evidence.useful_samples import at_useful_rate
from gear_damping.explanation.explain import Listener, explain, fitting_solver, with_noise
from gear_damping.explanation.model.contradicted import contradicts_stated, noise_above
from gear_damping.explanation.model.fitting import InitialValues, fit_hypothesis
from gear_damping.explanation.model.hypothesis import Outcome, natural_frequency_hz
from gear_damping.explanation.model.nominal_gear_pair import MESH, angles_of
from gear_damping.explanation.model.ringing import told_covariance
from gear_damping.explanation.steps.too_short import too_short
from gear_damping.explanation.trials.bench import Log
from gear_damping.explanation.trials.efficient import weighed
from gear_damping.identification.output_error.least_squares import Rounds
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.interface.far_from_stated import far_from_stated
from gear_damping.interface.identified_page import MOST_PANELS, estimate_rows, panel, residual_rows
from gear_damping.interface.own_start import own_start
from gear_damping.measurement.record import Measurement
from gear_damping.physics.model import Model
from gear_damping.physics.systems.traits import Trait
from gear_damping.reporting import figures, tables
from gear_damping.simulation.solver_settings import Solver

SHOWN = ("mesh_stiffness_shape",)  # what is fitted in many numbers stands in the JSON alone
ITERATIONS = 40  # at most, of a fit of one's own model
STEEL = 1.4e10  # N/m^2: mesh stiffness of steel teeth by their width (ISO 6336-1: 14 N/(mm um) of one pair)
WIDTH = 10.0  # modules, of usual teeth
UNTOLD = 2.0  # times the damping ratio: an interval from 0 to there or further
SOFTEST, STIFFEST = 1e-3, 30.0  # times that: polymers are 100 times softer and often narrower; few teeth are wider


@dataclass(frozen=True)
class Fitted:
    """A fitted model with the records it was fitted to, their noise, and what is said of values that did not hold."""

    evidence: Evidence
    noise: NoiseLevel
    outcome: Outcome
    overruled: tuple[str, ...] = ()


def nominal_fit(measurement: Measurement, listener: Listener, solver: Solver | None) -> Fitted:
    """The nominal gear pair as `explain` fits it, where no effect may be a cause.

    Raises:
        InputError: nothing was measured that a simulation can be compared with, or the data are damaged.
    """
    _refuse_casing(measurement)
    found = explain(measurement, listener, solver, library={})
    if found.found is None:
        faults = found.content["sentences"][1:]
        raise InputError([Problem("records", fault, source=str(measurement.source)) for fault in faults])
    return Fitted(found.evidence, found.noise, found.found.outcome)


def own_fit(measurement: Measurement, model: Model, free: Sequence[str], log: Log, solver: Solver | None) -> Fitted:
    """A model of one's own with these parameters free; what it was not given is what the file states of the rig.

    What neither gives keeps the default that the model prints; where it is free, it begins at what `explain` would
    begin with. Where no parameter is named, those that it was given are free, and of an oscillator its linear ones
    and the strengths of its effects. Of an oscillator all records are fitted that are not declared to be held out, as
    the linear fit has it; of a gear pair a part is held out where none is declared to be.

    Raises:
        InputError: the model is of another system, or `own_start` refuses it.
    """
    _refuse_casing(measurement)
    evidence = at_useful_rate(evidence_of(measurement, holds_out=not measurement.base.has(Trait.REST)))
    if model.system.name != evidence.system:
        rule = f"is {with_article(model.system.name)}, the records are those of {with_article(evidence.system)}"
        raise InputError(Problem("model", rule, remedy="give a model of the measured system"))
    evidence, noise = with_noise(replace(evidence, segments=evidence.stated_segments), measurement, log)
    start = own_start(model, evidence, free)
    begun = start.hypotheses
    solver, own = fitting_solver(solver), {}
    if not evidence.has_index:
        evidence = with_own_angles(evidence)
        own = angles_of(begun[0], evidence, evidence.duration, solver)
    values, rounds = InitialValues(own=own), Rounds(ITERATIONS)
    outcomes = [fit_hypothesis(one, evidence, values, rounds, solver=solver) for one in begun]
    outcome = min(outcomes, key=lambda one: rmse(one.fit_residuals) if one.is_finite else inf)
    if not outcome.is_finite:
        rule = "runs away when it is simulated with what the fit came to"
        remedy = "begin with values nearer to those of the rig, or free fewer parameters"
        raise InputError(Problem("model", rule, remedy=remedy, source=str(measurement.source)))
    return Fitted(evidence, noise, weighed(outcome, evidence), tuple(start.overruled))


def _refuse_casing(measurement: Measurement) -> None:
    if is_casing(measurement):
        rule = "an accelerometer on a casing tells no damping: its path from the mesh is unknown"
        remedy = "measure a transmission error or a shaft, or choose task=explain for what the casing shows"
        raise InputError(Problem("records", rule, remedy=remedy, source=str(measurement.source)))


def content_of(measurement: Measurement, found: Fitted) -> dict[str, Any]:
    """What stands in identification.json."""
    evidence, outcome = found.evidence, found.outcome
    unit, factor = evidence.channel.declared_unit, evidence.channel.declared_factor
    covariances = told_covariance(outcome, evidence)
    left, lost = _missed(found), _lost(found)
    roles = {"fit": (evidence.fitted, outcome.fit_residuals), "holdout": (evidence.held, outcome.holdout)}
    return {
        "system": measurement.system,
        "method": "output_error",
        "channels": [channel.name for channel in evidence.fit[0].channels],
        "parameters": final_parameters(outcome, covariances, evidence),
        "damping_ratio_percent": damping_ratio(outcome, covariances),
        "natural_frequency_hz": {
            "value": natural_frequency_hz(outcome.hypothesis.model, outcome.flat_given()),
            "unit": "Hz",
        },
        "residual": {
            role: {"rmse": rmse(residuals) / factor, "unit": unit} if residuals else None
            for role, (_, residuals) in roles.items()
        },
        "lack_of_fit": {
            "significant": left.significant or lost is not None,
            "excess_percent": left.percent if lost is None else lost,
            "threshold_percent": left.threshold,
            "source": str(measurement.source),
        },
        "contradicted": _far_off(outcome, evidence)
        or noise_above(found.noise, rmse(outcome.fit_residuals), evidence.channel),
        "overruled": list(found.overruled),
        "too_short": too_short(evidence, outcome) or None,
        "segment_s": evidence.segments.seconds or None,
        "records": {
            record.name: {"role": role, "rmse": rmse([residual]) / factor, "unit": unit}
            for role, (records, residuals) in roles.items()
            for record, residual in zip(records, residuals, strict=True)
        },
        "converged": outcome.fitted.converged,
    }


def _missed(found: Fitted) -> Excess:
    """What is missed of the held-out records, or of the fitted ones where there are none that hold more than noise."""
    evidence, outcome = found.evidence, found.outcome
    if outcome.holdout:
        held = excess(outcome.holdout, evidence.held, found.noise)
        if held.threshold < WHOLE:
            return held
    return excess(outcome.fit_residuals, evidence.fitted, found.noise)


def _lost(found: Fitted) -> float | None:
    """What is left of the fitted records, in % of their variance, where that is most of it, however random it looks."""
    evidence, outcome = found.evidence, found.outcome
    left = nrmse(outcome.fit_residuals, evidence.fitted) ** 2
    return 100 * left if left > evidence.settings.lost_share else None


def table_of(content: dict[str, Any]) -> str:
    """The parameters with their intervals, and what is missing."""
    shown = {k: v for k, v in content["parameters"].items() if not k.startswith(SHOWN)}
    rows = estimate_rows({"damping_ratio_percent": content["damping_ratio_percent"], **shown})
    rows.append(("natural_frequency_hz", f"{content['natural_frequency_hz']['value']:.6g}", "", "Hz"))
    rows += residual_rows(content["records"])
    text = tables.parameter_table(f"identified by output error from {', '.join(content['channels'])}", rows)
    lacking = content["lack_of_fit"]
    if lacking["significant"]:
        text = (
            f"{text.rstrip()}\n\nlack of fit: the nominal simulation misses {lacking['excess_percent']:.3g} % of the "
            f"signal's variance beyond the noise, and the intervals do not cover what is missing; "
            f"task=explain measurement.path={lacking['source']} looks for its name\n"
        )
    own = (content["contradicted"], content["too_short"], _hardly_told(content))
    said = filter(None, (text.rstrip(), *content["overruled"], *own))
    return "\n\n".join(said) + "\n"


def _hardly_told(content: dict[str, Any]) -> str | None:
    """What would tell a damping that these records do not."""
    ratio = content["damping_ratio_percent"]
    is_of_gears = any(name.startswith(MESH) for name in content["parameters"])
    if ratio is None or not is_of_gears or ratio["interval95"][0] > 0:
        return None
    if ratio["interval95"][1] < UNTOLD * ratio["value"]:
        return None
    return (
        "these records hardly tell the damping: in steady running the shape of the mesh stiffness may stand in for it; "
        "records at other speeds, or a run-up through the resonance, tell it (task=plan says which)"
    )


def _far_off(outcome: Outcome, evidence: Evidence) -> str | None:
    """What is stated and the records put far away, as they do with a mesh stiffness beside a torque in a wrong unit."""
    pairs = {
        stated: (outcome.values[fitted], evidence.parameters[stated])
        for stated, fitted in (("mesh_stiffness_max", f"{MESH}.maximum"),)
        if stated in evidence.parameters and fitted in outcome.values
    }
    return (
        contradicts_stated(outcome, evidence)
        or torque_of_the_other_shaft(outcome, evidence)
        or _unlike_steel(outcome, evidence)
        or far_from_stated(pairs, "unit and gain of the torque and of the response, and the value itself")
    )


def _unlike_steel(outcome: Outcome, evidence: Evidence) -> str | None:
    """A mesh stiffness that no teeth of the stated module have, as with a module or an inertia in a wrong unit."""
    module, found = evidence.parameters.get("module"), outcome.values.get(f"{MESH}.maximum")
    if not module or found is None:
        return None
    usual = STEEL * WIDTH * module
    if SOFTEST < found / usual < STIFFEST:
        return None
    return (
        f"mesh_stiffness_max comes out at {found:.3g} N/m, and steel teeth of this module have some {usual:.2g} N/m: "
        "check the units of module and inertias, and of the response"
    )


def figure_of(found: Fitted, content: dict[str, Any]) -> figures.Figure:
    """Measured and simulated records, with what was found."""
    evidence, outcome = found.evidence, found.outcome
    factor = evidence.channel.declared_factor
    panels = [
        *_panels("fit", evidence.fitted[:MOST_PANELS], outcome.fit_residuals[:MOST_PANELS], factor),
        *_panels("holdout", evidence.held[:MOST_PANELS], outcome.holdout[:MOST_PANELS], factor),
    ]
    text = [f"natural frequency {content['natural_frequency_hz']['value']:.5g} Hz"]
    if ratio := content["damping_ratio_percent"]:
        low, high = ratio["interval95"]
        text = [f"damping ratio {ratio['value']:.4g} % ({low:.4g} … {high:.4g})", *text]
    return figures.identification_figure(panels, content["residual"]["fit"]["unit"], text, evidence.channel.name)


def _panels(
    role: str, records: Sequence[FitRecord], residuals: Sequence[Tensor], factor: float
) -> list[dict[str, Any]]:
    """Some records of one role."""
    pairs = zip(records, first_channel(residuals, records), strict=True)
    return [panel(one, role, one.response.numpy() - left, factor) for one, left in pairs]
