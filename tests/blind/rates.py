"""Rates with their Clopper-Pearson intervals, beside the targets."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy.stats import PermutationMethod, binomtest, chi2_contingency

from .accuracy import errors, misfits
from .judge import Case, channel_of, damping_held, judged, names
from .strata import NOISES

# claim -> (target, whether the rate should be at least or at most that)
TARGETS = {
    "effect established and named first": (0.95, "at least"),
    "effect named or in the set": (0.95, "at least"),
    "wrong name established": (0.05, "at most"),
    "faint effect named, suggested or in the set": (0.80, "at least"),
    "null names a cause": (0.02, "at most"),
    "null consistent": (0.95, "at least"),
    "damping of a null in its interval": (0.90, "at least"),
    "below the limit, a wrong name": (0.05, "at most"),
    "outside, called explained": (0.05, "at most"),
    "outside, unexplained": (0.90, "at least"),
    "removed, explained by another": (0.0, "at most"),
    "pair, both named": (0.85, "at least"),
    "one record, in the set or not observable": (0.95, "at least"),
    "one record, set too large": (0.0, "at most"),
    "with the experiment, named": (0.95, "at least"),
    "tacho error, a wrong name": (0.05, "at most"),
    "unidentifiable, explained by another": (0.05, "at most"),
    "damaged file blamed on physics": (0.0, "at most"),
    "other rig: null consistent": (0.95, "at least"),
    "other rig: damping of a null in its interval": (0.90, "at least"),
    "other rig: named or in the set": (0.95, "at least"),
    "other rig: a wrong name": (0.05, "at most"),
    "other rig: a wrong inertia called ambiguous": (0.95, "at least"),
    "oscillator: null consistent": (0.95, "at least"),
    "oscillator: damping of a null in its interval": (0.90, "at least"),
    "oscillator: named or in the set": (0.95, "at least"),
    "oscillator: a wrong name": (0.05, "at most"),
    "usual channel: named or in the set": (0.95, "at least"),
    "usual channel: a wrong name": (0.05, "at most"),
    "another channel: named or in the set": (0.90, "at least"),
    "another channel: a wrong name": (0.05, "at most"),
    "other noise: consistent": (0.95, "at least"),
    "other noise: damping in its interval": (0.90, "at least"),
    **{
        f"{kind.replace('_', ' ')}: {what}": (target, "at least")
        for kind in NOISES
        for what, target in (("consistent", 0.95), ("damping in its interval", 0.90))
    },
    "outside or removed, a name established": (0.02, "at most"),
    "any case: a wrong name established": (0.01, "at most"),
    "any case: over its budget": (0.0, "at most"),
    "did not crash": (1.0, "at least"),
}
MET, NOT_CONTRADICTED, MISSED = "met", "not contradicted", "no"  # the interval, the estimate, or neither is within
SAME_LEVEL, RESAMPLED, SEED = 0.01, 9999, 0  # of the test that cells are alike; its permutations, their seed


def clopper_pearson(count: int, n: int, level: float = 0.95) -> tuple[float, float]:
    """The exact interval of a rate of `count` in `n`."""
    if not 0 <= count <= n or n < 1:
        raise ValueError(f"count must lie in 0..n and n be at least 1, not {count} of {n}")
    found = binomtest(count, n).proportion_ci(level, method="exact")
    return float(found.low), float(found.high)


def rates(cases: Sequence[Case]) -> dict[str, Any]:
    """Everything that rates.json holds."""
    verdicts = [(case, judged(case)) for case in cases]
    rows = {claim: row for claim in TARGETS if (row := _row(claim, verdicts))}
    found = errors(cases)
    return {
        "cases": len(cases),
        "engines": sorted({case["engine"] for case in cases}),
        "rates": rows,
        "misfit_after": misfits(cases),
        "parameters": {
            "n": len(found),
            "median_relative_error": statistics.median(error for error, _ in found) if found else None,
            "interval_coverage": _counted([held for _, held in found]) if found else None,
        },
        "seconds": _seconds([case["seconds"] for case in cases]),
        "effects": _by_effect(verdicts),
        "cells": _alike(verdicts),
        "rigs": _by(lambda case: case["truth"].get("pair") or "20/40", verdicts, ("rigs",)),
        "channels": _by(channel_of, verdicts, ("rigs", "channels", "oscillators")),
    }


def _row(claim: str, verdicts: Sequence[tuple[Case, dict]]) -> dict[str, Any] | None:
    counted = [(case, value[claim]) for case, value in verdicts if value.get(claim) is not None]
    if not counted:
        return None
    target, side = TARGETS[claim]
    row = _counted([value for _, value in counted])
    low, high = row["interval95"]
    nearest, farthest = (row["rate"], low) if side == "at least" else (-row["rate"], -high)
    bound = target if side == "at least" else -target
    met = MET if farthest >= bound else NOT_CONTRADICTED if nearest >= bound else MISSED
    wrong = [f"{c['stratum']} {c['seed']}" for c, value in counted if value != (side == "at least")]
    seeds = sorted({case["seed"] for case, _ in counted})
    return row | {"target": f"{side} {target:g}", "met": met, "seeds": [seeds[0], seeds[-1]], "failed": wrong}


def _seconds(values: Sequence[float]) -> dict[str, float] | None:
    """Of one core, for a diagnosis."""
    if not values:
        return None
    return {"median": statistics.median(values), "p95": float(np.quantile(values, 0.95)), "longest": max(values)}


def _alike(verdicts: Sequence[tuple[Case, dict]]) -> dict[str, Any] | None:
    """Whether rigs are answered alike: one test of homogeneity over pinions by plans of sensors, by permutations."""
    cells: dict[tuple[str, str], Counter] = {}
    for case, value in verdicts:
        if case["stratum"] == "rigs" and case.get("sensors") != "inertia_wrong":
            claims = {claim.split(": ")[-1]: said for claim, said in value.items()}
            right = claims["null consistent"] if not names(case) else claims["named or in the set"]
            cell = (case["truth"].get("pair", "20/40").split("/")[0], case["truth"].get("sensors") or "full")
            cells.setdefault(cell, Counter())[bool(right)] += 1
    table = np.array([[cell[True], cell[False]] for cell in cells.values()])
    if len(table) < 2 or not table.sum(0).all():
        return None
    method = PermutationMethod(n_resamples=RESAMPLED, rng=np.random.default_rng(SEED))
    p = float(chi2_contingency(table, correction=False, method=method).pvalue)
    return {"cells": len(table), "cases": int(table.sum()), "right": int(table[:, 0].sum()), "p": p,
            "alike": p > SAME_LEVEL}  # fmt: skip


def _counted(values: Sequence[bool]) -> dict[str, Any]:
    count, n = sum(values), len(values)
    return {"count": count, "n": n, "rate": count / n, "interval95": list(clopper_pearson(count, n))}


def _by_effect(verdicts: Sequence[tuple[Case, dict]]) -> dict[str, dict[str, int]]:
    """Of each hidden effect: how many singles, named first, in the set, wrong."""
    claims = {"first": "effect established and named first", "in the set": "effect named or in the set",
              "wrong": "wrong name established"}  # fmt: skip
    found: dict[str, dict[str, int]] = {}
    for case, value in verdicts:
        if case["stratum"] == "single":
            row = found.setdefault(case["truth"]["effects"][-1]["name"], dict.fromkeys(("n", *claims), 0))
            row["n"] += 1
            for short, claim in claims.items():
                row[short] += bool(value[claim])
    return dict(sorted(found.items()))


def _by(
    key: Callable[[Case], str], verdicts: Sequence[tuple[Case, dict]], strata: Sequence[str]
) -> dict[str, dict[str, int]]:
    """Of each rig or channel: nulls, how many of them consistent and with their damping; effects, named, wrong."""
    found: dict[str, dict[str, int]] = {}
    for case, value in verdicts:
        if case["stratum"] not in strata or case.get("sensors") == "inertia_wrong":
            continue
        row = found.setdefault(key(case), dict.fromkeys(ROW, 0))
        claims = {claim.split(": ")[-1]: said for claim, said in value.items()}
        if names(case):
            row["effects"] += 1
            row["named"] += bool(claims["named or in the set"])
            row["wrong"] += bool(claims["a wrong name"])
        else:
            row["nulls"] += 1
            row["consistent"] += bool(claims["null consistent"])
            row["damping held"] += bool(damping_held(case, case["answer"]))
    return dict(sorted(found.items()))


ROW = ("nulls", "consistent", "damping held", "effects", "named", "wrong")
