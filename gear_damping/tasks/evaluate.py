"""task=evaluate: trained networks on fresh runs of the configured simulator, beside the bound and the controls."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from statistics import fmean
from time import perf_counter
from typing import Any

import torch

from gear_damping.config.settings import Settings
from gear_damping.config.simulator import SENSOR_NOISE
from gear_damping.errors import InputError, Problem
from gear_damping.identification.asked import estimates_of
from gear_damping.identification.bench import CLEAN, Bench, Said, bench, mean_over_seeds
from gear_damping.identification.known_model.output_error import output_error
from gear_damping.identification.known_model.unscented_kalman import unscented_kalman
from gear_damping.identification.lightning_module import DampingModule
from gear_damping.identification.saved import files_of, load_estimator
from gear_damping.reporting import figures
from gear_damping.reporting.evaluation import effect_table, evaluation_figure, evaluation_table, ratio_table
from gear_damping.simulation.plan import SimulationPlan
from gear_damping.tasks import statements
from gear_damping.tasks.evaluated_effects import asked_with_effects, plans_with, strange_share
from gear_damping.tasks.run_folder import RunFolder
from gear_damping.tasks.simulated import TEST_SEED, plan_of, simulated

BEST = "*/seed_*/best.ckpt"  # of a training's folder
SHOWN = ("rmse_percent", "median_relative_error", "skill", "ratio_to_bound", "coverage90")
KNOWING = {"output_error": output_error, "unscented_kalman": unscented_kalman}


def run(settings: Settings, folder: RunFolder) -> dict[str, Any]:
    """Score networks on runs that they never met; returns the metrics for run.json."""
    paths = _checkpoints(settings.checkpoint)
    folder.add_inputs((file for path in paths for file in files_of(path)), "checkpoint")
    modules = {path: load_estimator(path, settings.model.plugins) for path in paths}
    ratio = settings.simulator.damping_ratio_percent
    plan = replace(plan_of(settings), seed=settings.seed + 2 * TEST_SEED, damping_ratio_percent=ratio)
    others = plans_with(plan, settings.evaluation["effects"] or ())
    runs = simulated(plan, settings)
    generator = torch.Generator().manual_seed(plan.seed + 2)
    made = bench(plan, runs, _levels(settings), signals=runs.record(generator, skip=(SENSOR_NOISE,)))
    _require_alike(modules, plan, made)
    content = {"family": plan.prior.name, "test_runs": len(made), "irregular_runs": int((~made.regular).sum())}
    content["snr_db"] = {f"{snr:g}": _level(made, snr, modules, settings) for snr in made.bounds}
    content["effects"] = asked_with_effects(others, _by_name(modules), _levels(settings), made.mean_ratio)
    first = _first(content)
    folder.write_json("evaluation.json", {**first, **content})
    text = "\n\n".join([evaluation_table(content), ratio_table(content), *effect_table(content)])
    folder.write_text("evaluation.txt", text)
    statements.log(text)
    figures.save(evaluation_figure(content), folder.path / "evaluation.png")
    _draw_pairs(made, next(iter(modules.values())), folder)
    return first


def _checkpoints(path: Path) -> list[Path]:
    """The network, or every one of a training, control included."""
    return sorted(path.glob(BEST)) or [files_of(path)[0]]


def _levels(settings: Settings) -> tuple[float, ...]:
    """Signal-to-noise ratios of the sensor in dB."""
    noise = settings.simulator.sensor_noise_db
    return settings.evaluation["snr_db"] or ((CLEAN,) if noise is None else (noise,))


def _require_alike(modules: Mapping[Path, DampingModule], plan: SimulationPlan, made: Bench) -> None:
    """Refuse networks of other records.

    Raises:
        InputError: of each that another rate or longer records were trained on.
    """
    length, problems = made.runs.response.shape[-1], []
    for path, module in modules.items():
        rate, window = module.data["sampling_rate"], module.data["window"]
        if rate != plan.sampling_rate:
            remedy = f"simulator.sampling_rate={rate:g}"
            rule = f"was trained at {rate:g} Hz, and these runs have {plan.sampling_rate:g} Hz"
            problems.append(Problem("checkpoint", rule, str(path), remedy))
        if window > length:
            remedy = f"simulator.n_samples={window}"
            rule = f"sees {window} samples at once, and runs have {length}"
            problems.append(Problem("checkpoint", rule, str(path), remedy))
    if problems:
        raise InputError(problems)


def _level(made: Bench, snr: float, modules: Mapping[Path, DampingModule], settings: Settings) -> dict[str, Any]:
    """Every estimator at one level of noise: the mean over the seeds of a network, and each."""
    found: dict[str, list[Said]] = {}
    for name, said in _asked(made, snr, modules, settings):
        found.setdefault(name, []).append(said)
    limit, kept = made.limit(snr), made.regular
    row = {"bound_percent": None if limit is None else float(limit[kept].square().mean().sqrt())}
    scored = {name: mean_over_seeds(made, said, snr) for name, said in found.items()}
    for name, shares in _strange(made, snr, modules).items():
        scored[name]["strange"] = fmean(shares)
    return row | {"estimators": scored}


def _strange(made: Bench, snr: float, modules: Mapping[Path, DampingModule]) -> dict[str, list[float]]:
    """The share of the records that a network calls unlike its training, of each seed by estimator."""
    records = made.records(torch.arange(len(made)), snr)
    shares = {name: [strange_share(one, records) for one in own] for name, own in _by_name(modules).items()}
    return {name: own for name, own in shares.items() if None not in own}


def _by_name(modules: Mapping[Path, DampingModule]) -> dict[str, list[DampingModule]]:
    """Networks of several seeds together."""
    found: dict[str, list[DampingModule]] = {}
    for path, module in modules.items():
        found.setdefault(_named(path, module), []).append(module)
    return found


def _named(path: Path, module: DampingModule) -> str:
    """What a network is called in the tables."""
    return "white_noise" if path.parent.parent.name == "white_noise" else module.hparams["estimator"]


def _asked(
    made: Bench, snr: float, modules: Mapping[Path, DampingModule], settings: Settings
) -> Iterator[tuple[str, Said]]:
    rows = torch.arange(len(made))
    records = made.records(rows, snr)
    for path, module in modules.items():
        begun = perf_counter()
        said = estimates_of(module, records)
        yield _named(path, module), (said, (perf_counter() - begun) / len(rows))
    for name, estimate in KNOWING.items() if settings.evaluation["known_model"] else ():
        begun = perf_counter()
        yield name, (estimate(made.known(rows, snr)), (perf_counter() - begun) / len(rows))
    yield "mean", (made.mean_predictor, 0.0)


def _first(content: Mapping[str, Any]) -> dict[str, Any]:
    """The first network at the first level, for run.json and sweeps."""
    level = next(iter(content["snr_db"].values()))
    found = next(iter(level["estimators"].values()))
    return {key: found[key] for key in SHOWN}


def _draw_pairs(made: Bench, module: DampingModule, folder: RunFolder) -> None:
    said = estimates_of(module, made.records(torch.arange(len(made)), next(iter(made.bounds))))
    pairs = {module.hparams["estimator"]: {"per_run": {"true": made.true.tolist(), "predicted": said.ratio.tolist()}}}
    figures.save(figures.predicted_against_true_figure(pairs), folder.path / "predicted_against_true.png")
