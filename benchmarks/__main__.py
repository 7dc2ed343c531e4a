"""Runs the benchmarks: `make bench`, or `python -m benchmarks [--quick] [--only WORK ...]`."""

import argparse
import time
from pathlib import Path

from benchmarks import accuracy, fitting, growth, report, simulating, transforming
from benchmarks.simulating import Log


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS), metavar="WORK", help=", ".join(PARTS))
    parser.add_argument("--quick", action="store_true", help="small batches, one round: a try, not a measurement")
    parser.add_argument("--folder", type=Path, default=Path("outputs/bench"))
    chosen = parser.parse_args(arguments)
    found = {"machine": report.machine(), "rows": [], "parts": {}, **{name: [] for name in report.TABLES}}
    for part in chosen.only:
        began = time.perf_counter()
        print(part, flush=True)
        key = part if part in report.TABLES else "rows"
        found[key] = found[key] + PARTS[part](chosen.quick, lambda line: print(line, flush=True))
        found["parts"][part] = {"seconds": round(time.perf_counter() - began), "quick": chosen.quick}
        report.write(chosen.folder, report.merged(chosen.folder, found))
    print(f"\n{(chosen.folder / 'table.md').read_text()}\nwritten to {chosen.folder}/results.json and table.md")


def simulate_smooth(quick: bool, log: Log) -> list[dict]:
    if quick:
        return simulating.smooth(32, 1, log)
    large = ("torchdiffeq_dopri5", "diffrax", "diffrax_same_algebra", "numba_rk4")
    return simulating.smooth(400, 5, log) + simulating.smooth(4096, 3, log, large)


def simulate_backlash(quick: bool, log: Log) -> list[dict]:
    batch, rounds = (32, 1) if quick else (400, 7)
    return [row for p in (50, 90) for row in simulating.backlash(batch, rounds, p, log)]


def limit(quick: bool, log: Log) -> list[dict]:
    return simulating.limit(32 if quick else 400, 1 if quick else 9, log)


def cwt(quick: bool, log: Log) -> list[dict]:
    return transforming.cwt(8 if quick else 64, 32, 1 if quick else 21, log)


def train(quick: bool, log: Log) -> list[dict]:
    if quick:
        return fitting.train(256, 1024, 1, log)
    plans = ((32, 8192), (256, 16384), (1024, 32768))
    return [row for batch, windows in plans for row in fitting.train(batch, windows, 5, log)]


PARTS = {
    "simulate_smooth": simulate_smooth, "simulate_backlash": simulate_backlash, "cwt": cwt, "train": train,
    "limit": limit, "growth": growth.everything, "accuracy": accuracy.everything,
}  # fmt: skip

if __name__ == "__main__":
    main()
