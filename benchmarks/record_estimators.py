"""How near estimators of a record come to the truth, and how often their intervals hold it: `make estimators`.

Decays in closed form, and with quadratic damping by scipy, behind white noise, with frequency, phase and sampling drawn
for each. Writes `docs/estimators.md`.
"""

import argparse
import time
from collections.abc import Iterator, Mapping
from math import pi
from pathlib import Path

import numpy as np
import torch
from scipy.integrate import solve_ivp

from benchmarks.marked import put
from gear_damping.identification.catalogue import builtin_estimators
from gear_damping.identification.damping_estimate import UnsuitedRecord
from gear_damping.identification.estimators.base import Recorded, RecordEstimator
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.systems.oscillator import Oscillator

SEED = 20000  # of the first decay; the tests draw others
RATIOS, SNRS = (0.2, 1.0, 5.0), (40, 20)  # % and dB
NEPERS = 4.0  # that an amplitude falls by over a record, but for the longest
PER_PERIOD = 50  # samples
LONGEST = 6000  # samples
QUADRATIC = (0.02, 0.05, 0.2)  # c of x'' + c x'|x'| + w^2 x = 0, per unit of the first amplitude
PAGE = Path(__file__).parents[1] / "docs" / "estimators.md"
LINEAR = (
    "damping ratio", "noise", "estimator", "bias / %", "scatter / %", "half 95 % interval / %", "coverage", "answered",
    "ms",
)  # fmt: skip
CURVES = ("c per amplitude", "median error of ζ(A)", "within the 95 % band", "within twice the band")
BEFORE, AFTER = "<!-- measured by `make estimators` -->", "<!-- end -->"


def recorded(values: np.ndarray, rate: float) -> Recorded:
    return Recorded(FitRecord("run", torch.as_tensor(values), rate), Oscillator, Known({}, {}))


def linear(ratio_percent: float, snr_db: float, random: np.random.Generator) -> Recorded:
    """A decay in closed form at about one hertz."""
    ratio, frequency, phase = ratio_percent / 100, random.uniform(0.8, 1.25), random.uniform(0, 2 * pi)
    count = int(min(LONGEST, NEPERS / ratio / (2 * pi) * PER_PERIOD))
    turned = 2 * pi * frequency * np.arange(count) / PER_PERIOD
    values = np.exp(-ratio * turned) * np.cos(turned * (1 - ratio**2) ** 0.5 + phase)
    return recorded(values + values.std() * 10 ** (-snr_db / 20) * random.normal(size=count), float(PER_PERIOD))


def quadratic(coefficient: float, snr_db: float, random: np.random.Generator) -> Recorded:
    """A decay over more than a decade by an integrator, at one hertz."""
    time_s = np.arange(int(1.2 * 3 * pi / 4 / coefficient * 10 / (2 * pi) * PER_PERIOD)) / PER_PERIOD
    start = (np.cos(phase := random.uniform(0, 2 * pi)), -2 * pi * np.sin(phase))

    def rates(_: float, y: np.ndarray) -> tuple[float, float]:
        return y[1], -coefficient * y[1] * abs(y[1]) - (2 * pi) ** 2 * y[0]

    values = solve_ivp(rates, (0, time_s[-1]), start, t_eval=time_s, rtol=1e-9, atol=1e-12).y[0]
    return recorded(values + values.std() * 10 ** (-snr_db / 20) * random.normal(size=values.size), float(PER_PERIOD))


def of_ring_downs() -> dict[str, type[RecordEstimator]]:
    """The estimators of free decays, by name."""
    of_records = {n: kind for n, kind in builtin_estimators().items() if issubclass(kind, RecordEstimator)}
    return {name: kind for name, kind in of_records.items() if kind.of_ring_downs}


def rows_linear(count: int, kinds: Mapping[str, type[RecordEstimator]]) -> Iterator[str]:
    """A row of the table for each ratio, noise and estimator."""
    for ratio in RATIOS:
        for snr in SNRS:
            found: dict[str, list[tuple[float, float, bool, float]]] = {name: [] for name in kinds}
            for number in range(count):
                record = linear(ratio, snr, np.random.default_rng([SEED + number, int(10 * ratio), snr]))
                for name, kind in kinds.items():
                    began = time.perf_counter()
                    try:
                        one = kind({}).estimate(record)
                    except UnsuitedRecord:
                        continue
                    low, high = one.interval95
                    spent = 1e3 * (time.perf_counter() - began)
                    error = one.damping_ratio_percent / ratio - 1
                    found[name].append((error, (high - low) / 2 / ratio, low <= ratio <= high, spent))
            for name, one in found.items():
                yield f"| {ratio:g} % | {snr} dB | `{name}` | {_row(np.array(one, dtype=float), count)} |"


def _row(found: np.ndarray, count: int) -> str:
    """Bias, scatter, half interval in % of the ratio, coverage, records that suit, ms."""
    if not len(found):
        return "– | – | – | – | 0 | –"
    errors, halves, inside, spent = found.T
    return (
        f"{100 * errors.mean():+.2f} | {100 * errors.std():.2f} | {100 * np.median(halves):.2f} | "
        f"{inside.mean():.2f} | {len(found)} of {count} | {np.median(spent):.0f}"
    )


def rows_quadratic(count: int, kind: type[RecordEstimator]) -> Iterator[str]:
    """A row for each coefficient: of the curve against amplitude."""
    for coefficient in QUADRATIC:
        found = []
        for number in range(count):
            random = np.random.default_rng([SEED + number, int(1000 * coefficient)])
            curve = kind({}).estimate(quadratic(coefficient, 40, random)).curve
            kept = curve.amplitude > curve.amplitude.max() / 10
            truth = 100 * 4 * coefficient * curve.amplitude / (3 * pi)
            off = np.abs(curve.damping_ratio_percent - truth)
            half = (curve.interval95[:, 1] - curve.interval95[:, 0]) / 2
            found.append((np.median((off / truth)[kept]), np.mean(off <= half), np.mean(off <= 2 * half)))
        error, inside, twice = np.array(found).mean(0)
        yield f"| {coefficient:g} | {100 * error:.2f} % | {inside:.2f} | {twice:.2f} |"


def _head(columns: tuple[str, ...], texts: int) -> str:
    return f"| {' | '.join(columns)} |\n|" + "---|" * texts + "---:|" * (len(columns) - texts)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.record_estimators")
    parser.add_argument("--records", type=int, default=100, help="of each row")
    chosen = parser.parse_args(arguments)
    torch.set_num_threads(1)
    kinds = of_ring_downs()
    lines = [_head(LINEAR, texts=3)]
    for row in rows_linear(chosen.records, kinds):
        print(row, flush=True)
        lines.append(row)
    lines += ["", _head(CURVES, texts=1)]
    for row in rows_quadratic(max(1, chosen.records // 5), kinds["wavelet_ridge"]):
        print(row, flush=True)
        lines.append(row)
    put("\n".join(lines), PAGE, BEFORE, AFTER)


if __name__ == "__main__":
    main()
