"""Records of two rigs are followed one by one; those of one rig, or of a law that no linear model follows, are not."""

import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp

from gear_damping.identification.oscillator.each_alone import MOST, each_alone, said_of_each
from gear_damping.identification.oscillator.fit import fit_oscillator
from gear_damping.identification.oscillator.linear_model import NOTHING
from gear_damping.identification.output_error.records import FitRecord, Observed

RATE = 60.0
TIME = np.arange(600) / RATE


def record(name, frequency, ratio=0.02, cubic=0.0, amplitude=1.0):
    """A decay by another integrator, with a little noise."""
    natural = 2 * np.pi * frequency
    found = solve_ivp(
        lambda t, y: [y[1], -2 * ratio * natural * y[1] - natural**2 * y[0] * (1 + cubic * y[0] ** 2)],
        (0, TIME[-1]), [amplitude, 0.0], t_eval=TIME, rtol=1e-9, atol=1e-10,
    )  # fmt: skip
    noise = np.random.default_rng(len(name)).normal(0, 0.005, TIME.size)
    return FitRecord(
        name, torch.as_tensor(found.y[0] + noise), RATE, {}, observed=Observed("displacement", offset=True)
    )


def alone(*records):
    """What is told of records, from what a fit of them all leaves."""
    found = fit_oscillator(records)
    return each_alone(records, sum(float(found.first_residual(one).square().sum()) for one in records), NOTHING)


def test_two_rigs_are_told_with_their_figures():
    found = alone(record("first", 2.4), record("other", 1.9, 0.03))
    assert [one.record for one in found] == ["first", "other"]
    assert [one.natural_frequency_hz.value for one in found] == pytest.approx([2.4, 1.9], rel=1e-3)
    assert [one.damping_ratio_percent.value for one in found] == pytest.approx([2, 3], rel=0.02)
    assert said_of_each(found) == "2.4 Hz and 2 % in first, 1.9 Hz and 3 % in other"


def test_two_dampings_are_told_too():
    found = alone(record("first", 2.4, 0.019), record("other", 2.4, 0.022))
    assert [one.damping_ratio_percent.value for one in found] == pytest.approx([1.9, 2.2], rel=0.02)


def test_one_rig_is_not():
    assert alone(record("first", 2.4), record("other", 2.4)) == ()


def test_a_law_that_each_record_misses_as_well_is_not():
    assert alone(record("first", 2.4, cubic=0.6), record("other", 2.4, cubic=0.6, amplitude=1.05)) == ()


def test_one_record_or_too_many_are_not():
    assert each_alone([record("first", 2.4)], 1e9, NOTHING) == ()
    assert each_alone([record("first", 2.4)] * (MOST + 1), 1e9, NOTHING) == ()
