"""The cheapest set of tests that tells enough: by trying all sets where they are few, else test by test."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, combinations_with_replacement
from math import comb, inf

import numpy as np
import torch
from torch import Tensor

from gear_damping.identification.test_plan.information import half_intervals

MOST_TRIED = 200_000  # sets of one choice of sensors; a second or two
AT_ONCE = 20_000  # sets whose intervals are worked out together


@dataclass(frozen=True)
class Candidates:
    """What sets are made of.

    Args:
        cost: Of each test by itself, (tests,).
        speed: Number of the speed of each test, (tests,).
        torque: Number of the setting (speed and torque) of each test, (tests,).
        told: Information of each test on what is shared, by choice of sensors, (choices, tests, n, n).
        prior: Information beforehand, (n, n).
        sensors: Cost of each choice of sensors, (choices,).
    """

    cost: Tensor
    speed: Tensor
    torque: Tensor
    told: Tensor
    prior: Tensor
    sensors: Tensor


@dataclass(frozen=True)
class Found:
    """A set.

    Args:
        sensors: Number of the choice of sensors.
        tests: Numbers of the tests, one that is repeated more than once.
        cost: Of all.
        excess: The largest of its half intervals over the wanted ones; 1 or less reaches them.
    """

    sensors: int
    tests: tuple[int, ...]
    cost: float
    excess: float


@dataclass(frozen=True)
class Search:
    """What a search for the cheapest set found.

    Args:
        cheapest: The cheapest set that reaches what is wanted, or None.
        best: The set that comes nearest to it, or goes farthest beyond.
        front: Sets none of which is both dearer and worse than another, cheapest first.
        exact_to: Sets of up to so many tests were all tried.
        most: Tests of a set at most; beyond `exact_to` a test at a time was added.
        tried: How many sets.
    """

    cheapest: Found | None
    best: Found
    front: tuple[Found, ...]
    exact_to: int
    most: int
    tried: int


class Judge:
    """How far sets are from what is wanted.

    Args:
        candidates: What sets are made of.
        gradients: Of the wanted quantities over their wanted half intervals, (quantities, n).
        per: What each speed and each torque of a set costs.
    """

    def __init__(self, candidates: Candidates, gradients: Tensor, per: tuple[float, float]) -> None:
        self.candidates, self.gradients, self.per = candidates, gradients, per

    def cost(self, sensors: int, sets: Tensor) -> Tensor:
        """Of sets of one number of tests, (sets, tests) -> (sets,)."""
        own = self.candidates
        found = own.cost[sets].sum(-1) + own.sensors[sensors]
        for price, number in zip(self.per, (own.speed, own.torque), strict=True):
            ordered = number[sets].sort(-1).values
            found = found + price * (1 + (ordered.diff(dim=-1) != 0).sum(-1))
        return found

    def excess(self, sensors: int, sets: Tensor) -> Tensor:
        """Of the same, (sets,); infinite where a set tells nothing of what is wanted."""
        parts = []
        for some in sets.split(AT_ONCE):
            total = self.candidates.told[sensors][some].sum(1) + self.candidates.prior
            halves = torch.stack([half_intervals(total, gradient) for gradient in self.gradients])
            parts.append(halves.amax(0).nan_to_num(inf, inf))
        return torch.cat(parts)


def search(judge: Judge, most: int, repeats: int) -> Search:
    """The cheapest set of up to `most` tests, each made up to `repeats` times."""
    count, choices = len(judge.candidates.cost), len(judge.candidates.sensors)
    most = min(most, count * repeats)
    exact_to = max((size for size in range(1, most + 1) if _tried(count, size, repeats) <= MOST_TRIED), default=1)
    front, tried = _Front(), 0
    for sensors in range(choices):
        for size in range(1, exact_to + 1):
            sets = torch.tensor(list(_sets(count, size, repeats)))
            front.add(sensors, sets, judge.cost(sensors, sets), judge.excess(sensors, sets))
            tried += len(sets)
        if most > exact_to:
            tried += _one_by_one(judge, front, sensors, most, repeats)
    kept = front.kept()
    enough = [one for one in kept if one.excess <= 1]
    return Search(enough[0] if enough else None, kept[-1], tuple(kept), exact_to, most, tried)


def _tried(count: int, size: int, repeats: int) -> int:
    """Sets of up to so many tests, at most."""
    more = 0 if repeats == 1 else 1
    return sum(comb(count + more * (one - 1), one) for one in range(1, size + 1))


def _sets(count: int, size: int, repeats: int) -> Iterator[tuple[int, ...]]:
    if repeats == 1:
        return combinations(range(count), size)
    every = combinations_with_replacement(range(count), size)
    return (one for one in every if all(one.count(test) <= repeats for test in set(one)))


def _one_by_one(judge: Judge, front: "_Front", sensors: int, most: int, repeats: int) -> int:
    """Add to the best set of each size what helps most, by itself and for its price; how many sets were tried."""
    count, tried = len(judge.candidates.cost), 0
    for thrifty in (False, True):
        chosen: tuple[int, ...] = ()
        before = (0.0, inf)
        for _ in range(most):
            open_tests = [test for test in range(count) if chosen.count(test) < repeats]
            sets = torch.tensor([(*chosen, test) for test in open_tests])
            cost, excess = judge.cost(sensors, sets), judge.excess(sensors, sets)
            front.add(sensors, sets, cost, excess)
            tried += len(sets)
            gain = before[1] ** -2 if before[1] < inf else 0.0
            worth = (excess**-2 - gain) / (cost - before[0]).clamp(min=1e-12) if thrifty else -excess
            place = int(worth.argmax())
            chosen, before = tuple(sets[place].tolist()), (float(cost[place]), float(excess[place]))
    return tried


class _Front:
    """Sets of which none is both dearer and worse than another."""

    def __init__(self) -> None:
        self.found: list[Found] = []

    def add(self, sensors: int, sets: Tensor, cost: Tensor, excess: Tensor) -> None:
        """Of several sets those that belong to it."""
        if not len(sets):
            return
        order = torch.from_numpy(np.lexsort((excess.numpy(), cost.numpy())))
        lowest = excess[order].cummin(0).values
        is_new = torch.cat([torch.ones(1, dtype=torch.bool), lowest[1:] < lowest[:-1]])
        for place in order[is_new].tolist():
            one = tuple(sorted(sets[place].tolist()))
            self.found.append(Found(sensors, one, float(cost[place]), float(excess[place])))

    def kept(self) -> list[Found]:
        """The front, cheapest first."""
        kept: list[Found] = []
        for one in sorted(self.found, key=lambda one: (one.cost, one.excess, len(one.tests), one.tests)):
            if not kept or one.excess < kept[-1].excess:
                kept.append(one)
        return kept
