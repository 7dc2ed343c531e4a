"""How near estimators of the damping ratio come to what whole records hold: `make limit`.

Trains on a family of runs and evaluates on others, every estimator on the same noisy records. Each training and each
part of an evaluation is kept; the same command goes on where it was stopped. Writes `outputs/limit/evaluation.json`
and `docs/limit.md`.
"""

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path

import torch

from benchmarks.limit import page
from benchmarks.limit.bench import SNRS, bench
from benchmarks.limit.networks import NETWORKS, estimates_of_network, trained
from gear_damping.identification.bench import Bench, mean_over_seeds
from gear_damping.identification.known_model.estimate import Estimates
from gear_damping.reporting.evaluation import evaluation_table
from gear_damping.tasks.evaluate import KNOWING

CHUNK = 250  # runs that these take at once
MINUTES = 85  # at most, of one call
ESTIMATORS = (*NETWORKS, *KNOWING)


def main() -> None:
    """Do what the time allows."""
    asked = _asked()
    torch.set_num_threads(asked.threads)
    end = time.monotonic() + 60 * asked.minutes
    if len(asked.only) < len(ESTIMATORS):
        _kept(asked.test_runs)
    made = bench(asked.family, asked.test_runs, asked.out)
    for work in _works(made, asked):
        if time.monotonic() > end:
            print("the time is over: the same command goes on from here", flush=True)
            return
        work()
    _write(made, asked)


def _works(made: Bench, asked: argparse.Namespace) -> Iterator:
    """Everything that is not done yet, in order."""
    for seed in asked.seeds:
        for name in [one for one in NETWORKS if one in asked.only]:
            folder = asked.out / "networks" / name / f"seed_{seed}"
            yield lambda name=name, seed=seed, folder=folder: trained(name, seed, folder, asked.runs)
            yield from _parts(
                made, asked, name, seed, lambda rows, snr, f=folder: estimates_of_network(f, made, rows, snr)
            )
    for name in [one for one in KNOWING if one in asked.only]:
        estimate = KNOWING[name]
        yield from _parts(made, asked, name, None, lambda rows, snr, e=estimate: e(made.known(rows, snr)))


def _parts(made: Bench, asked: argparse.Namespace, name: str, seed: int | None, estimate) -> Iterator:
    """The parts of an evaluation; those that are kept are not asked again."""
    size = CHUNK if seed is None else len(made)
    for snr in SNRS:
        for number, rows in enumerate(torch.arange(len(made)).split(size)):
            path = _part(asked.out, name, seed, snr) / f"{number}.json"
            yield lambda path=path, rows=rows, snr=snr: path.exists() or _keep(path, rows, snr, estimate)


def _part(out: Path, name: str, seed: int | None, snr: int) -> Path:
    return out / "said" / (name if seed is None else f"{name}_{seed}") / str(snr)


def _keep(path: Path, rows: torch.Tensor, snr: int, estimate) -> None:
    begun = time.perf_counter()
    found: Estimates = estimate(rows, snr)
    seconds = (time.perf_counter() - begun) / len(rows)
    content = {part: getattr(found, part).tolist() for part in ("ratio", "low", "high")} | {"seconds": seconds}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.with_suffix(".part").write_text(json.dumps(content))
    path.with_suffix(".part").replace(path)
    print(f"{path.parent.parent.name}, {snr} dB: {len(rows)} records, {1e3 * seconds:.1f} ms each", flush=True)


def _said(folder: Path) -> tuple[Estimates, float]:
    parts = [json.loads(path.read_text()) for path in sorted(folder.glob("*.json"), key=lambda one: int(one.stem))]
    whole = {name: [value for part in parts for value in part[name]] for name in ("ratio", "low", "high")}
    columns = {name: torch.tensor(values, dtype=torch.float64) for name, values in whole.items()}
    return Estimates(**columns), sum(part["seconds"] * len(part["ratio"]) for part in parts) / len(columns["ratio"])


def _write(made: Bench, asked: argparse.Namespace) -> None:
    """The figures of every estimator, means over the seeds, and the page; what was not asked keeps its figures."""
    content = {"family": asked.family, "test_runs": len(made), "irregular_runs": int((~made.regular).sum()),
               "training_runs": asked.runs, "seeds": asked.seeds, "snr_db": {}}  # fmt: skip
    for snr in SNRS:
        limit = made.limit(snr)
        row = {"bound_percent": float(limit[made.regular].square().mean().sqrt()), "estimators": {}}
        for name in ESTIMATORS:
            if name not in asked.only:
                row["estimators"][name] = _kept(len(made))["snr_db"][str(snr)]["estimators"][name]
                continue
            seeds = asked.seeds if name in NETWORKS else [None]
            said = [_said(_part(asked.out, name, seed, snr)) for seed in seeds]
            row["estimators"][name] = mean_over_seeds(made, said, snr)
        row["estimators"]["mean"] = mean_over_seeds(made, [(made.mean_predictor, 0.0)], snr)
        content["snr_db"][str(snr)] = row
    (asked.out / "evaluation.json").write_text(json.dumps(content, indent=1) + "\n")
    if asked.page:
        page.write(content)
    print(evaluation_table(content), flush=True)


def _kept(n_runs: int) -> dict:
    """What the page says; refused where it is about other runs."""
    kept = page.kept()
    if kept["test_runs"] != n_runs:
        raise SystemExit(f"--only goes with the {kept['test_runs']} runs of {page.KEPT.name}, not with {n_runs}")
    return kept


def _asked() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.limit", description=__doc__)
    parser.add_argument("--family", default="bench", help="of runs (conf/family)")
    parser.add_argument("--only", nargs="+", default=ESTIMATORS, choices=ESTIMATORS, help="others keep their figures")
    parser.add_argument("--runs", type=int, default=40_000, help="simulated for training and validation")
    parser.add_argument("--test-runs", type=int, default=2000)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--minutes", type=float, default=MINUTES)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("outputs/limit"))
    parser.add_argument("--no-page", dest="page", action="store_false", help="leave docs/limit.md as it is")
    return parser.parse_args()


if __name__ == "__main__":
    main()
