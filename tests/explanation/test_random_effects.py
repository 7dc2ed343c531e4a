"""The standard deviation between groups against a simulation of it."""

from types import SimpleNamespace

import numpy as np
import pytest

from gear_damping.explanation.model import homogeneity
from gear_damping.explanation.statistics.random_effects import between_deviation, statistic


@pytest.mark.parametrize("deviation", [0.0, 0.1, 0.5])
def test_the_interval_covers_the_deviation_that_was_drawn(deviation):
    rng = np.random.default_rng(40)
    errors = np.array([0.05, 0.1, 0.2, 0.08, 0.12, 0.3])
    covered, found = 0, []
    for _ in range(400):
        estimates = 1 + deviation * rng.normal(size=6) + errors * rng.normal(size=6)
        one = between_deviation(estimates, errors)
        covered += one.interval95[0] <= deviation <= one.interval95[1]
        found.append(one.value)
    most = 1.0 if deviation == 0 else 0.98  # at the edge of what is possible half of the error is given away
    assert 0.92 <= covered / 400 <= most
    assert np.median(found) == pytest.approx(deviation, abs=0.08)


def test_q_without_a_deviation_is_that_of_cochran():
    estimates, errors = [1.0, 1.4, 0.7], [0.1, 0.2, 0.1]
    weights = 1 / np.square(errors)
    mean = np.average(estimates, weights=weights)
    assert statistic(estimates, errors, 0.0) == pytest.approx((weights * (np.array(estimates) - mean) ** 2).sum())


def test_estimates_that_agree_do_not_deviate():
    assert between_deviation([1.0, 1.01, 0.99], [0.1, 0.1, 0.1]).value == 0


@pytest.mark.parametrize("errors", [(1e-17, 0.1, 0.0), (0.0, 0.0, 0.0)])
def test_estimates_without_errors_differ_by_what_they_differ(errors):
    """The scores of a record that is one block cancel, and its error is none: a drive's answer ended in a crash."""
    found = between_deviation((1.0, 1.2, 0.8), errors)
    assert found.interval95[0] <= found.value <= found.interval95[1]
    assert found.value == pytest.approx(0.2, rel=0.1)


@pytest.mark.parametrize(("seconds", "samples"), [(0.01, 20), (1e6, 250), (1e-9, 4)])
def test_a_block_is_a_part_of_a_record_however_long_the_motion_remembers(seconds, samples, monkeypatch):
    monkeypatch.setattr(homogeneity, "time_scale", lambda *_: seconds)
    outcome = SimpleNamespace(hypothesis=None, problem=SimpleNamespace(response=SimpleNamespace(length=1000)))
    assert homogeneity.block_of(outcome, SimpleNamespace(sampling_rate=1000.0)) == samples
