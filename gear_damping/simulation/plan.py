"""A plan of runs: everything that decides what a data set holds, and its cache on disk."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cache
from pathlib import Path

import torch

from gear_damping.errors import InputError, Problem
from gear_damping.physics.model import Model
from gear_damping.simulation.cache import load_runs, save_runs
from gear_damping.simulation.driven import Driven
from gear_damping.simulation.prior import Label, Prior, draw_values
from gear_damping.simulation.runs import Runs
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Progress, Solver

SOURCES = Path(__file__).resolve().parents[1]
PARTS = ("physics/**/*.py", "simulation/**/*.py", "simulation/native/*.cpp", "simulation/native/*.h")  # make the runs


@dataclass(frozen=True)
class SimulationPlan:
    """A data set of simulated runs, before it exists.

    Args:
        model: Base system and effects.
        given: Nominal values that differ from the defaults, SI by flat name.
        prior: What varies from run to run.
        n_runs: How many runs.
        sampling_rate: Output samples per second.
        n_samples: Samples of each run.
        seed: Seed of everything drawn.
        damping_law: The effect that carries the damping ratio.
        damping_ratio_percent: The same ratio for every run; None: drawn.
        solver: Settings of the solver.
        plugins: The user's own effect files; their content counts in the manifest.
        diverged_share: Above this share of diverged runs the data set is refused.
    """

    model: Model
    given: Mapping[str, float]
    prior: Prior
    n_runs: int
    sampling_rate: float
    n_samples: int
    seed: int
    damping_law: str | None = None
    damping_ratio_percent: float | None = None
    solver: Solver = field(default_factory=Solver)
    plugins: Sequence[str] = ()
    diverged_share: float = 0.05

    def describe(self) -> dict:
        """Everything that decides the result, as plain JSON types."""
        parts = [self.model.system, *self.model.effects]
        return {
            "model": {part.name: dict(part.chosen) for part in parts},
            "given": {k: list(v) if isinstance(v, Sequence) else v for k, v in sorted(self.given.items())},
            "family": _as_family(self.prior),
            "n_runs": self.n_runs,
            "sampling_rate": self.sampling_rate,
            "n_samples": self.n_samples,
            "seed": self.seed,
            "damping_law": self.damping_law,
            "damping_ratio_percent": self.damping_ratio_percent,
            "solver": {"accuracy": self.solver.accuracy, "substeps": self.solver.substeps},
            "sources": _digest([path for part in PARTS for path in SOURCES.glob(part)]),
            "plugins": _digest([Path(path) for path in self.plugins]),
        }

    @property
    def hash(self) -> str:
        """SHA-256 of `describe()`."""
        return hashlib.sha256(json.dumps(self.describe(), sort_keys=True).encode()).hexdigest()


def run_plan(plan: SimulationPlan, *, folder: Path | None = None, progress: Progress | None = None) -> Runs:
    """The runs of a plan, simulated or read from `folder`, where the same plan left them before.

    Diverged runs are left out and counted in `n_diverged`.

    Raises:
        InputError: more runs diverged than the plan allows.
    """
    generator = torch.Generator().manual_seed(plan.seed)
    label = Label(plan.damping_law, plan.damping_ratio_percent)
    values, velocity = draw_values(plan.model, plan.given, plan.prior, plan.n_runs, generator, label)
    runs = load_runs(folder, plan.hash, plan.model, values) if folder else None
    if runs is None:
        runs = simulate(
            plan.model,
            values,
            sampling_rate=plan.sampling_rate,
            n_samples=plan.n_samples,
            inputs=Driven(seed=plan.seed + 1),
            solver=replace(plan.solver, progress=progress),
        )
        if folder:
            save_runs(folder, plan.hash, plan.describe(), runs)
    _refuse_divergence(plan, runs)
    return replace(runs, reference_velocity=velocity).keep(runs.good)


def _as_family(prior: Prior) -> dict:
    """The prior in the words of the configuration."""
    plain = asdict(prior)
    return {"spreads" if key == "distributions" else key: value for key, value in plain.items()}


def _refuse_divergence(plan: SimulationPlan, runs: Runs) -> None:
    share = runs.n_diverged / plan.n_runs
    if share > plan.diverged_share:
        which = ", ".join(str(int(i)) for i in (~runs.good).nonzero()[:10, 0])
        rule = f"{runs.n_diverged} of {plan.n_runs} runs diverged (members {which} …)"
        rule += f", allowed are {plan.diverged_share:.0%}"
        remedy = "bring the parameters back into a stable range, or set simulator.solver.accuracy=1e-6"
        raise InputError(Problem("simulator", rule, remedy=remedy))


@cache
def _digest_of(path: Path, changed: int) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _digest(paths: Sequence[Path]) -> str:
    """One digest of the content of several files."""
    found = [f"{path.name}:{_digest_of(path, path.stat().st_mtime_ns)}" for path in sorted(paths)]
    return hashlib.sha256("\n".join(found).encode()).hexdigest()[:16]
