"""Maximum likelihood for many simulated sets of tests at once, by damped Gauss-Newton steps from the truth."""

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

from gear_damping.identification.test_plan.information import inverse
from gear_damping.identification.test_plan.slopes import Recorder, slopes
from gear_damping.identification.test_plan.starts import InitialState
from gear_damping.simulation.solver_settings import Solver

MOST_STEPS = 40  # of a fit; one that is not at rest by then is lost
CONVERGED_BELOW = 1e-6  # squared length of a step in standard errors: a thousandth of one
SHORTER = 0.3  # share of a step that is tried after one that led uphill


@dataclass(frozen=True)
class SharedFit:
    """What tests share.

    Args:
        names: What is fitted; in its scale, the coefficient by its logarithm, so that it stays positive.
        coefficient: Which of them is that of the damping law.
        prior: Precision beforehand, (shared,).
    """

    names: tuple[str, ...]
    coefficient: str
    prior: Tensor

    def moved(self, name: str, value: Tensor, scale: Tensor, by: Tensor) -> Tensor:
        """The value of a shared or an own parameter at a coordinate."""
        return value * torch.exp(by) if name == self.coefficient else value + scale * by


@dataclass(frozen=True)
class TestFit:
    """One test of a set.

    Args:
        recorder: How it is recorded.
        start: Where its record begins, one member.
        scales: Of what is fitted: shared ones, then its own, (1,).
        solver: With one number of sub-steps.
        noise: Standard deviation of each channel, (channels,).
        offsets: Channels whose zero is unknown.
        prior: Precision of its own unknowns beforehand, offsets last, (own,).
    """

    recorder: Recorder
    start: InitialState
    scales: Mapping[str, Tensor]
    solver: Solver
    noise: Tensor
    offsets: tuple[int, ...]
    prior: Tensor

    @property
    def own(self) -> int:
        """How many unknowns are its own."""
        return len(self.prior)

    def predicted(self, shared: SharedFit, at: Tensor) -> tuple[Tensor, Tensor]:
        """Whitened records and slopes at (fits, unknowns): (fits, channels, time), (fits, unknowns, channels, time)."""
        count = len(at)
        values = {name: value.expand(*value.shape[:-1], count).clone() for name, value in self.start.values.items()}
        initial_perturbations = {
            name: value.expand(count).clone() for name, value in self.start.initial_perturbations.items()
        }
        scales = {}
        for place, (name, scale) in enumerate(self.scales.items()):
            where = initial_perturbations if name in initial_perturbations else values
            where[name] = shared.moved(name, where[name], scale, at[:, place])
            scales[name] = where[name] if name == shared.coefficient else scale.expand(count)
        begin = InitialState(values, initial_perturbations, torch.ones(count, dtype=torch.bool))
        both = slopes(self.recorder, begin, scales, self.solver)
        records, found = both.records, both.by
        level = self.noise[:, None, None]
        records, found = (records / level).transpose(0, 1), (found / level[..., None]).permute(1, 2, 0, 3)
        zeros = found.new_zeros(count, len(self.offsets), *found.shape[2:])
        for place, channel in enumerate(self.offsets):
            zeros[:, place, channel] = 1.0
            records[:, channel] += at[:, len(self.scales) + place, None]
        return records, torch.cat([found, zeros], 1)


@dataclass(frozen=True)
class _Data:
    """Whitened records of each test, (fits, channels, time), and what was known beforehand, (fits, unknowns)."""

    records: list[Tensor]
    shared: Tensor
    own: list[Tensor]

    def pick(self, mask: Tensor) -> "_Data":
        return _Data([one[mask] for one in self.records], self.shared[mask], [one[mask] for one in self.own])


