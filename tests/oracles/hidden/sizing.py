"""How large an effect must be to leave the excess asked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .draft import Draft
from .effect import Params
from .excess import excess, sensitivities
from .integrate import Trajectory, integrate
from .knobs import Knobs, stack
from .plans import FIT, HOLDOUT, Condition
from .sensor import coupled, response
from .stiffness import Arrays

LADDER = 4  # sizes that are tried, evenly spaced in the logarithm


@dataclass
class Basis:
    """Of one case: sensitivities and response without the effects (n, record, ...), and its conditions."""

    columns: np.ndarray
    response: np.ndarray
    conditions: list[Condition]
    mean_known: bool = True

    def excess(self, difference: np.ndarray, with_added: bool = True) -> dict[str, float]:
        """D of a difference (n, record), over the whole plan or over what was recorded first."""
        kept = np.array([with_added or not c.added for c in self.conditions])
        fit = kept & np.array([c.role == FIT for c in self.conditions])
        held_out = kept & np.array([c.role == HOLDOUT for c in self.conditions])
        fit, held_out = (fit, held_out) if fit.any() else (kept, held_out)
        columns = self.columns
        if not self.mean_known:
            difference, columns = (v - v.mean(axis=0) for v in (difference, columns))
        return excess(difference, columns, self.response, fit, held_out if held_out.any() else fit)


@dataclass
class Sized:
    """The parameters of each effect, the D / % that the trials promise for each (None: not tried), the basis."""

    params: list[Params]
    predicted: list[float | None]
    basis: Basis
    sizes: list[float | None]


def members_of(knobs: Arrays, own: slice) -> Arrays:
    """Some of the members."""
    return {name: value[..., own] for name, value in knobs.items()}


def path_of(path: Trajectory, own: slice) -> Trajectory:
    """The trajectories of some of the members."""
    inner = {name: getattr(path, name)[:, own] for name in ("x", "v", "a", "delta")}
    return Trajectory(path.time, **inner, diverged=path.diverged[own])


def run(knobs: Arrays, drafts: list[Draft], repeats: list[int], n: int, substeps: int) -> Trajectory:
    """Integrate `repeats` variants of each draft's records, all from the records' own starts, at their one rate."""
    settle, rate = drafts[0].settle, drafts[0].rig.rate
    start = np.concatenate([np.tile(one.start, times) for one, times in zip(drafts, repeats, strict=True)], axis=1)
    held = None
    if np.any(knobs["load_noise"]):
        unit = [np.random.default_rng([one.seed, 77]).normal(size=(len(one.records), n + settle)) for one in drafts]
        held = np.concatenate([np.tile(u, (times, 1)) for u, times in zip(unit, repeats, strict=True)]).T
    return integrate(knobs, n, rate, substeps, settle, start[0], start[1], held)


def size(drafts: list[Draft], n: int) -> list[Sized]:
    """Run every record without its effects and with each effect at each size on trial, and choose."""
    members = [member for one in drafts for member in [*one.records, *_trials(one)]]
    repeats = [1 + LADDER * sum(target is not None for target in one.targets) for one in drafts]
    knobs = stack(members)
    path = run(knobs, drafts, repeats, n, 2)
    found, first = [], 0
    for one, times in zip(drafts, repeats, strict=True):
        count = len(one.records)
        own, base = slice(first, first + times * count), slice(first, first + count)
        seen = clean(one, members_of(knobs, own), path_of(path, own)).reshape(n, times, count)
        columns = sensitivities(members_of(knobs, base), path_of(path, base), one.setup.order)
        if one.setup.corner is not None:
            columns = coupled(columns, one.setup.corner, one.rig.rate)
        basis = Basis(columns, seen[:, 0], one.conditions, one.setup.datum == "absolute")
        found.append(_chosen(one, basis, seen[:, 1:] - seen[:, :1]))
        first = own.stop
    return found


def clean(one: Draft, knobs: Arrays, path: Trajectory, noise: np.ndarray | float = 0.0) -> np.ndarray:
    """The response as the case's sensors see it."""
    return response(knobs, path, noise, one.setup.order, one.setup.factor(one.rig), one.setup.corner)


def _sizes(least: float) -> np.ndarray:
    return np.geomspace(least, 1.0, LADDER)


def _trials(one: Draft) -> list[Knobs]:
    members = []
    for effect, params, target in zip(one.effects, one.params, one.targets, strict=True):
        for share in _sizes(effect.least) if target is not None else ():
            turn = effect.as_modelled or effect.turn
            members += [record | turn(effect.at(params, share), record) for record in one.records]
    return members


def _chosen(one: Draft, basis: Basis, differences: np.ndarray) -> Sized:
    """Log-log interpolation of D; the nearest size on trial where the target is out of reach."""
    chosen, predicted, sizes, first = [], [], [], 0
    for effect, params, target in zip(one.effects, one.params, one.targets, strict=True):
        if target is None:
            chosen.append(params)
            predicted.append(None)
            sizes.append(None)
            continue
        left = [basis.excess(differences[:, first + j])["excess_percent"] for j in range(LADDER)]
        finite = np.cumprod(np.isfinite(left)).astype(bool)  # up to the first trial that diverged
        if not finite.any():
            raise ValueError(f"{one.stratum} {one.seed}: {effect.name} diverges even at its least size; lower `least`")
        rising = np.maximum.accumulate(np.log(np.array(left)[finite] + 1e-12)) + 1e-9 * np.arange(finite.sum())
        log_sizes = np.log(_sizes(effect.least))[finite]
        log_size = np.interp(np.log(target), rising, log_sizes)
        sizes.append(float(np.exp(log_size)))
        chosen.append(effect.at(params, sizes[-1]))
        predicted.append(float(np.exp(np.interp(log_size, log_sizes, rising))))
        first += LADDER
    return Sized(chosen, predicted, basis, sizes)


def corrected(one: Draft, sized: Sized, reached: float) -> bool:
    """Change the size of a single effect whose excess the trials, far apart, were wrong about; whether it was."""
    if len(one.effects) != 1 or sized.sizes[0] is None or one.effects[0].as_modelled:
        return False
    ratio = sized.predicted[0] / max(reached, 1e-9)
    size = min(max(sized.sizes[0] * float(np.clip(ratio, 0.05, 20.0)) ** 0.5, one.effects[0].least), 1.0)
    if not np.isfinite(reached) or 0.75 < ratio < 1.35 or size == sized.sizes[0]:
        return False
    sized.sizes[0], sized.params[0] = size, one.effects[0].at(one.params[0], size)
    return True
