"""power.json, and the page with its table and figure."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .cases import EFFECTS, PLAN
from .curve import size_at_power

FIGURE = "figures/power.png"
HEAD = """# How small an effect is found

The limit is what the data hold: the smallest size at which the best test there is, knowing the shape of the effect and
of everything that calibration frees, sees it with power .9 at a level of .01 (`visible`), and at which it still does
beside the nearest other effect (`named`). An independent generator works both out from its own sensitivities
(`tests/oracles/hidden/limit.py`). Then the effect is hidden at 1, 2, 3 and 5 times the larger of the two, and
`task=explain` is asked. Written by `make power`.
"""
COLUMNS = ("effect", "unit", "visible limit", "named limit", "nearest other", "visible / limit", "found / limit",
           "wrong", "cases")  # fmt: skip
NOTE = """
`found / limit`: the size at which nine of ten are established, alone or in a set of at most three, over the larger
limit, with its 95 % interval. `visible / limit`: the size at which something is called visible, over the limit of
seeing it; the test sees the fitted records alone, the limit all of them. Sizes of a bearing, a low-pass and a
saturation are stiffness, cutoff and level: the smaller, the larger the effect. Beyond 30 limits, and below a
twentieth, nothing is told apart.
"""


def summary(rows: Sequence[dict[str, Any]], seed0: int) -> dict[str, Any]:
    """The content of power.json."""
    effects = {}
    for name in EFFECTS:
        own = [row for row in rows if row["stratum"] == name]
        if own:
            effects[name] = _of_effect(own)
    versions = ", ".join(sorted({row["engine"] for row in rows}))
    return {"plan": PLAN, "revision": versions, "seed0": seed0, "effects": effects}


def _of_effect(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    larger = [max(row["limit"]["seen"], row["limit"]["named"]) for row in rows]
    sizes = [row["multiple"] for row in rows]
    seen = size_at_power([s * unit / row["limit"]["seen"] for s, unit, row in zip(sizes, larger, rows, strict=True)],
                         [row["visible"] for row in rows])  # fmt: skip
    found = size_at_power(sizes, [row["established"] for row in rows])

    def amplitude(shares: Sequence[float]) -> float:
        return float(np.median([row["largest"] * s ** row["power"] for row, s in zip(rows, shares, strict=True)]))

    nearest = [row["limit"]["nearest"] for row in rows]
    return {
        "unit": rows[0]["unit"],
        "oracle": amplitude([row["limit"]["seen"] for row in rows]),
        "oracle_name": amplitude([row["limit"]["named"] for row in rows]),
        "nearest": max(set(nearest), key=nearest.count),
        "visible90": amplitude([seen[0] * row["limit"]["seen"] for row in rows]),
        "visible_ratio": seen[0],
        "visible_interval95": list(seen[1:]),
        "established90": amplitude([found[0] * unit for unit in larger]),
        "ratio": found[0],
        "interval95": list(found[1:]),
        "wrong": sum(row["wrong"] for row in rows),
        "cases": len(rows),
    }


def markdown(found: dict[str, Any]) -> str:
    """The page."""
    effects = found["effects"]
    names = sorted(effects, key=lambda name: effects[name]["ratio"])
    rows = [
        "| " + " | ".join(COLUMNS) + " |",
        "|" + "---|" * len(COLUMNS),
    ]
    for name in names:
        own = effects[name]
        rows.append(
            f"| `{name}` | {own['unit']} | {own['oracle']:.3g} | {own['oracle_name']:.3g} | `{own['nearest']}` | "
            f"{_with_interval(own['visible_ratio'], own['visible_interval95'])} | "
            f"{_with_interval(own['ratio'], own['interval95'])} | {own['wrong']} | {own['cases']} |"
        )
    total = sum(own["cases"] for own in effects.values())
    basis = (
        f"Plan: {found['plan']}. {total} cases of {len(effects)} effects, seeds from {found['seed0']}, explained by "
        f"version {found['revision']}.\n\n{_overall(effects)}\n"
    )
    figure = f"\n![Size at which nine of ten are found, over the limit]({FIGURE})\n"
    return "\n".join([HEAD, basis, *rows, NOTE]) + figure


def _overall(effects: dict[str, Any]) -> str:
    """The figures that have a target."""
    said = []
    for key, word, median, most in (("visible_ratio", "visible", 1.8, 2.5), ("ratio", "found", 2.5, 4.0)):
        values = [own[key] for own in effects.values()]
        said.append(f"{word} at {np.median(values):.2g} limits (median over effects; target {median:g}), nine of ten "
                    f"effects at {np.quantile(values, 0.9):.2g} at most (target {most:g})")  # fmt: skip
    return "; ".join(said).capitalize() + "."


def _with_interval(value: float, interval: Sequence[float]) -> str:
    return f"{value:.2g} ({interval[0]:.2g} to {interval[1]:.2g})"


def draw(found: dict[str, Any], path: Path) -> None:
    """The sizes at which nine of ten are seen and found, over their limits, effect by effect."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    effects = found["effects"]
    names = sorted(effects, key=lambda name: -effects[name]["ratio"])
    drawing, axis = plt.subplots(figsize=(7.0, 0.26 * len(names) + 1.2), layout="constrained")
    parts = (("visible_ratio", "visible_interval95", "o", 0.14, "visible, over the limit of seeing it"),
             ("ratio", "interval95", "s", -0.14, "established, over the limit of naming it"))  # fmt: skip
    for key, interval, marker, shift, label in parts:
        value = np.array([effects[name][key] for name in names])
        ends = np.array([effects[name][interval] for name in names]).T
        at = np.arange(len(names)) + shift
        axis.errorbar(value, at, xerr=np.abs(ends - value), fmt=marker, markersize=4, linewidth=1, label=label)
    axis.axvline(1.0, color="0.6", linewidth=1)
    axis.set(xscale="log", yticks=np.arange(len(names)), xlabel="size at which nine of ten succeed, over the limit")
    axis.xaxis.set_major_formatter("{x:g}")
    axis.xaxis.set_minor_formatter("")
    axis.set_yticklabels([name.replace("_", " ") for name in names])
    axis.set_ylim(-0.6, len(names) - 0.4)
    drawing.legend(loc="outside lower center", frameon=False, ncols=2)
    path.parent.mkdir(parents=True, exist_ok=True)
    drawing.savefig(path, dpi=110)
    plt.close(drawing)
