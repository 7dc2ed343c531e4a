"""What one window of 30 samples tells, and how much of it the networks of windows take: `make window`.

Networks are trained and asked on windows of unseen runs of family `paper`, at one level of noise each; exact Bayes is
asked about the same noisy windows. Each training is kept; the same command goes on. Writes its part of docs/limit.md.
"""

import argparse
import json
from pathlib import Path
from statistics import fmean
from typing import Any

import torch

from benchmarks.limit.networks import OF_WINDOWS
from benchmarks.marked import put
from gear_damping.config.settings import Settings, read_settings
from gear_damping.identification.datamodule import Material, WindowDataModule
from gear_damping.identification.known_model.exact_bayes import window_bayes
from gear_damping.identification.known_model.known_runs import range_of
from gear_damping.identification.lightning_module import EstimatorConfig
from gear_damping.identification.noise import SensorNoise
from gear_damping.identification.protocols import Protocol
from gear_damping.identification.trainer import Place, fit_estimator, predict_windows
from gear_damping.simulation.plan import run_plan
from gear_damping.tasks.composed import composed
from gear_damping.tasks.simulated import plan_of, run_set_of

PAGE = Path(__file__).parents[1] / "docs" / "limit.md"
BEFORE, AFTER = "<!-- measured by `make window` -->", "<!-- end of one window -->"
NETWORKS = ("raw_lstm", "cwt_lstm")
SNRS = (30, 20, 10, 1)  # dB
ASKED = 4000  # windows of unseen runs


def main() -> None:
    """Do what is not kept yet, then write the table."""
    parser = argparse.ArgumentParser(prog="make window ARGS=...", description=__doc__)
    parser.add_argument("--snrs", type=int, nargs="+", default=SNRS)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--out", type=Path, default=Path("outputs/window"))
    parser.add_argument("--no-page", dest="page", action="store_false", help="leave docs/limit.md as it is")
    asked = parser.parse_args()
    rows = [_kept(snr, seed, asked.out) for snr in asked.snrs for seed in asked.seeds]
    text = table(rows)
    print(text)
    if asked.page:
        put(text, PAGE, BEFORE, AFTER)


def _kept(snr: int, seed: int, out: Path) -> dict[str, Any]:
    path = out / f"{snr}_{seed}.json"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        found = measured(snr, seed, out / f"{snr}_{seed}")
        path.write_text(json.dumps(found) + "\n")
        print(found, flush=True)
    return json.loads(path.read_text())


def measured(snr: int, seed: int, folder: Path) -> dict[str, Any]:
    """Root mean square errors of everybody on the same windows, %."""
    words = ["experiment=baseline", "family=paper", "protocol=by_run", f"seed={seed}"]
    settings: Settings = read_settings(*composed(words))
    plan = plan_of(settings)
    runs, protocol = run_set_of(run_plan(plan), plan), Protocol(**settings.protocol)
    data = WindowDataModule(Material(runs, protocol, SensorNoise(float(snr))), seed=seed)
    found = {}
    for name in NETWORKS:
        fit = fit_estimator(EstimatorConfig(name), data, OF_WINDOWS, Place(folder / name), seed=seed)
        true, said = predict_windows(fit.estimator, data.test_dataloader())
        found[name] = _rms(said[:ASKED], true[:ASKED])
    batches = list(data.test_dataloader())
    windows, true = (torch.cat([batch[part] for batch in batches])[:ASKED] for part in (0, 1))
    starts = torch.arange(0, plan.n_samples - protocol.window + 1, protocol.evaluation_stride)
    ends = range_of(plan.prior)
    bayes = window_bayes(plan, ends, snr, starts, protocol.window).estimate(windows)
    held = (bayes.low <= true) & (true <= bayes.high)
    found |= {"exact_bayes": _rms(bayes.ratio, true), "mean": _rms(torch.full_like(true, sum(ends) / 2), true)}
    return {"snr_db": snr, "seed": seed, "rmse_percent": found, "held": float(held.double().mean())}


def _rms(said: torch.Tensor, true: torch.Tensor) -> float:
    return float((said.double() - true.double()).square().mean().sqrt())


def table(rows: list[dict[str, Any]]) -> str:
    """Means over the seeds: errors, and the share of what a window tells that a network takes."""
    lines = [
        "| SNR / dB | exact Bayes | its 90 % interval holds | " + " | ".join(f"`{n}`" for n in NETWORKS) + " | mean | "
        + " | ".join(f"`{n}` takes" for n in NETWORKS) + " | seeds |",
        "|---|---|---|" + "---|" * (2 * len(NETWORKS) + 2),
    ]  # fmt: skip
    for snr in dict.fromkeys(row["snr_db"] for row in rows):
        some = [row for row in rows if row["snr_db"] == snr]
        rmse = {name: fmean(row["rmse_percent"][name] for row in some) for name in some[0]["rmse_percent"]}
        taken = [f"{100 * fmean(_taken(row['rmse_percent'], name) for row in some):.0f} %" for name in NETWORKS]
        errors = " | ".join(f"{rmse[name]:.4f}" for name in (*NETWORKS, "mean"))
        held = fmean(row["held"] for row in some)
        lines.append(
            f"| {snr} | {rmse['exact_bayes']:.4f} | {100 * held:.1f} % | {errors} | {' | '.join(taken)} | {len(some)} |"
        )
    return "\n".join(lines)


def _taken(rmse: dict[str, float], name: str) -> float:
    """Share of the fall of the mean squared error from the mean predictor to exact Bayes."""
    return (rmse["mean"] ** 2 - rmse[name] ** 2) / (rmse["mean"] ** 2 - rmse["exact_bayes"] ** 2)


if __name__ == "__main__":
    main()
