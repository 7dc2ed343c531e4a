"""The page that says how often it was right."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .judge import Case
from .rates import MISSED
from .strata import COUNTS, MEANING

HEAD = """# Blind cases

An independent generator (`tests/oracles/hidden`) hides effects in measurements of gear pairs and oscillators: it
imports nothing of the package, integrates by another method, and its crack, friction, pitch, stiffness edges and
hysteresis have other forms than those of the catalogue. Rig, sensors, units, zero, noise, rate and length vary. Each
case is a folder as a user would hand it over. Nothing but that folder reaches `task=explain`; its answer is judged
afterwards. This page is written by `make blind`.
"""


def table(found: dict[str, Any], cases: Sequence[Case], command: str) -> str:
    """The markdown page of these rates."""
    parts = [HEAD, _basis(found, command), _rates(found), _figures(found), _effects(found)]
    parts += [_varied(found, "rigs", "rig (teeth)"), _varied(found, "channels", "channel or sensors"), _strata(cases)]
    return "\n".join(parts)


def _basis(found: dict[str, Any], command: str) -> str:
    engines, seconds = len(found["engines"]), found["seconds"]
    said = "one version" if engines == 1 else f"{engines} versions"
    return (
        f"Written by `{command}` from {found['cases']} cases, explained by {said} of the package "
        f"({', '.join(found['engines'])}); a diagnosis took {seconds['median']:.3g} s of one core (median; nineteen of "
        f"twenty at most {seconds['p95']:.3g}, the longest {seconds['longest']:.3g}), its kernels compiled.\n"
    )


def _rates(found: dict[str, Any]) -> str:
    rows = ["| what | rate | of | 95 % interval | target | met |", "|---|---|---|---|---|---|"]
    for claim, row in found["rates"].items():
        low, high = (f"{100 * v:.1f}" for v in row["interval95"])
        met = f"**{row['met']}**" if row["met"] == MISSED else row["met"]
        rows.append(f"| {claim} | {100 * row['rate']:.1f} % | {row['n']} | {low} to {high} % | "
                    f"{_percent(row['target'])} | {met} |")  # fmt: skip
    note = (
        "`of` is the number of seeds that a rate rests on; intervals are those of Clopper and Pearson. *Met*: the "
        "interval lies within the target; *not contradicted*: only the rate does.\n"
    )
    return "\n".join(["## Rates", "", *rows, "", note])


def _percent(target: str) -> str:
    side, _, value = target.rpartition(" ")
    return f"{side} {100 * float(value):g} %"


def _figures(found: dict[str, Any]) -> str:
    lines = [
        f"- Held-out misfit after the extension at about {level}, over the noise floor: median {row['median']:.3g}, "
        f"largest {row['largest']:.3g} ({row['n']} cases)."
        for level, row in found["misfit_after"].items()
    ]
    own = found["parameters"]
    if own["n"]:
        held = own["interval_coverage"]
        lines.append(
            f"- Parameters of named effects that mean the same on both sides: median error "
            f"{100 * own['median_relative_error']:.2g} %; {held['count']} of {held['n']} intervals hold the truth."
        )
    cells = found["cells"]
    if cells:
        lines.append(
            f"- Other rigs: {cells['right']} of {cells['cases']} cases right in {cells['cells']} cells (teeth of the "
            f"pinion by plan of sensors); that all cells are alike has p = {cells['p']:.2g}."
        )
    return "\n".join(["## Figures", "", *lines, ""]) if lines else ""


def _effects(found: dict[str, Any]) -> str:
    if not found["effects"]:
        return ""
    rows = ["| hidden effect | cases | named first | named or in the set | wrong name |", "|---|---|---|---|---|"]
    rows += [f"| `{name}` | {r['n']} | {r['first']} | {r['in the set']} | {r['wrong']} |"
             for name, r in found["effects"].items()]  # fmt: skip
    return "\n".join(["## By effect (stratum `single`)", "", *rows, ""])


def _varied(found: dict[str, Any], key: str, head: str) -> str:
    """What became of each rig, or of each channel."""
    if not found.get(key):
        return ""
    rows = [f"| {head} | nulls | consistent | damping in its interval | effects | named or in the set | wrong name |"]
    rows += ["|---|---|---|---|---|---|---|"]
    rows += [f"| {name} | " + " | ".join(str(count) for count in row.values()) + " |"
             for name, row in found[key].items()]  # fmt: skip
    return "\n".join([f"## By {head}", "", *rows, ""])


def _strata(cases: Sequence[Case]) -> str:
    rows = ["| stratum | what it is | cases here | of a full run |", "|---|---|---|---|"]
    for stratum, count in COUNTS.items():
        here = sum(case["stratum"] == stratum for case in cases)
        rows.append(f"| `{stratum}` | {MEANING[stratum]} | {here} | {count} |")
    return "\n".join(["## Strata", "", *rows, ""])
