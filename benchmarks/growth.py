"""How cost and memory grow with the batch, the record, the effects and the scales."""

import statistics

from benchmarks.harness import OWN, PeerError, Process
from benchmarks.simulating import Log

LARGE = 10_000  # members beyond which one call is measured instead of three


def everything(quick: bool, log: Log) -> list[dict]:
    """CPU time and the peak memory of its own process for each."""
    batches = (1, 64) if quick else (1, 4, 16, 64, 400, 4096, 65536)
    lengths = () if quick else (2000, 20_000, 200_000)
    counts = (2,) if quick else (2, 4, 6, 8, 10)
    scales = ((16, 8),) if quick else ((64, 8), (64, 32), (64, 128), (4096, 64))
    plans = [("trajectories", {"batch": b, "n_samples": 2000}) for b in batches]
    plans += [("trajectories", {"batch": 16, "n_samples": n}) for n in lengths]
    plans += [("trajectories", {"batch": 256, "n_samples": 2000, "effects": e}) for e in counts]
    plans += [("coefficients", {"batch": b, "n_samples": 2000, "n_scales": s}) for b, s in scales]
    return [_measured(engine, options, log) for engine, options in plans]


def _measured(engine: str, options: dict, log: Log) -> dict:
    row = {"what": engine, **options}
    try:
        process = Process(OWN, "growing", engine, options)
        large = options["batch"] > LARGE
        runs = [process.run() for _ in range(1 if large else 4)][0 if large else 1 :]  # the first one compiles
        process.close()
    except PeerError as problem:
        log(f"  {row}: left out ({problem})")
        return row | {"reason": str(problem)}
    cpu, wall = (statistics.median(run[kind] for run in runs) for kind in ("cpu", "wall"))
    row |= {"cpu_ms_per_item": 1e3 * cpu / options["batch"], "cpu_s": cpu, "wall_s": wall}
    row["peak_gib"] = runs[-1]["peak_gib"]
    log("  " + ", ".join(f"{k} {v:.3g}" if isinstance(v, float) else f"{k} {v}" for k, v in row.items()))
    return row
