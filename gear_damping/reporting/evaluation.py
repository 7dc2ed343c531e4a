"""Table and figure of an evaluation: every estimator on the same records, beside the bound."""

import math
from collections.abc import Mapping
from typing import Any

from matplotlib.figure import Figure

from gear_damping.reporting.style import INK, colour_of, legend_above, marker_of, new_figure, styled
from gear_damping.reporting.tables import markdown

NO_NOISE = 120.0  # dB
STRANGE = "unlike training"
COLUMNS = (
    "SNR / dB", "bound / %", "estimator", "RMSE / %", "ratio to bound", "typical ratio", "RMSE over bound", "skill",
    "90 % interval holds", STRANGE, "ms a record",
)  # fmt: skip


def evaluation_table(content: Mapping[str, Any]) -> str:
    """A row for every level of noise and estimator, as Markdown; without a column that no estimator has.

    Args:
        content: Of `evaluation.json`.
    """
    rows = evaluation_rows(content)
    told = [place for place, name in enumerate(COLUMNS) if name != STRANGE or any(row[place] != "–" for row in rows)]
    return markdown([COLUMNS[place] for place in told], [tuple(row[place] for place in told) for row in rows])


def evaluation_rows(content: Mapping[str, Any]) -> list[tuple[str, ...]]:
    """The same below COLUMNS."""
    rows = []
    for snr, level in content["snr_db"].items():
        for name, found in level["estimators"].items():
            covered = _percent(found["coverage90"])
            ratios = (_to(found[key], "{:.2f}") for key in ("ratio_to_bound", "typical_ratio", "rmse_to_bound"))
            skill, bound = _to(found["skill"], "{:.3f}"), _to(level["bound_percent"], "{:.4f}")
            shown = _shown(snr)
            error = _to(found["rmse_percent"], "{:.4f}")
            cells = (shown, bound, _named(name, found, content["test_runs"]), error, *ratios, skill, covered)
            strange = _percent(found.get("strange"))
            taken = f"{1e3 * found['seconds_per_record']:.3g}"
            rows.append((*cells, strange, taken))
    return rows


def ratio_table(content: Mapping[str, Any]) -> str:
    """Error against the damping ratio, a row for every level of noise and estimator, as Markdown.

    Args:
        content: Of `evaluation.json`.
    """
    return markdown(*ratio_rows(content))


def ratio_rows(content: Mapping[str, Any]) -> tuple[list[str], list[tuple[str, ...]]]:
    """The same as columns and rows."""
    bands = next(iter(next(iter(content["snr_db"].values()))["estimators"].values()))["by_damping_ratio"]
    ranges = [f"{band['from_percent']:.3g} to {band['to_percent']:.3g} % ({band['runs']} runs)" for band in bands]
    rows = []
    for snr, level in content["snr_db"].items():
        for name, found in level["estimators"].items():
            errors = (_to(band["rmse_percent"], "{:.4f}") for band in found["by_damping_ratio"])
            rows.append((_shown(snr), f"`{name}`", *errors))
    return ["SNR / dB", "RMSE / % of", *ranges], rows


def effect_table(content: Mapping[str, Any]) -> list[str]:
    """Error of networks where the runs have an effect more, a row for each, as Markdown; none where none was asked."""
    if not content["effects"]:
        return []
    columns = ("effect", "SNR / dB", "estimator", "RMSE / %", "median error", "90 % interval holds", STRANGE)
    rows = []
    for effect, levels in content["effects"].items():
        for snr, estimators in levels.items():
            for name, one in estimators.items():
                median = f"{100 * one['median_relative_error']:.1f} %"
                shares = (_percent(one["coverage90"]), _percent(one.get("strange")))
                rows.append((f"`{effect}`", _shown(snr), f"`{name}`", f"{one['rmse_percent']:.4f}", median, *shares))
    return [markdown(columns, rows)]


def _shown(snr: str) -> str:
    return "no noise" if float(snr) >= NO_NOISE else snr


def _percent(share: float | None) -> str:
    return "–" if share is None else f"{100 * share:.1f} %"


def _named(name: str, found: Mapping[str, Any], runs: int) -> str:
    """The estimator, with how many of the runs suit it where not all do."""
    answered = found.get("answered", runs)
    return f"`{name}`" if answered == runs else f"`{name}` ({answered} of {runs} runs suit it)"


def _to(value: float | None, style: str) -> str:
    return "–" if value is None else style.format(value)


def evaluation_figure(content: Mapping[str, Any]) -> Figure:
    """Error of every estimator against the noise, above what the records hold."""
    levels = {float(snr): level for snr, level in content["snr_db"].items()}
    with styled():
        shown = new_figure(4.4)
        axes = shown.subplots()
        names = next(iter(levels.values()))["estimators"]
        for number, name in enumerate(names):
            errors = [level["estimators"][name]["rmse_percent"] or math.nan for level in levels.values()]
            look = {"color": colour_of(name, number), "marker": marker_of(name)}
            axes.plot(list(levels), errors, "--" if name == "mean" else "-", label=name, **look)
        bounds = [level["bound_percent"] or math.nan for level in levels.values()]
        axes.plot(list(levels), bounds, ":", color=INK, label="bound")
        axes.fill_between(list(levels), bounds, color=INK, alpha=0.08, linewidth=0)
        axes.set_yscale("log")
        axes.set_xlabel("signal-to-noise ratio of the sensor / dB")
        axes.set_ylabel("RMSE of the damping ratio / % of critical")
        legend_above(axes)
        return shown
