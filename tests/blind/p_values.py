"""`make p-values`: is the family-wise p value one? Noise alone is put in the place of the residuals of a null.

A null of the usual rig is calibrated as in any diagnosis. Then the residuals of its fitted records are drawn again and
again, and the test of everything at once (whitening, scores of every effect, families without a name, sign flips)
runs on each draw as it would on measured ones. Under noise alone p is below any level as often as that level says.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.signal import lfilter

ROOT = Path(__file__).resolve().parents[2]
FOLDER, PAGE, FIGURE = ROOT / "outputs" / "p_values", ROOT / "docs" / "p_values.md", "figures/p_values.png"
LEVELS = (0.01, 0.05, 0.1, 0.5)
RECORDS, DURATION = (0, 3, 4, 6), 0.02  # of the full plan; s of each
RATE, MODE, DAMPING = 50e3, 5.5e3, 0.015  # Hz, Hz, share of critical: of the random load's response
Noise = Callable[[np.random.Generator, tuple[int, ...]], np.ndarray]


def white(source: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    """Of a sensor with a flat spectrum."""
    return source.standard_normal(shape)


def coloured(source: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    """Of a sensor whose neighbouring samples hang together: x_k = .9 x_(k-1) + e_k."""
    return _filtered([1.0, -0.9], source, shape)


def random_load(source: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    """What an unmeasured random torque does: a lightly damped mode that is hit all the time, and some sensor noise."""
    radius = np.exp(-2 * np.pi * MODE * DAMPING / RATE)
    turn = 2 * np.pi * MODE * np.sqrt(1 - DAMPING**2) / RATE
    mode = _filtered([1.0, -2 * radius * np.cos(turn), radius**2], source, shape)
    return mode / mode.std() + 0.3 * source.standard_normal(shape)


def _filtered(denominator: list[float], source: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    lead = 2000  # samples until the filter has forgotten where it began
    drawn = source.standard_normal((*shape[:-1], shape[-1] + lead))
    return lfilter([1.0], denominator, drawn)[..., lead:]


KINDS: dict[str, Noise] = {"white": white, "coloured": coloured, "random_load": random_load}


def drawn_p(kind: str, seed: int, count: int) -> Iterator[float]:
    """p values of noise of a kind in the place of the residuals of a null."""
    import torch
    from hidden import draw_case, write_case

    from gear_damping.explanation.explain import explain
    from gear_damping.explanation.trials.assess import assessed
    from gear_damping.measurement.load import load_measurement

    torch.set_num_threads(1)
    case = draw_case("null", seed, duration=DURATION, snr_db=30.0)
    case = replace(case, records=tuple(case.records[i] for i in RECORDS))
    with tempfile.TemporaryDirectory() as folder:
        found = explain(load_measurement(write_case(case, Path(folder) / "measured"))).found
    bench, nominal = found.bench, found.nominal
    scores = bench.ranked(nominal)
    source = np.random.default_rng([seed, *kind.encode()])
    residual, weights = nominal.fitted.prediction.residual, nominal.problem.response.weights
    for _ in range(count):
        noise = torch.as_tensor(KINDS[kind](source, tuple(residual.shape))) * bench.evidence.noise
        prediction = replace(nominal.fitted.prediction, residual=noise * (weights.reshape(residual.shape) > 0))
        outcome = replace(nominal, fitted=replace(nominal.fitted, prediction=prediction))
        yield assessed(outcome, scores, bench.evidence).visible.p


def rejections(values: list[float]) -> dict[str, dict[str, float | list[float]]]:
    """How often p is below each level, with 95 % intervals (Clopper & Pearson)."""
    from .rates import clopper_pearson

    p = np.asarray(values)
    found = {}
    for level in LEVELS:
        count = int((p < level).sum())
        found[f"{level:g}"] = {"rate": count / len(p), "interval95": list(clopper_pearson(count, len(p)))}
    return found


def figure(by_kind: dict[str, list[float]], path: Path) -> None:
    """Share of draws below every p, over p: the diagonal where p is a p value."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    drawing, axis = plt.subplots(figsize=(5.2, 4.6), layout="constrained")
    for (kind, values), style in zip(by_kind.items(), ("-", "--", "-."), strict=False):
        p = np.sort(values)
        axis.step(
            p, np.arange(1, len(p) + 1) / len(p), style, where="post", label=f"{kind.replace('_', ' ')} ({len(p)})"
        )
    ends = np.geomspace(1e-3, 1, 50)
    axis.plot(ends, ends, color="0.6", linewidth=1, label="a p value")
    axis.set(xscale="log", yscale="log", xlim=(1e-3, 1), ylim=(1e-3, 1.05), xlabel="p", ylabel="share of draws below p")
    axis.axvline(0.01, color="0.8", linewidth=1, zorder=0)
    axis.legend(title="noise alone", frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    drawing.savefig(path, dpi=110)
    plt.close(drawing)


def page(by_kind: dict[str, list[float]], seeds: dict[str, list[int]]) -> str:
    """The page: a table and the figure."""
    rows = [f"| {name.replace('_', ' ')} | {len(p)} | {len(seeds[name])} | " + " | ".join(_cells(p)) + " |"
            for name, p in by_kind.items()]  # fmt: skip
    head = " | ".join(f"p < {level:g}" for level in LEVELS)
    text = __doc__.split("\n", 2)[2].strip()
    return (
        f"# Is p a p value?\n\n{text}\n\nShare of draws below a level, with its 95 % interval; written by "
        f"`make p-values`.\n\n| noise | draws | nulls | {head} |\n|{'---|' * (3 + len(LEVELS))}\n" + "\n".join(rows)
        + f"\n\n![Share of draws below p, over p]({FIGURE})\n"
    )  # fmt: skip


def _cells(values: list[float]) -> list[str]:
    return [
        f"{100 * found['rate']:.2f} % ({100 * found['interval95'][0]:.2f} to {100 * found['interval95'][1]:.2f})"
        for found in rejections(values).values()
    ]


def main(given: list[str] | None = None) -> int:
    """Draw what has not been drawn yet, then write what there is."""
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    sys.path.insert(0, str(ROOT / "tests" / "oracles"))
    parser = argparse.ArgumentParser(prog="make p-values ARGS=...", description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=250, help="of each kind of noise on each null")
    parser.add_argument("--nulls", type=int, default=4)
    parser.add_argument("--seed", type=int, default=32000, help="of the first null")
    parser.add_argument("--page", action="store_true", help=f"write {PAGE.relative_to(ROOT)} too")
    parser.add_argument("--out", type=Path, default=FOLDER)
    options = parser.parse_args(given)
    options.out.mkdir(parents=True, exist_ok=True)
    kept = options.out / "p.jsonl"
    done = [json.loads(line) for line in kept.read_text().splitlines()] if kept.exists() else []
    known = {(row["kind"], row["seed"]) for row in done}
    for seed in range(options.seed, options.seed + options.nulls):
        for kind in KINDS:
            if (kind, seed) in known:
                continue
            row = {"kind": kind, "seed": seed, "p": list(drawn_p(kind, seed, options.draws))}
            done.append(row)
            with kept.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
            print(f"{kind} {seed}: {rejections(row['p'])['0.01']['rate']:.3f} below .01", flush=True)
    by_kind = {kind: [p for row in done if row["kind"] == kind for p in row["p"]] for kind in KINDS}
    seeds = {kind: [row["seed"] for row in done if row["kind"] == kind] for kind in KINDS}
    docs = PAGE.parent if options.page else options.out
    figure(by_kind, docs / FIGURE)
    (docs / PAGE.name).write_text(page(by_kind, seeds), encoding="utf-8")
    print(f"wrote {docs / PAGE.name}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
