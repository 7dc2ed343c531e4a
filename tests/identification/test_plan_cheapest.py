"""The cheapest set of tests against trying every set one by one."""

from itertools import chain, combinations, combinations_with_replacement

import numpy as np
import pytest
import torch

from gear_damping.identification.test_plan import cheapest
from gear_damping.identification.test_plan.cheapest import Candidates, Judge, search
from gear_damping.identification.test_plan.information import QUANTILE

PER = (3.0, 1.5)  # cost of a speed, of a torque


def drawn(seed, count=7, choices=2):
    random = np.random.default_rng(seed)
    slopes = random.normal(size=(choices, count, 3, 3)) * random.uniform(0.2, 2, (choices, count, 1, 1))
    return Candidates(
        cost=torch.tensor(random.uniform(0.5, 2, count)),
        speed=torch.tensor(random.integers(0, 3, count)),
        torque=torch.tensor(random.integers(0, 5, count)),
        told=torch.tensor(slopes @ slopes.swapaxes(-1, -2)),
        prior=torch.diag(torch.tensor([0.0, 0.0, 0.2], dtype=torch.float64)),
        sensors=torch.tensor([0.0, 2.5][:choices], dtype=torch.float64),
    )


GRADIENTS = torch.tensor([[1.0, 0.3, 0.0], [0.0, 0.8, 0.0]], dtype=torch.float64)


def by_hand(own, sensors, tests):
    """Cost and excess of one set, by loops."""
    cost = float(own.sensors[sensors]) + sum(float(own.cost[test]) for test in tests)
    cost += PER[0] * len({int(own.speed[test]) for test in tests})
    cost += PER[1] * len({int(own.torque[test]) for test in tests})
    total = own.prior.numpy() + sum(own.told[sensors, test].numpy() for test in tests)
    covariance = np.linalg.inv(total)
    return cost, max(QUANTILE * np.sqrt(g @ covariance @ g) for g in GRADIENTS.numpy())


def every(own, most, repeats):
    count = range(len(own.cost))
    sets = chain(*(combinations_with_replacement(count, size) for size in range(1, most + 1)))
    sets = [one for one in sets if all(one.count(test) <= repeats for test in one)]
    return [(*by_hand(own, sensors, one), sensors, one) for sensors in range(len(own.sensors)) for one in sets]


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("repeats", [1, 2])
def test_it_is_the_cheapest_of_all(seed, repeats):
    own = drawn(seed)
    known = every(own, 3, repeats)
    wanted = float(np.median([excess for _, excess, *_ in known]))
    found = search(Judge(own, GRADIENTS / wanted, PER), 3, repeats)
    cost, excess, sensors, tests = min(one for one in known if one[1] <= wanted)
    assert found.exact_to == 3
    assert found.tried == len(known)
    assert found.cheapest.cost == pytest.approx(cost)
    assert (found.cheapest.sensors, found.cheapest.tests) == (sensors, tests)
    assert found.cheapest.excess == pytest.approx(excess / wanted)
    assert found.best.excess == pytest.approx(min(one[1] for one in known) / wanted)
    for one in found.front:  # nothing is cheaper and no worse
        assert not any(c < one.cost - 1e-9 and e <= one.excess * wanted for c, e, *_ in known)


def test_what_cannot_be_reached_is_none():
    found = search(Judge(drawn(1), GRADIENTS / 1e-6, PER), 2, 1)
    assert found.cheapest is None
    assert found.best.excess > 1


def test_many_tests_are_added_one_by_one(monkeypatch):
    own = drawn(2, count=8)
    whole = search(Judge(own, GRADIENTS, PER), 4, 1)
    monkeypatch.setattr(cheapest, "MOST_TRIED", 40)
    found = search(Judge(own, GRADIENTS, PER), 4, 1)
    assert (whole.exact_to, found.exact_to, found.most) == (4, 2, 4)
    assert found.tried < whole.tried
    assert whole.best.excess <= found.best.excess * (1 + 1e-9) < 1.2 * whole.best.excess
    assert len(found.best.tests) == 4


def test_sets_are_counted_rightly():
    assert len(list(cheapest._sets(5, 3, 1))) == len(list(combinations(range(5), 3)))
    assert list(cheapest._sets(2, 3, 2)) == [(0, 0, 1), (0, 1, 1)]
