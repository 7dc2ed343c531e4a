"""task=identify: damping from a measured record, by output error or by a trained network."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
import torch

from gear_damping.config.settings import Settings
from gear_damping.errors import InputError, Problem
from gear_damping.identification.lightning_module import load_estimator
from gear_damping.identification.observation import fit_record, known_of, require_alike, require_fitted
from gear_damping.identification.oscillator import Estimate, OscillatorFit, fit_oscillator
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.segments import Segments
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.record import Channel, Measurement, Record
from gear_damping.reporting import figures, tables
from gear_damping.tasks import statements
from gear_damping.tasks.identify_gears import by_nominal_model
from gear_damping.tasks.lack_of_fit import lack_of_fit, sentence
from gear_damping.tasks.progress import progress_bar
from gear_damping.tasks.run_folder import RunFolder

MOST_PANELS = 3  # records of each role shown in the figure


def run(settings: Settings, folder: RunFolder) -> dict[str, Any]:
    """Identify; returns the metrics for run.json."""
    measurement = load_measurement(settings.measurement_path)
    _note_inputs(measurement, folder)
    _refuse_faults(measurement)
    if settings.checkpoint is not None:
        return _by_network(settings, measurement, folder)
    if measurement.system != "oscillator":
        return by_nominal_model(settings, measurement, folder)
    return _by_output_error(settings, measurement, folder)


def _note_inputs(measurement: Measurement, folder: RunFolder) -> None:
    for path in dict.fromkeys([measurement.source, *(record.file for record in measurement.records)]):
        folder.add_input(path)


def _refuse_faults(measurement: Measurement) -> None:
    """Damaged data give no damping figure."""
    found = [finding for finding in measurement.findings if finding.severity == "data_problem"]
    if found:
        raise InputError(
            [
                Problem(f"{f.record}.{f.channel}".strip("."), f"{f.kind}: {f.message}", source=str(measurement.source))
                for f in found
            ]
        )
    for finding in measurement.findings:
        statements.say(f"note: {finding.record} {finding.channel}: {finding.message}")


def _by_output_error(settings: Settings, measurement: Measurement, folder: RunFolder) -> dict[str, Any]:
    require_fitted(measurement)
    known = known_of(measurement)
    spring = known.values.get("stiffness", 1.0) != 0
    roles = {
        "fit": [fit_record(r, "oscillator", spring) for r in _fit_on(measurement)],
        "holdout": [fit_record(r, "oscillator", spring) for r in measurement.with_role("holdout")],
    }
    require_alike([*roles["fit"], *roles["holdout"]], str(measurement.source))
    channels = {name: c for record in measurement.records for name, c in record.channels.items()}
    channel = channels[roles["fit"][0].observed.name]
    stated = Segments(measurement.segment_s, exact=True) if measurement.segment_s else None
    with progress_bar("fitting", settings.progress) as progress:
        found = fit_oscillator(roles["fit"], roles["holdout"], progress, settings.simulator.solver, known, stated)
    content = _identification(found, measurement, roles, channel)
    lacking = lack_of_fit(found.predictions, roles["fit"], roles["holdout"], channel)
    content["lack_of_fit"] = lacking
    folder.write_json("identification.json", content)
    text = _table(content)
    if lacking and lacking["significant"]:
        text = f"{text.rstrip()}\n\n{sentence(lacking, str(measurement.source))}\n"
    folder.write_text("identification.txt", text)
    statements.say(text)
    if not found.converged:
        statements.say("the search did not converge: take the figures as a first guess")
    figures.save(_figure(found, roles, content, channel), folder.path / "identification.png")
    return {
        "damping_ratio_percent": found.damping_ratio_percent and found.damping_ratio_percent.value,
        "natural_frequency_hz": found.natural_frequency_hz and found.natural_frequency_hz.value,
        "rmse_fit": content["residual"]["fit"]["rmse"],
        "rmse_holdout": (content["residual"]["holdout"] or {}).get("rmse"),
    }


def _fit_on(measurement: Measurement) -> Sequence[Record]:
    return measurement.with_role("fit") or measurement.with_role(None)


def _identification(
    found: OscillatorFit, measurement: Measurement, roles: Mapping[str, Sequence[FitRecord]], channel: Channel
) -> dict[str, Any]:
    unit, factor = channel.declared_unit, channel.declared_factor

    def residual(value: float | None) -> dict[str, Any] | None:
        return None if value is None else {"rmse": value / factor, "unit": unit}

    def plain(estimate: Estimate | None) -> dict[str, Any] | None:
        return None if estimate is None else asdict(estimate)

    records = {
        record.name: {
            "role": role,
            "rmse": float(found.residuals[record.name].square().mean().sqrt()) / factor,
            "unit": unit,
        }
        for role, listed in roles.items()
        for record in listed
    }
    return {
        "system": measurement.system,
        "method": "output_error",
        "channel": channel.name,
        "parameters": {name.split(".")[-1]: asdict(value) for name, value in found.parameters.items()},
        "damping_ratio_percent": plain(found.damping_ratio_percent),
        "natural_frequency_hz": plain(found.natural_frequency_hz),
        "log_decrement": plain(found.log_decrement),
        "residual": {"fit": residual(found.rmse["fit"]), "holdout": residual(found.rmse["holdout"])},
        "segment_s": found.segments.seconds or None,
        "own": found.own,
        "records": records,
        "converged": found.converged,
    }


def _table(content: dict[str, Any]) -> str:
    rows = []
    named = {key: content[key] for key in ("damping_ratio_percent", "natural_frequency_hz", "log_decrement")}
    for name, found in {**named, **content["parameters"]}.items():
        if found is not None:
            low, high = found["interval95"]
            rows.append((name, f"{found['value']:.6g}", f"{low:.6g} … {high:.6g}", found["unit"]))
    for name, found in content["records"].items():
        rows.append((f"residual of {name} ({found['role']})", f"{found['rmse']:.4g}", "", found["unit"]))
    title = "identified by output error, per unit of mass"
    if content["segment_s"]:
        title += f", in segments of {content['segment_s']:.3g} s"
    return tables.parameter_table(title, rows)


def _figure(
    found: OscillatorFit, roles: Mapping[str, Sequence[FitRecord]], content: dict[str, Any], channel: Channel
) -> figures.Figure:
    factor, panels = channel.declared_factor, []
    for record in (*roles["fit"][:MOST_PANELS], *roles["holdout"][-MOST_PANELS:]):
        simulated = found.predictions[record.name]
        samples = len(simulated) // len(record.channels)
        panels.append(
            {
                "name": record.name,
                "role": content["records"][record.name]["role"],
                "time": np.arange(samples) / record.sampling_rate,
                "measured": record.response[:samples].numpy() / factor,
                "simulated": simulated[:samples].numpy() / factor,
            }
        )
    stated = content["parameters"].items()
    text = [f"{key.replace('_', ' ')} {entry['value']:.4g} {entry['unit']}" for key, entry in stated]
    if zeta := content["damping_ratio_percent"]:
        text = [f"damping ratio {zeta['value']:.4g} % ({zeta['interval95'][0]:.4g} … {zeta['interval95'][1]:.4g})"]
        text.append(f"natural frequency {content['natural_frequency_hz']['value']:.5g} Hz")
    return figures.identification_figure(panels, content["residual"]["fit"]["unit"], text, channel.name)


def _by_network(settings: Settings, measurement: Measurement, folder: RunFolder) -> dict[str, Any]:
    folder.add_input(settings.checkpoint)
    estimator = load_estimator(settings.checkpoint)
    wanted = settings.measurement_channel or (
        "transmission_error" if measurement.system == "gear_pair" else "displacement"
    )
    records, problems = {}, []
    for record in measurement.records:
        if wanted not in record.channels:
            remedy = f"choose measurement.channel from {', '.join(record.channels)}"
            problems.append(
                Problem(f"{record.name}.{wanted}", "no such channel", remedy=remedy, source=str(record.file))
            )
            continue
        found = estimator.predict_record(torch.as_tensor(record.channels[wanted].values), record.sampling_rate)
        records[record.name] = {
            "damping_ratio_percent": found.damping_ratio_percent,
            "spread_over_windows_percent": found.spread_percent,
        }
    if problems:
        raise InputError(problems)
    mean = sum(r["damping_ratio_percent"] for r in records.values()) / len(records)
    content = {
        "system": measurement.system,
        "method": "network",
        "parameters": {},
        "damping_ratio_percent": {"value": mean, "interval95": None},
        "natural_frequency_hz": None,
        "residual": {"fit": None, "holdout": None},
        "records": records,
    }
    folder.write_json("identification.json", content)
    statements.say(f"damping ratio {mean:.4f} % of critical, the mean over {len(records)} records")
    statements.say("a network of windows gives no interval, and holds only for gears like those it was trained on")
    return {"damping_ratio_percent": mean}
