"""task=identify: damping from a measured record, by output error or by a trained network."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import torch

from gear_damping.config.settings import Settings
from gear_damping.errors import InputError, Problem
from gear_damping.identification.lightning_module import load_estimator
from gear_damping.identification.oscillator import OscillatorFit, fit_oscillator
from gear_damping.identification.output_error.problem import FitRecord
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.record import Measurement, Record
from gear_damping.reporting import figures, tables
from gear_damping.tasks import statements
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
        rule = "a gear record is identified by a trained network or explained"
        remedy = "give checkpoint=…/best.ckpt, or choose task=explain"
        raise InputError(Problem("checkpoint", rule, remedy=remedy, source=str(measurement.source)))
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
    fit_on = measurement.with_role("fit") or measurement.with_role(None)
    holdout = measurement.with_role("holdout")
    _require_response(fit_on + holdout, measurement)
    fitted, held = [_fit_record(r) for r in fit_on], [_fit_record(r) for r in holdout]
    with progress_bar("fitting", settings.progress) as progress:
        found = fit_oscillator(fitted, held, progress, settings.simulator.solver)
    content = _identification(found, measurement, fit_on, holdout)
    lacking = lack_of_fit(found.predictions, fitted, held, fit_on[0].channels["displacement"])
    content["lack_of_fit"] = lacking
    folder.write_json("identification.json", content)
    text = _table(content)
    if lacking and lacking["significant"]:
        text = f"{text.rstrip()}\n\n{sentence(lacking, str(measurement.source))}\n"
    folder.write_text("identification.txt", text)
    statements.say(text)
    if not found.converged:
        statements.say("the search did not come to rest: take the figures as a first guess")
    figures.save(
        _figure(found, fit_on[:MOST_PANELS] + holdout[-MOST_PANELS:], content), folder.path / "identification.png"
    )
    return {
        "damping_ratio_percent": found.damping_ratio_percent.value,
        "natural_frequency_hz": found.natural_frequency_hz.value,
        "rmse_fit": content["residual"]["fit"]["rmse"],
        "rmse_holdout": (content["residual"]["holdout"] or {}).get("rmse"),
    }


def _require_response(records: Sequence[Record], measurement: Measurement) -> None:
    problems = [
        Problem(
            f"{record.name}.displacement", "an oscillator is identified from its displacement", source=str(record.file)
        )
        for record in records
        if "displacement" not in record.channels
    ]
    if len({("force" in record.channels) for record in records}) > 1:
        rule, remedy = "some records have a force and some do not", "identify free decays and forced records apart"
        problems.append(Problem("records", rule, remedy=remedy, source=str(measurement.source)))
    if problems:
        raise InputError(problems)


def _fit_record(record: Record) -> FitRecord:
    inputs = {name: torch.as_tensor(c.values) for name, c in record.channels.items() if name == "force"}
    return FitRecord(record.name, torch.as_tensor(record.channels["displacement"].values), record.sampling_rate, inputs)


def _identification(
    found: OscillatorFit, measurement: Measurement, fit_on: Sequence[Record], holdout: Sequence[Record]
) -> dict[str, Any]:
    channel = fit_on[0].channels["displacement"]
    unit, factor = channel.declared_unit, channel.declared_factor

    def residual(value: float | None) -> dict[str, Any] | None:
        return None if value is None else {"rmse": value / factor, "unit": unit}

    records = {}
    for record in (*fit_on, *holdout):
        difference = torch.as_tensor(record.channels["displacement"].values) - found.predictions[record.name]
        records[record.name] = {
            "role": "fit" if record in fit_on else "holdout",
            "rmse": float(difference.square().mean().sqrt()) / factor,
            "unit": unit,
        }
    return {
        "system": measurement.system,
        "method": "output_error",
        "parameters": {name.split(".")[-1]: asdict(value) for name, value in found.parameters.items()},
        "damping_ratio_percent": asdict(found.damping_ratio_percent),
        "natural_frequency_hz": asdict(found.natural_frequency_hz),
        "log_decrement": asdict(found.log_decrement),
        "residual": {"fit": residual(found.rmse["fit"]), "holdout": residual(found.rmse["holdout"])},
        "records": records,
        "converged": found.converged,
    }


def _table(content: dict[str, Any]) -> str:
    rows = []
    named = {key: content[key] for key in ("damping_ratio_percent", "natural_frequency_hz", "log_decrement")}
    for name, found in {**named, **content["parameters"]}.items():
        low, high = found["interval95"]
        rows.append((name, f"{found['value']:.6g}", f"{low:.6g} … {high:.6g}", found["unit"]))
    for name, found in content["records"].items():
        rows.append((f"residual of {name} ({found['role']})", f"{found['rmse']:.4g}", "", found["unit"]))
    return tables.parameter_table("identified by output error, per unit of mass", rows)


def _figure(found: OscillatorFit, records: Sequence[Record], content: dict[str, Any]) -> figures.Figure:
    factor = records[0].channels["displacement"].declared_factor
    panels = [
        {
            "name": record.name,
            "role": content["records"][record.name]["role"],
            "time": record.time - record.time[0],
            "measured": record.channels["displacement"].values / factor,
            "simulated": found.predictions[record.name].numpy() / factor,
        }
        for record in records
    ]
    zeta, natural = content["damping_ratio_percent"], content["natural_frequency_hz"]
    text = [
        f"damping ratio {zeta['value']:.4g} % ({zeta['interval95'][0]:.4g} … {zeta['interval95'][1]:.4g})",
        f"natural frequency {natural['value']:.5g} Hz",
    ]
    return figures.identification_figure(panels, content["residual"]["fit"]["unit"], text, "displacement")


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