def fitted(shared: SharedFit, tests: list[TestFit], count: int, generator: torch.Generator) -> tuple[Tensor, Tensor]:
    """Draw data and fit them.

    Returns:
        The shared coordinates, (count, shared), and which fits converged, (count,).
    """
    data = _drawn(shared, tests, count, generator)
    best = torch.zeros(count, len(shared.names) + sum(test.own for test in tests), dtype=torch.float64)
    cost, step = torch.full((count,), torch.inf, dtype=torch.float64), torch.zeros_like(best)
    converged, tried = torch.zeros(count, dtype=torch.bool), best.clone()
    for _ in range(MOST_STEPS):
        active = (~converged).nonzero()[:, 0]
        if not len(active):
            break
        found, fresh, length = _system(shared, tests, data.pick(active), tried[active])
        better = found < cost[active]
        good = active[better]
        best[good], cost[good], step[good] = tried[good], found[better], fresh[better]
        converged[good] = length[better] < CONVERGED_BELOW
        bad = active[~better]
        step[bad] = SHORTER * step[bad]
        converged[bad] |= (step[bad].abs().amax(-1) < CONVERGED_BELOW) & cost[bad].isfinite()
        tried = best + step
    return best[:, : len(shared.names)], converged


def _drawn(shared: SharedFit, tests: list[TestFit], count: int, generator: torch.Generator) -> _Data:
    def normal(*shape: int) -> Tensor:
        return torch.randn(shape, generator=generator, dtype=torch.float64)

    def known(precision: Tensor) -> Tensor:
        return normal(count, len(precision)) * torch.where(precision > 0, precision, torch.inf) ** -0.5

    records = []
    for test in tests:
        clean = test.predicted(shared, torch.zeros(1, len(test.scales) + len(test.offsets), dtype=torch.float64))[0]
        records.append(clean + normal(count, *clean.shape[1:]))
    return _Data(records, known(shared.prior), [known(test.prior) for test in tests])


def _system(shared: SharedFit, tests: list[TestFit], data: _Data, at: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Cost, Gauss-Newton step and its squared length in standard errors of each fit at its point."""
    n = len(shared.names)
    parts = at.split([n, *(test.own for test in tests)], -1)
    away = parts[0] - data.shared
    cost = (away.square() * shared.prior).sum(-1)
    whole = torch.diag(shared.prior).expand(len(at), n, n)
    pull = -away * shared.prior
    blocks = []
    for test, own, known, seen in zip(tests, parts[1:], data.own, data.records, strict=True):
        records, found = test.predicted(shared, torch.cat([parts[0], own], -1))
        found, left = found.flatten(2), (seen - records).flatten(1)
        off = own - known
        cost = cost + left.square().sum(-1) + (off.square() * test.prior).sum(-1)
        matrix, right = found @ found.mT, (found @ left.unsqueeze(-1)).squeeze(-1)
        inner = inverse(matrix[:, n:, n:] + torch.diag(test.prior))
        across, own_right = matrix[:, :n, n:], right[:, n:] - off * test.prior
        whole = whole + matrix[:, :n, :n] - across @ inner @ across.mT
        pull = pull + right[:, :n] - (across @ inner @ own_right.unsqueeze(-1)).squeeze(-1)
        blocks.append((inner, across, own_right))
    return cost.nan_to_num(torch.inf), *_solved(whole, pull, blocks)


def _solved(whole: Tensor, pull: Tensor, blocks: list[tuple[Tensor, Tensor, Tensor]]) -> tuple[Tensor, Tensor]:
    """Steps of all unknowns, and their squared lengths."""
    whole, pull = whole.nan_to_num(0.0), pull.nan_to_num(0.0)
    step = (inverse(whole) @ pull.unsqueeze(-1)).squeeze(-1)
    length, steps = (step * pull).sum(-1), [step]
    for inner, across, own_right in blocks:
        inner, across, own_right = (one.nan_to_num(0.0) for one in (inner, across, own_right))
        own = (inner @ (own_right - (across.mT @ step.unsqueeze(-1)).squeeze(-1)).unsqueeze(-1)).squeeze(-1)
        length = length + (own_right * (inner @ own_right.unsqueeze(-1)).squeeze(-1)).sum(-1)
        steps.append(own)
    return torch.cat(steps, -1), length
