"""The runs that every estimator is asked about, their noise, and the bound of what they hold."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import torch
from torch import Tensor

from gear_damping.config.settings import Settings, read_settings
from gear_damping.identification.cramer_rao import cramer_rao
from gear_damping.identification.evaluation import is_regular, with_prior
from gear_damping.identification.known_model.estimate import Estimates
from gear_damping.identification.known_model.family import START, KnownRuns, range_of, start_of
from gear_damping.identification.seeding import seeded_generator
from gear_damping.physics.damping_ratio import DAMPING_RATIO
from gear_damping.simulation.plan import SimulationPlan, run_plan
from gear_damping.simulation.runs import Runs
from gear_damping.tasks.composed import composed
from gear_damping.tasks.simulated import plan_of

SNRS = (30, 20, 10, 1)  # dB
TEST_SEED = 90_001  # of the runs that are asked about; training seeds are small


def settings_of(family: str, n_runs: int, seed: int) -> Settings:
    """The settings of experiment=limit."""
    overrides = ["experiment=limit", f"family={family}", f"simulator.n_runs={n_runs}", f"seed={seed}"]
    return read_settings(*composed(overrides))


@dataclass(frozen=True, eq=False)
class Bench:
    """Runs that nobody was trained on.

    Args:
        plan: What they are.
        runs: As simulated.
        bounds: The Cramer-Rao bound of each by level of noise, start unknown, %.
        regular: Which of them have one, (runs,).
    """

    plan: SimulationPlan
    runs: Runs
    bounds: dict[int, Tensor]
    regular: Tensor

    def __len__(self) -> int:
        return len(self.true)

    @cached_property
    def true(self) -> Tensor:
        """Damping ratio of each run, %."""
        return self.runs.damping_ratio_percent.double()

    @property
    def ends(self) -> tuple[float, float]:
        """Smallest and largest ratio of the family, %."""
        return range_of(self.plan.family)

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

    def limit(self, snr: int) -> Tensor:
        """What the bound leaves of the family's ratios, standard deviations in %, (runs,)."""
        return with_prior(self.bounds[snr], self.ends)

    def noise(self, snr: int) -> Tensor:
        """Standard deviation of the noise, (runs,)."""
        return self.runs.response.std(-1, correction=0) * 10 ** (-snr / 20)

    def records(self, rows: Tensor, snr: int) -> Tensor:
        """Noisy records, the same for every estimator, (rows, time)."""
        drawn = torch.randn(self.runs.response.shape, generator=seeded_generator(TEST_SEED, "noise", snr))
        return (self.runs.response + self.noise(snr)[:, None] * drawn)[rows]

    def known(self, rows: Tensor, snr: int) -> KnownRuns:
        """Some of the runs for estimators that know their equation."""
        picked = torch.zeros(len(self), dtype=torch.bool)
        picked[rows] = True
        runs = self.runs.keep(picked)
        start = start_of(runs, self.plan.family)
        law = self.plan.damping_law
        return KnownRuns(
            runs, law, self.ends, *start, self.records(rows, snr), self.noise(snr)[rows], solver=self.plan.solver
        )


def bench(family: str, n_runs: int, folder: Path) -> Bench:
    """The runs of a family; the bounds, which take longest, are kept in a folder."""
    plan = replace(plan_of(settings_of(family, n_runs, TEST_SEED)), n_runs=n_runs)
    runs = run_plan(plan)
    path = folder / f"bounds_{plan.hash[:12]}.pt"
    if not path.exists():
        _, spread = start_of(runs, plan.family)
        expected = dict(zip(START, spread.mean(0).tolist(), strict=True))
        rms = runs.response.std(-1, correction=0)
        bounds = {
            snr: cramer_rao(runs, [DAMPING_RATIO], rms * 10 ** (-snr / 20), expected=expected, solver=plan.solver)
            for snr in SNRS
        }
        found = {str(snr): bound.deviation(DAMPING_RATIO) for snr, bound in bounds.items()}
        folder.mkdir(parents=True, exist_ok=True)
        torch.save(found | {"regular": is_regular(runs, plan.solver)}, path)
    kept = torch.load(path, weights_only=True)
    return Bench(plan, runs, {snr: kept[str(snr)] for snr in SNRS}, kept["regular"])
