"""The tables over all effects: what was spent, every figure in one row, table 2."""

from collections.abc import Sequence
from statistics import fmean, stdev
from textwrap import fill
from typing import Any

from gear_damping.reporting.numbers import NOTHING
from gear_damping.reporting.paper.cells import Found, as_fraction, in_percent, markdown, printed, score
from gear_damping.reporting.paper.names import EFFECT_OF, one_run_of
from gear_damping.reporting.paper.printed import CWT, EFFECTS, RATIOS_PERCENT, RAW, RMSE
from gear_damping.reporting.paper.study import BLIND, MEAN

LINE = 120  # characters of a line of text
CLEAR = 2.0  # standard errors of the mean from which a difference is called one


def mean_and_std(values: Sequence[float]) -> dict[str, Any]:
    """Mean and deviation."""
    return {"mean": fmean(values), "std": stdev(values) if len(values) > 1 else 0.0, "values": list(values)}


def settings_text(found: Found) -> str:
    """The command, what it spent, and on what it rests."""
    s = found["settings"]
    training, versions = s["training"], s["versions"]
    revision = ", ".join(one[:7] for one in found["revisions"])
    said = (
        f"Seeds {', '.join(map(str, s['seeds']))}; at most {training['max_epochs']} epochs, patience "
        f"{training['patience']}, batch {training['batch_size']}, {s['windows_per_epoch']} windows an epoch, Adam "
        f"{training['learning_rate']:g}, {s['n_runs']} runs of {s['n_samples']} samples; on one run batch 32 and "
        f"patience 20, as the paper has them. All trainings together took {found['cpu_minutes']:.0f} minutes of one "
        f"core. Revision {revision}; Python {versions['python']}, torch {versions['torch']}. Spreads are standard "
        "deviations over the seeds."
    )
    return f"    {s['command']}\n\n{fill(said, LINE)}"


def overview_table(found: Found) -> str:
    """Every figure with a printed error in one row: printed, on one run, on unseen runs."""
    head = ("figure", "effect", "printed LSTM", "printed CWT–LSTM", "one run, raw_lstm", "one run, cwt_lstm",
            "one run, white noise", "unseen, raw_lstm / %", "unseen, cwt_lstm / %", "unseen, mean / %")  # fmt: skip
    return markdown(head, [_overview_row(found, name) for name in RMSE], left=2)


def _overview_row(found: Found, name: str) -> tuple[str, ...]:
    words = (name.removeprefix("figure_").lstrip("0"), EFFECTS[name], printed(name, RAW), printed(name, CWT))
    if name == "figure_14":
        one_run = [as_fraction(ratios_together(found, one)) for one in (RAW, CWT, BLIND)]
        unseen = [in_percent(unseen_ratios(found, one)) for one in (RAW, CWT, MEAN)]
        return (*words, *one_run, *unseen)
    effect = EFFECT_OF[name]
    one_run = [as_fraction(score(found, effect, "paper", one)) for one in (RAW, CWT, BLIND)]
    return (*words, *one_run, *(in_percent(score(found, effect, "by_run", one)) for one in (RAW, CWT, MEAN)))


def ratios_together(found: Found, name: str, which: str = "rmse_percent") -> dict[str, Any] | None:
    """The error over the six runs of figure 14 together, by seed: test sets are of one size."""
    each = [score(found, one_run_of(ratio), "paper", name, which) for ratio in RATIOS_PERCENT]
    if None in each:
        return None
    squares = [[value**2 for value in one["values"]] for one in each]
    joined = [sum(column) if which == "rmse_paper" else fmean(column) for column in zip(*squares, strict=True)]
    return mean_and_std([value**0.5 for value in joined])


def unseen_ratios(found: Found, name: str, which: str = "rmse_percent") -> dict[str, Any] | None:
    """The error over fresh runs of the six ratios together, by seed."""
    seeds = found["learned"].get("baseline", {}).get("by_run", {}).get("by_ratio")
    if seeds is None:
        return None
    squares = [[seed[f"{ratio:g}"][name][which] ** 2 for ratio in RATIOS_PERCENT] for seed in seeds]
    joined = [sum(one) if which == "rmse_paper" else fmean(one) for one in squares]
    return mean_and_std([value**0.5 for value in joined])


def leads_table(found: Found) -> str:
    """Which network leads: by how much the error of cwt_lstm lies below that of raw_lstm, seed by seed."""
    rows = []
    for name, effect in EFFECT_OF.items():
        one = RMSE[name]
        ahead = f"{100 * (1 - one.cwt_lstm / one.raw_lstm):+.0f} %"
        columns = [_lead(found, effect, protocol) for protocol in ("paper", "paper_many_runs", "by_run")]
        rows.append((name.removeprefix("figure_").lstrip("0"), EFFECTS[name], ahead, *columns))
    head = ("figure", "effect", "printed", "one run", "many runs, cut by time", "unseen runs")
    return markdown(head, rows, left=2)


def _lead(found: Found, effect: str, protocol: str) -> str:
    """Lead of the CWT in % of the raw network's error, with its standard error; whether it is one."""
    raw, cwt = (score(found, effect, protocol, name) for name in (RAW, CWT))
    if raw is None or cwt is None:
        return NOTHING
    leads = mean_and_std([100 * (1 - c / r) for r, c in zip(raw["values"], cwt["values"], strict=True)])
    error = leads["std"] / len(leads["values"]) ** 0.5
    if len(leads["values"]) == 1:
        return f"{leads['mean']:+.0f} %"
    return f"{leads['mean']:+.0f} ± {error:.0f} %" + ("" if abs(leads["mean"]) > CLEAR * error else " (not clear)")


def table_2(found: Found) -> str:
    """The paper's Table 2 with what is found here."""
    columns = {
        "as printed": [printed("figure_14", CWT), printed("figure_14", RAW), printed("figure_15", CWT),
                       printed("figure_15", RAW)],
        "one run, 1/N, fraction": [as_fraction(ratios_together(found, one)) for one in (CWT, RAW)]
        + [as_fraction(score(found, "torque", "paper", one)) for one in (CWT, RAW)],
        "one run, Eq 7, fraction": [as_fraction(ratios_together(found, one, "rmse_paper")) for one in (CWT, RAW)]
        + [as_fraction(score(found, "torque", "paper", one, "rmse_paper")) for one in (CWT, RAW)],
        "white noise on one run, 1/N": [as_fraction(ratios_together(found, BLIND)), "",
                                        as_fraction(score(found, "torque", "paper", BLIND)), ""],
        "unseen runs, 1/N, %": [in_percent(unseen_ratios(found, one)) for one in (CWT, RAW)]
        + [in_percent(score(found, "torque", "by_run", one)) for one in (CWT, RAW)],
        "mean of the labels, unseen runs, %": [in_percent(unseen_ratios(found, MEAN)), "",
                                               in_percent(score(found, "torque", "by_run", MEAN)), ""],
    }  # fmt: skip
    head = ("", "ratios: CWT–LSTM", "ratios: LSTM", "torque: CWT–LSTM", "torque: LSTM")
    return markdown(head, [(label, *cells) for label, cells in columns.items()])
