"""task=identify for a gear pair without a network: the nominal simulation is fitted to whatever channels respond."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from torch import Tensor

from gear_damping.config.settings import Settings
from gear_damping.errors import InputError, Problem
from gear_damping.explanation.answer.gain import damping_ratio, final_parameters, rmse
from gear_damping.explanation.casing.heard import is_casing
from gear_damping.explanation.evidence.excess import excess
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.explain import Explanation, explain
from gear_damping.explanation.model.hypothesis import Outcome, natural_frequency_hz
from gear_damping.explanation.model.spread import spread_of
from gear_damping.explanation.steps.too_short import too_short
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.measurement.record import Measurement
from gear_damping.reporting import figures, tables
from gear_damping.simulation.solver_settings import Solver
from gear_damping.tasks import statements
from gear_damping.tasks.run_folder import RunFolder

MOST_PANELS = 3  # records of each role shown in the figure
SHOWN = ("mesh_stiffness_shape",)  # what is fitted in many numbers stands in the JSON alone


def by_nominal_model(settings: Settings, measurement: Measurement, folder: RunFolder) -> dict[str, Any]:
    """Fit the nominal gear pair, write what was found, and return the metrics for run.json.

    Raises:
        InputError: a record has no response that can be fitted, such as an accelerometer on a casing alone.
    """
    found = nominal_fit(measurement, settings.simulator.solver)
    evidence, outcome = found.evidence, found.found.outcome
    content = _content(measurement, found)
    folder.write_json("identification.json", content)
    text = _table(content)
    folder.write_text("identification.txt", text)
    statements.say(text)
    if not outcome.fitted.converged:
        statements.say("the search did not converge: take the figures as a first guess")
    figures.save(_figure(evidence, outcome, content), folder.path / "identification.png")
    ratio = content["damping_ratio_percent"]
    return {
        "damping_ratio_percent": ratio and ratio["value"],
        "natural_frequency_hz": content["natural_frequency_hz"]["value"],
        "rmse_fit": content["residual"]["fit"]["rmse"],
        "rmse_holdout": content["residual"]["holdout"]["rmse"],
    }


def nominal_fit(measurement: Measurement, solver: Solver) -> Explanation:
    """The nominal gear pair as task=explain fits it, where no effect may be a cause.

    Raises:
        InputError: nothing was measured that a simulation can be compared with.
    """
    if is_casing(measurement):
        rule = "an accelerometer on a casing tells no damping: its path from the mesh is unknown"
        remedy = "measure a transmission error or a shaft, or choose task=explain for what the casing shows"
        raise InputError(Problem("records", rule, remedy=remedy, source=str(measurement.source)))
    return explain(measurement, statements.say, solver=solver, library={})


def _content(measurement: Measurement, found: Explanation) -> dict[str, Any]:
    evidence, outcome = found.evidence, found.found.outcome
    unit, factor = evidence.channel.declared_unit, evidence.channel.declared_factor
    spread = spread_of(outcome, evidence)
    left = excess(outcome.holdout, evidence.held, found.noise)
    roles = {"fit": (evidence.fitted, outcome.fit_residuals), "holdout": (evidence.held, outcome.holdout)}
    return {
        "system": measurement.system,
        "method": "output_error",
        "channels": [channel.name for channel in evidence.fit[0].channels],
        "parameters": final_parameters(outcome, spread, evidence),
        "damping_ratio_percent": damping_ratio(outcome, spread),
        "natural_frequency_hz": {"value": natural_frequency_hz(outcome.hypothesis.model, outcome.flat_given())},
        "residual": {
            role: {"rmse": rmse(residuals) / factor, "unit": unit} for role, (_, residuals) in roles.items()
        },
        "lack_of_fit": {
            "significant": left.significant,
            "excess_percent": left.percent,
            "threshold_percent": left.threshold,
            "source": str(measurement.source),
        },
        "too_short": too_short(evidence) or None,
        "segment_s": evidence.segments.seconds or None,
        "records": {
            record.name: {"role": role, "rmse": rmse([residual]) / factor, "unit": unit}
            for role, (records, residuals) in roles.items()
            for record, residual in zip(records, residuals, strict=True)
        },
        "converged": outcome.fitted.converged,
    }


def _table(content: dict[str, Any]) -> str:
    rows = []
    shown = {k: v for k, v in content["parameters"].items() if not k.startswith(SHOWN)}
    for name, found in {"damping_ratio_percent": content["damping_ratio_percent"], **shown}.items():
        if found is not None:
            low, high = found["interval95"]
            rows.append((name, f"{found['value']:.6g}", f"{low:.6g} … {high:.6g}", found["unit"]))
    rows.append(("natural_frequency_hz", f"{content['natural_frequency_hz']['value']:.6g}", "", "Hz"))
    for name, found in content["records"].items():
        rows.append((f"residual of {name} ({found['role']})", f"{found['rmse']:.4g}", "", found["unit"]))
    text = tables.parameter_table(f"identified by output error from {', '.join(content['channels'])}", rows)
    lacking = content["lack_of_fit"]
    if lacking["significant"]:
        text = (
            f"{text.rstrip()}\n\nlack of fit: the nominal simulation misses {lacking['excess_percent']:.3g} % of the "
            f"held-out signal's variance beyond the noise, and the intervals do not cover what is missing; "
            f"task=explain measurement.path={lacking['source']} looks for its name\n"
        )
    return f"{text.rstrip()}\n\n{content['too_short']}\n" if content["too_short"] else text


def _figure(evidence: Evidence, outcome: Outcome, content: dict[str, Any]) -> figures.Figure:
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
    """The first channel of records beside what the simulation makes of it."""
    found = []
    for record, residual in zip(records, residuals, strict=True):
        samples = len(residual) // len(record.channels)
        measured = record.response[:samples]
        found.append(
            {
                "name": record.name,
                "role": role,
                "time": np.arange(samples) / record.sampling_rate,
                "measured": measured.numpy() / factor,
                "simulated": (measured - residual[:samples]).numpy() / factor,
            }
        )
    return found
