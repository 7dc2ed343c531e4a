"""A tap with a hammer, that has rung out long before its record ends, is fitted at its own frequency."""

import math

import numpy as np
import pytest
import torch
from scipy.signal import lsim

from gear_damping.identification.oscillator.first_frequency import first_frequency
from gear_damping.identification.oscillator.fit import fit_oscillator
from gear_damping.identification.output_error.records import FitRecord, Observed

RATE, OMEGA, RATIO = 51200.0, 2 * math.pi * 1069.0, 0.04


def tap(samples):
    """Acceleration beside a second mode that the fit does not know, and the force."""
    time = np.arange(samples) / RATE
    force = np.where((time > 0.004) & (time < 0.0043), np.sin(np.pi * (time - 0.004) / 0.0003), 0.0)
    found = np.zeros(samples)
    for omega, ratio, gain in ((OMEGA, RATIO, 2.3), (2.36 * OMEGA, 0.03, 0.5)):
        matrix = np.array([[0, 1], [-(omega**2), -2 * ratio * omega]])
        system = matrix, np.array([[0], [gain]]), matrix[1:], np.array([[gain]])
        found = found + lsim(system, force, time)[1]
    found = found + 1e-3 * found.std() * np.random.default_rng(1).normal(size=samples)
    inputs = {"force": torch.as_tensor(force)}
    return FitRecord("tap", torch.as_tensor(found), RATE, inputs, observed=Observed("acceleration", offset=True))


@pytest.mark.parametrize("samples", [2048, 16384])
def test_its_frequency_and_damping_are_found(samples):
    fit = fit_oscillator([tap(samples)])
    assert fit.natural_frequency_hz.value == pytest.approx(1069.0, rel=0.02)
    assert fit.damping_ratio_percent.value == pytest.approx(4.0, rel=0.25)


def test_the_first_guess_looks_at_the_motion_and_not_at_the_rest():
    assert first_frequency(tap(16384), driven=False) == pytest.approx(1069.0, rel=0.05)
