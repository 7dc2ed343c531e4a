"""The reference cases: what they promise, and two more integrators."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from cases import REFERENCE_CASES, SEPARATING, TIMES
from gear_reference import simulate, trajectory


@cache
def reference(name):
    return trajectory(REFERENCE_CASES[name], TIMES)


@pytest.mark.parametrize("name", REFERENCE_CASES)
def test_loses_contact_as_promised(name):
    kinds = {kind for _, kind in reference(name).switches}
    assert ("leaves drive flank" in kinds) == (name in SEPARATING)
    assert ("meets coast flank" in kinds) == name.startswith("reversal")


QUICK = ("bench_loose_start", "resonance_third", "light_load", "reversal_held_gear")
SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in SEPARATING if name not in QUICK]


@pytest.mark.parametrize("name", [*QUICK, *SLOW])
def test_is_not_chaotic(name):
    case = REFERENCE_CASES[name]
    size = case.static_deflection
    moved = replace(case, x0=case.x0 + 1e-10 * size, v0=case.v0 + 1e-10 * size * case.natural_frequency)
    difference = np.abs(simulate(moved, TIMES)[0] - reference(name).x)
    assert 0.0 < difference.max() < 3e-8 * size


def test_reversal_ends_on_the_coast_flank():
    case = REFERENCE_CASES["reversal_both_flanks"]
    x = reference("reversal_both_flanks").x
    assert x[-80:].mean() == pytest.approx(-case.gap - case.static_deflection, rel=0.02)


@pytest.mark.parametrize(
    ("name", "method", "end"),
    [
        ("bench_rest", "Radau", 3.5e-4),
        ("many_effects", "Radau", 3e-4),
        ("bench", "LSODA", 2e-3),
        ("rectangular_loose_start", "LSODA", 2e-3),
        ("light_load", "LSODA", 2e-3),
        ("reversal_both_flanks", "LSODA", 3e-3),
    ],
)
def test_a_second_integrator_agrees(name, method, end):
    case, times = REFERENCE_CASES[name], TIMES[end >= TIMES]
    first, second = trajectory(case, times), trajectory(case, times, method=method)
    assert len(second.switches) == len(first.switches) > 0
    for a, b in ((first.x, second.x), (first.v, second.v)):
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-9 * np.abs(a).max())
