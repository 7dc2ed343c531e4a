"""Simulation beside other solvers, each at the cheapest setting that reaches the error asked."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from benchmarks import reference
from benchmarks.harness import OWN, PEERS, Contestant, PeerError, Process, absent, interleave, rows
from benchmarks.members import N_SAMPLES, draw

KEPT = 64  # members that are compared with the reference
SCIPY_MEMBERS = 16
SHARED = 400  # members that an engine with one step size for all is tried on
SHORT = 200  # outputs of the runs with backlash: their chaos has not begun
WANTED = 1e-5
Log = Callable[[str], None]


@dataclass(frozen=True)
class Plan:
    """An engine and its settings from cheap to dear; the first that reaches the error is measured.

    Args:
        shares_steps: One step size serves the whole batch, so that the error depends on the batch.
    """

    name: str
    module: str
    setting: str
    ladder: tuple[float, ...]
    shares_steps: bool = False
    most: int | None = None
    own: bool = False


OURS = Plan("ours", "own", "substeps", (2, 3, 4, 5, 6, 8), own=True)
PEER_PLANS = (
    Plan("scipy_rk45", "simulation_peers", "tolerance", (1e-6, 3e-7, 1e-7), most=SCIPY_MEMBERS),
    Plan("torchdiffeq_dopri5", "simulation_peers", "tolerance", (1e-6, 3e-7, 2e-7, 1e-7, 3e-8), True),
    Plan("diffrax", "simulation_peers", "tolerance", (1e-6, 3e-7, 1e-7, 3e-8)),
    Plan("diffrax_same_algebra", "simulation_peers", "substeps", (2, 3, 4, 5, 6)),
    Plan("numba_rk4", "simulation_peers", "substeps", (10, 12, 16, 20, 24)),
)
TUNED = Plan("tuned_cpp", "tuned", "substeps", (2, 3, 4, 5, 6), own=True)
UNAWARE = Plan("rk4_unaware", "unaware", "substeps", (1024, 2048, 4096, 8192), own=True)


@cache
def smooth_reference() -> np.ndarray:
    return reference.smooth(draw(KEPT))


@cache
def backlash_reference() -> np.ndarray:
    return reference.backlash(draw(KEPT, backlash=True), SHORT)


def smooth(batch: int, rounds: int, log: Log, peers: tuple[str, ...] | None = None) -> list[dict]:
    """Whole trajectories at an error of at most 1e-5 (90th percentile over 64 members)."""
    plans = [OURS, *(plan for plan in PEER_PLANS if peers is None or plan.name in peers)]
    found = []
    for plan in plans:
        options = {"n_samples": N_SAMPLES, "backlash": False} if plan.name == "ours" else {}
        found.append(climb(plan, options, smooth_reference(), batch, 90, WANTED, log))
    return contest("simulate_smooth", batch, found, rounds)


def backlash(batch: int, rounds: int, percentile: int, log: Log) -> list[dict]:
    """Short runs with contact loss: ours, and RK4 that knows nothing of contact, at one error.

    At the median that error is 1e-5; at the 90th percentile it is what ours has with the same setting.
    """
    options = {"n_samples": SHORT}
    ours = climb(OURS, options | {"backlash": True}, backlash_reference(), batch, 50, WANTED, log)
    wanted = WANTED if percentile == 50 else ours.about.get("error_p90", WANTED)
    unaware = climb(UNAWARE, options, backlash_reference(), batch, percentile, wanted, log)
    found = contest("simulate_backlash", batch, [ours, unaware], rounds)
    return [row | {"equal_error_at": f"p{percentile}", "outputs": SHORT} for row in found]


def limit(batch: int, rounds: int, log: Log) -> list[dict]:
    """Ours beside C++ written by hand for this one equation, as it is and with our way of its costly parts."""
    ways = ((), ("cosines",), ("exact_power",), ("cosines", "exact_power"))
    found = [climb(OURS, {"n_samples": N_SAMPLES, "backlash": False}, smooth_reference(), batch, 90, WANTED, log)]
    for way in ways:
        contestant = climb(TUNED, dict.fromkeys(way, True), smooth_reference(), batch, 90, WANTED, log)
        contestant.about["with"] = " and ".join(way) or "nothing of ours"
        found.append(contestant)
    kept = ("engine", "with", "batch", "setting", "error_p90", "cpu_ms_per_item", "ratio_to_ours", "reason")
    return [{k: row[k] for k in kept if k in row} for row in contest("limit", batch, found, rounds)]


def climb(
    plan: Plan, options: dict, expected: np.ndarray, batch: int, percentile: int, wanted: float, log: Log
) -> Contestant:
    """The engine at the first setting that is exact enough, or at the last.

    Engines whose members do not share steps are tried on the members of the reference alone, the others
    on a batch of at most 400.
    """
    items = min(batch, plan.most or batch)
    tried = min(items, SHARED if plan.shares_steps else KEPT)
    try:
        setting, error = _first_exact(plan, tuple(options.items()), tried, percentile, wanted, expected)
        python = OWN if plan.own else PEERS
        process = Process(python, plan.module, plan.name, {**options, plan.setting: setting, "batch": items})
        process.run()  # the first one compiles
    except PeerError as problem:
        log(f"  {plan.name}: left out ({problem})")
        return absent(plan.name, problem)
    median, ninety = (float(value) for value in np.percentile(error, [50, 90]))
    about = {"error_p90": ninety, "error_p50": median, "setting": f"{plan.setting} {setting:g}"}
    log(f"  {plan.name}: {about['setting']}, error p50 {median:.1e}, p90 {ninety:.1e}")
    reached = np.percentile(error, percentile) <= wanted
    return Contestant(plan.name, process, items, about | ({} if reached else {"short_of": wanted}))


_tried: dict[tuple, np.ndarray] = {}


def _first_exact(
    plan: Plan, options: tuple, batch: int, percentile: int, wanted: float, expected: np.ndarray
) -> tuple[float, np.ndarray]:
    """The setting and its errors; what was tried before is not tried again."""
    python = OWN if plan.own else PEERS
    for setting in plan.ladder:
        key = (plan.name, options, batch, setting)
        if key not in _tried:
            chosen = {**dict(options), plan.setting: setting, "batch": batch}
            _tried[key] = _errors(python, plan, chosen, expected)
        if np.percentile(_tried[key], percentile) <= wanted:
            break
    return setting, _tried[key]


def _errors(python: object, plan: Plan, options: dict, expected: np.ndarray) -> np.ndarray:
    process = Process(python, plan.module, plan.name, options)
    try:
        _, result = process.result()
    finally:
        process.close()
    return reference.errors(result, expected[: len(result)])


def contest(work: str, batch: int, contestants: list[Contestant], rounds: int) -> list[dict]:
    interleave(contestants, rounds)
    for contestant in contestants:
        contestant.close()
    return rows(work, batch, contestants)
