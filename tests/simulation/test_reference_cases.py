"""Agreement with the event-located scipy reference, smooth and with impacts."""

import gear_reference
import numpy as np
import pytest
from cases import REFERENCE_CASES, SEPARATING, TIMES

UNSUPPORTED = {"load_noise", "many_effects"}  # drawn loads and sums of ripples have tests of their own
NAMES = [name for name in REFERENCE_CASES if name not in UNSUPPORTED]
_references = {}


def reference(name):
    if name not in _references:
        _references[name] = gear_reference.simulate(REFERENCE_CASES[name], TIMES)[0]
    return _references[name]


@pytest.mark.parametrize("name", NAMES)
def test_agrees_with_the_reference(run_case, name):
    expected = reference(name)
    found = run_case(REFERENCE_CASES[name], TIMES, substeps=8)
    limit = 1e-5 if name not in SEPARATING else 1e-4
    assert np.linalg.norm(found - expected) <= limit / 10 * np.linalg.norm(expected)


@pytest.mark.parametrize("name", ["bench_lanczos", "reversal_both_flanks"])
def test_the_slow_engine_agrees_too(run_case, name):
    times = TIMES[:120]
    expected = reference(name)[:120]
    found = run_case(REFERENCE_CASES[name], times, substeps=6, engine="eager")
    assert np.linalg.norm(found - expected) <= 1e-5 * np.linalg.norm(expected)


def test_default_accuracy_is_kept(run_case):
    """`accuracy` alone, without sub-steps, gives what it promises."""
    expected = reference("bench_lanczos")
    found = run_case(REFERENCE_CASES["bench_lanczos"], TIMES, substeps=None)
    assert np.linalg.norm(found - expected) <= 1e-5 * np.linalg.norm(expected)
