"""Runs of a family whose equation is known: what is known of them, and their response to what is not."""

from dataclasses import dataclass, replace

import torch
from torch import Tensor

from gear_damping.simulation.driven import Driven
from gear_damping.simulation.prior import DAMPING_RATIO, Prior, coefficients_for
from gear_damping.simulation.runs import Runs
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

START = ("initial_displacement", "initial_velocity")


@dataclass(frozen=True, eq=False)
class KnownRuns:
    """Records of runs of which all is known but the damping ratio and the start.

    Args:
        runs: As simulated; their damping and start are not looked at.
        law: The effect that carries the damping ratio.
        range_percent: Smallest and largest damping ratio, between which any is as likely as another.
        centre: Displacement and velocity at the start that are expected, (runs, 2).
        deviation: Their standard deviations, (runs, 2).
        records: Noisy responses, (runs, time).
        noise: Standard deviation of the noise, (runs,).
        solver: Settings of the solver.
    """

    runs: Runs
    law: str
    range_percent: tuple[float, float]
    centre: Tensor
    deviation: Tensor
    records: Tensor
    noise: Tensor
    solver: Solver

    def __len__(self) -> int:
        return len(self.records)

    def pick(self, chosen: Tensor) -> "KnownRuns":
        """Those of the runs that a mask (runs,) or numbers of runs name."""
        names = ("centre", "deviation", "records", "noise")
        return replace(self, runs=self.runs.keep(chosen), **{name: getattr(self, name)[chosen] for name in names})

    @property
    def units(self) -> Tensor:
        """What displacement and velocity are counted in, (runs, 2): the deviation of the start, or of the motion."""
        usual = torch.stack([self.records.std(-1), self.runs.reference_velocity], -1)
        return torch.where(self.deviation > 0, self.deviation, usual)

    def values(self, ratio: Tensor, start: Tensor, repeat: int = 1, units: Tensor | None = None) -> dict[str, Tensor]:
        """Parameters of the runs, one block of all runs after another.

        Args:
            ratio: Damping ratio in %, (repeat * runs,).
            start: Displacement and velocity at the start about the centre, (repeat * runs, 2).
            repeat: Blocks.
            units: What these are counted in, (runs, 2); standard deviations of the start where absent.
        """
        found = {name: _repeated(value, repeat) for name, value in self.runs.values.items()}
        velocity = self.runs.reference_velocity.repeat(repeat)
        found |= coefficients_for(self.runs.model, found, self.law, ratio / 100, velocity)
        places = self.centre.repeat(repeat, 1) + start * (self.deviation if units is None else units).repeat(repeat, 1)
        return found | dict(zip(START, places.unbind(-1), strict=True))

    def response(self, ratio: Tensor, start: Tensor, samples: int) -> Tensor:
        """Response to blocks of damping ratios (blocks, runs) and starts (blocks, runs, 2): (blocks, runs, samples)."""
        values = self.values(ratio.reshape(-1), start.reshape(-1, 2), len(ratio))
        return self.simulated(values, samples).response.reshape(len(ratio), len(self), samples)

    def from_there(self, ratio: Tensor, states: Tensor, first: int, samples: int) -> tuple[Tensor, Tensor]:
        """Response from a later sample on, and the state behind it.

        Args:
            ratio: Damping ratio in %, (blocks, runs).
            states: Displacement and velocity at sample `first` about the centre, in `units`, (blocks, runs, 2).
            first: The sample.
            samples: How many of the response.

        Returns:
            The response, (blocks, runs, samples), and the state at the sample after it, or at the last one of the
            record, (blocks, runs, 2).
        """
        blocks = len(ratio)
        values = self.values(ratio.reshape(-1), states.reshape(-1, 2), blocks, self.units)
        seconds = torch.full((blocks * len(self),), first / self.runs.sampling_rate, dtype=torch.float64)
        values |= self.runs.model.system.begun_later(values, seconds)
        found = self.simulated(values, min(samples + 1, self.records.shape[1] - first), first)
        last = torch.stack([found.states[name][:, -1] for name in ("displacement", "velocity")], -1)
        end = (last - self.centre.repeat(blocks, 1)) / self.units.repeat(blocks, 1)
        return found.response.reshape(blocks, len(self), -1)[..., :samples], end.reshape(blocks, len(self), 2)

    def simulated(self, values: dict[str, Tensor], samples: int, first: int = 0) -> Runs:
        """Blocks of all runs with these parameters, (blocks * runs,), from sample `first` of their inputs on."""
        blocks = len(values[START[0]]) // len(self)
        part = slice(first, first + samples)
        inputs = {name: series[:, part].repeat(blocks, 1) for name, series in self.runs.inputs.items()}
        return simulate(
            self.runs.model,
            values,
            sampling_rate=self.runs.sampling_rate,
            n_samples=samples,
            inputs=Driven(inputs),
            solver=replace(self.solver, progress=None),
        )


def start_of(runs: Runs, prior: Prior) -> tuple[Tensor, Tensor]:
    """Centre and standard deviation of the start of runs of a family, (runs, 2) each; both 0 of one at rest."""
    static = runs.derived["mean_load"] / runs.derived["mean_stiffness"]
    if prior.start != "static":
        zero = torch.zeros(len(static), 2, dtype=torch.float64)
        return zero, zero
    centre = torch.stack([static, torch.zeros_like(static)], -1)
    return centre, prior.perturbation * torch.stack([static.abs(), runs.reference_velocity], -1)


def range_of(prior: Prior) -> tuple[float, float]:
    """Smallest and largest damping ratio of a family, %."""
    ends = prior.distributions[DAMPING_RATIO]
    return ends.low, ends.high


def _repeated(value: Tensor, count: int) -> Tensor:
    return value.repeat(count) if value.ndim == 1 else value.repeat(1, count)
