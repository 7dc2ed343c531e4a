"""Runs that estimators are asked about: their noise, the same for all, and the bound of what they hold."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import torch
from torch import Tensor

from gear_damping.identification.cramer_rao import cramer_rao
from gear_damping.identification.evaluation import is_repeatable, scores, with_prior
from gear_damping.identification.known_model.estimate import Estimates
from gear_damping.identification.known_model.known_runs import START, KnownRuns, range_of, start_of
from gear_damping.identification.seeding import seeded_generator
from gear_damping.physics.damping_ratio import DAMPING_RATIO
from gear_damping.physics.terms import HeldLoad
from gear_damping.simulation.plan import SimulationPlan
from gear_damping.simulation.runs import Runs

EXACT = 1e-6  # of the size of a motion: how well a start is known that a family does not vary
Said = tuple[Estimates, float]  # of one training, with the seconds that a record took
BANDS = 4  # of the range of damping ratios, in which errors are told apart
CLEAN = 120.0  # dB: noise below what single precision holds


@dataclass(frozen=True, eq=False)
class Bench:
    """Runs that nobody was trained on.

    Args:
        plan: What they are.
        runs: As simulated.
        bounds: The Cramer-Rao bound of each by level of noise, start unknown, %; None where there is none.
        regular: Which of them have one, (runs,).
        signals: What the sensor shows of them but for its noise, (runs, time).
    """

    plan: SimulationPlan
    runs: Runs
    bounds: dict[float, Tensor | None]
    regular: Tensor
    signals: Tensor

    def __len__(self) -> int:
        return len(self.true)

    @cached_property
    def true(self) -> Tensor:
        """Damping ratio of each run that a family draws and networks learn, %: that of the laws that state one."""
        return self.runs.stated_ratio_percent.double()

    @property
    def ends(self) -> tuple[float, float]:
        """Smallest and largest ratio of the family, %."""
        return range_of(self.plan.prior)

    @property
    def mean_ratio(self) -> float:
        """Of the family: what knows nothing says."""
        return sum(self.ends) / 2

    @property
    def mean_predictor(self) -> Estimates:
        """What knows the family and nothing of the record."""
        low, high = self.ends
        edge = 0.05 * (high - low)  # of a uniform distribution, outside the middle nine tenths
        centre = torch.full_like(self.true, self.mean_ratio)
        return Estimates(centre, torch.full_like(centre, low + edge), torch.full_like(centre, high - edge))

    def limit(self, snr: float) -> Tensor | None:
        """What the bound leaves of the family's ratios, standard deviations in %, (runs,)."""
        bound = self.bounds[snr]
        return None if bound is None else with_prior(bound, self.ends)

    def noise(self, snr: float) -> Tensor:
        """Standard deviation of the noise, (runs,)."""
        return self.signals.std(-1, correction=0) * 10 ** (-snr / 20)

    def records(self, rows: Tensor, snr: float) -> Tensor:
        """Noisy records, the same for every estimator, (rows, time)."""
        drawn = noise_of(self.signals.shape, self.plan.seed, snr)
        return (self.signals + self.noise(snr)[:, None] * drawn)[rows]

    def known(self, rows: Tensor, snr: float) -> KnownRuns:
        """Some of the runs for estimators that know their equation."""
        picked = torch.zeros(len(self), dtype=torch.bool)
        picked[rows] = True
        runs = self.runs.keep(picked)
        start = start_of(runs, self.plan.prior)
        law = self.plan.damping_law
        return KnownRuns(
            runs, law, self.ends, *start, self.records(rows, snr), self.noise(snr)[rows], solver=self.plan.solver
        )


def noise_of(shape: Sequence[int], seed: int, snr: float) -> Tensor:
    """White noise of deviation one, the same for all runs of a seed at a level of noise, whatever is in them."""
    key = int(snr) if snr == int(snr) else str(snr)
    return torch.randn(tuple(shape), generator=seeded_generator(seed, "noise", key))


def bench(plan: SimulationPlan, runs: Runs, levels: Sequence[float], signals: Tensor | None = None) -> Bench:
    """Runs with their bounds; there are none where a load is drawn, which nobody knows, and none without noise.

    Args:
        plan: What they are; its family has a range of damping ratios.
        runs: As simulated.
        levels: Signal-to-noise ratios of the sensor, dB.
        signals: What the sensor shows but for its noise, (runs, time); the response itself where absent.
    """
    shown = runs.response if signals is None else signals
    if any(isinstance(effect, HeldLoad) for effect in plan.model.effects):
        every = torch.ones(len(shown), dtype=torch.bool)
        return Bench(plan, runs, dict.fromkeys(levels), every, shown)
    _, deviation = start_of(runs, plan.prior)
    rms = shown.std(-1, correction=0)
    usual = (float(rms.mean()), float(runs.reference_velocity.mean()))
    sizes = zip(START, deviation.mean(0).tolist(), usual, strict=True)
    known = {name: max(size, EXACT * unit) for name, size, unit in sizes}
    bounds = {
        snr: cramer_rao(runs, [DAMPING_RATIO], rms * 10 ** (-snr / 20), expected=known, solver=plan.solver)
        for snr in levels
        if snr < CLEAN
    }
    deviations = {snr: bounds[snr].deviation(DAMPING_RATIO) if snr in bounds else None for snr in levels}
    return Bench(plan, runs, deviations, is_repeatable(runs, plan.solver), shown)


def mean_over_seeds(made: Bench, said: list[Said], snr: float) -> dict[str, Any]:
    """Figures of one estimator over the regular runs: means over its trainings, with those of each."""
    kept, limit = made.regular, made.limit(snr)
    limit = None if limit is None else limit[kept]
    each = [
        dict(scores(made.true[kept], Estimates(*(part[kept] for part in one)), limit, made.mean_ratio))
        for one in ((e.ratio, e.low, e.high) for e, _ in said)
    ]
    found = {key: None if each[0][key] is None else sum(one[key] for one in each) / len(each) for key in each[0]}
    found["seconds_per_record"] = sum(seconds for _, seconds in said) / len(said)
    found["by_damping_ratio"] = _by_ratio(made, [one for one, _ in said])
    return found | ({"per_seed": each} if len(each) > 1 else {})


def _by_ratio(made: Bench, said: Sequence[Estimates]) -> list[dict[str, float]]:
    """Error and median relative error in each quarter of the range of damping ratios that holds runs."""
    low, high = made.ends
    edges = [low + (high - low) * number / BANDS for number in range(BANDS + 1)]
    found = []
    for start, end in pairwise(edges):
        kept = made.regular & (start <= made.true) & ((made.true < end) | (end == high))
        if not bool(kept.any()):
            continue
        errors = torch.stack([one.ratio[kept].double() - made.true[kept] for one in said])
        error = errors.square().mean(1).sqrt().mean()
        relative = (errors.abs() / made.true[kept]).median(1).values.mean()
        row = {"from_percent": start, "to_percent": end, "runs": int(kept.sum())}
        found.append(row | {"rmse_percent": float(error), "median_relative_error": float(relative)})
    return found
