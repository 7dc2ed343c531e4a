"""The machine, results.json and the table."""

import json
import os
import platform
from pathlib import Path

import torch

# (work, engine, batch, the percentile of equal error or None) -> smallest ratio wanted; below 1: largest of ours.
TARGETS = {
    ("simulate_smooth", "scipy_rk45", 400, None): 300,
    ("simulate_smooth", "torchdiffeq_dopri5", 400, None): 20,
    ("simulate_smooth", "torchdiffeq_dopri5", 4096, None): 6,
    ("simulate_smooth", "diffrax", 4096, None): 4,
    ("simulate_smooth", "diffrax_same_algebra", 4096, None): 1.8,
    ("simulate_smooth", "numba_rk4", 4096, None): 5,
    ("simulate_backlash", "rk4_unaware", 400, "p50"): 3.5,
    ("simulate_backlash", "rk4_unaware", 400, "p90"): 10,
    ("cwt", "pywavelets", 64, None): 8,
    ("cwt", "ptwt", 64, None): 10,
    ("cwt", "irfft", 64, None): 1 / 1.5,
    ("train", "torch_bare", 256, None): 1 / 1.15,
    ("train", "torch_bare", 1024, None): 1 / 1.05,
    ("train", "keras", 32, None): 1.0,
    ("train", "keras", 256, None): 1.3,
}
# Why a ratio falls short of its target, where the reason was found.
REASONS = {
    ("cwt", "pywavelets"): "an eighth of what its FFT mode (not its default) costs on a whole batch is less than the "
    "bare inverse FFTs cost. Neither mode reaches our accuracy, because it samples an integrated wavelet",
    (
        "cwt",
        "ptwt",
    ): "ours is within a third of the bare inverse FFTs, so that little is left to save; runs gave 9.1 to 13.5",
    ("cwt", "irfft"): "beside the inverse FFT there are the product with the spectrum, the copy without the padding "
    "and the memory of the result",
    ("train", "keras"): "on this processor TensorFlow's LSTM is as fast as PyTorch's, whose two calls (forward, "
    "backward) alone take 29.6 µs of a window at batch 256",
    ("train", "torch_bare"): "Lightning's hooks cost 0.3 to 0.5 ms a step",
}
ITEMS = {
    "simulate_smooth": "a trajectory of 2000 outputs", "simulate_backlash": "a trajectory of 200 outputs",
    "cwt": "a million coefficients", "train": "a training window",
}  # fmt: skip
TABLES = {
    "limit": "Beside C++ written by hand for this one equation (wanted: its cost at least half of ours)",
    "growth": "How cost grows",
    "accuracy": "Error delivered with each effect switched on, by the error asked",
}


def machine() -> dict:
    """What the figures came from."""
    info = Path("/proc/cpuinfo")
    known = dict(
        (part.strip() for part in line.split(":", 1))
        for line in (info.read_text().splitlines() if info.exists() else [])[:30]
        if ":" in line
    )
    name = known.get("model name", platform.processor())
    if "cpu family" in known:
        name += f" (family {known['cpu family']}, model {known.get('model', '?')})"
    return {
        "processor": name, "cores": os.cpu_count(), "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(), "torch": torch.__version__, "threads": 1,
    }  # fmt: skip


def target(row: dict) -> float | None:
    return TARGETS.get((row["work"], row["engine"], row["batch"], row.get("equal_error_at")))


def is_short(row: dict) -> bool:
    """Whether a ratio was measured and lies below its target."""
    wanted, ratio = target(row), row["ratio_to_ours"]
    return wanted is not None and ratio is not None and ratio < wanted


def merged(folder: Path, results: dict) -> dict:
    """The results with those parts of an earlier run on this machine that were not run again."""
    path = folder / "results.json"
    before = json.loads(path.read_text()) if path.exists() else {}
    if before.get("machine") != results["machine"]:
        return results
    ran = results["parts"]
    found = results | {"parts": before["parts"] | ran}
    found["rows"] = [row for row in before["rows"] if row["work"] not in ran] + results["rows"]
    for name in TABLES:
        found[name] = results[name] if name in ran else before.get(name, [])
    return found


def write(folder: Path, results: dict) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "results.json").write_text(json.dumps(results, indent=1))
    (folder / "table.md").write_text(markdown(results))


def markdown(results: dict) -> str:
    m = results["machine"]
    lines = [
        f"{m['processor']}, {m['cores']} cores, {m['system']}, Python {m['python']}, torch {m['torch']}; "
        f"{m['threads']} thread. CPU time of the process, median of interleaved rounds; ± is half the interquartile "
        "range. Ratio: the CPU time of the engine over ours.",
    ]  # fmt: skip
    quick = [name for name, part in results["parts"].items() if part["quick"]]
    lines += [f"A quick try and no measurement: {', '.join(quick)}."] if quick else []
    head = "| work | batch | engine | setting | error p90 | CPU ms | wall ms | ratio | wanted |"
    lines += ["", head, "|---|---|---|---|---|---|---|---|---|", *(_line(row) for row in results["rows"])]
    short = {(row["work"], row["engine"]) for row in results["rows"] if is_short(row)}
    for work, engine in sorted(short & REASONS.keys()):
        lines += ["", f"Short, {work} beside {engine}: {REASONS[work, engine]}."]
    lines += ["", "An item is: " + "; ".join(f"{work}: {item}" for work, item in ITEMS.items()) + "."]
    for name, title in TABLES.items():
        if results[name]:
            lines += ["", f"{title}:", "", *plain_table(results[name])]
    return "\n".join(lines) + "\n"


def _line(row: dict) -> str:
    wanted, ratio = target(row), row["ratio_to_ours"]
    mark = "–" if wanted is None else f"≥ {wanted:.3g}" + (" (short)" if is_short(row) else "")
    work = row["work"] + (f", {row['equal_error_at']}" if "equal_error_at" in row else "")
    head = (work, row["batch"], row["engine"])
    if "reason" in row:
        return "| " + " | ".join(map(str, (*head, f"left out: {row['reason']}", *["–"] * 4, mark))) + " |"
    error = "–" if row["error_p90"] is None else f"{row['error_p90']:.1e}"
    cost = f"{row['cpu_ms_per_item']:.4g} ± {100 * row['cpu_spread']:.0f} %"
    shown = "–" if ratio is None else f"{ratio:.3g}"
    cells = (*head, row.get("setting", ""), error, cost, f"{row['wall_ms_per_item']:.4g}", shown, mark)
    return "| " + " | ".join(map(str, cells)) + " |"


def plain_table(rows: list[dict]) -> list[str]:
    names = list(dict.fromkeys(name for row in rows for name in row))
    shown = [[_cell(row.get(name)) for name in names] for row in rows]
    return [f"| {' | '.join(r)} |" for r in (names, ["---"] * len(names), *shown)]


def _cell(value: object) -> str:
    return "" if value is None else f"{value:.3g}" if isinstance(value, float) else str(value)
