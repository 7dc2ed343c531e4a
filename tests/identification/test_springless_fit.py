"""The nearest linear motor to one that dry friction holds at first, and that answers late."""

import numpy as np
import pytest
import torch

from gear_damping.identification.observation import Known
from gear_damping.identification.oscillator.fit import fit_oscillator
from gear_damping.identification.output_error.records import FitRecord, Observed
from gear_damping.identification.output_error.segments import Segments

RATE, SUBSTEPS = 200.0, 20
DAMPING, GAIN, DRY, LATE = 20.0, 180.0, 140.0, 18  # 1/s; rad/s^2 a volt; rad/s^2; samples


def speed(volts, seed):
    """By small Euler steps, the friction as a force that holds or slides."""
    asked, step, found = np.concatenate([np.zeros(LATE), volts])[: len(volts)], 1 / RATE / SUBSTEPS, [0.0]
    for one in asked[:-1]:
        now = found[-1]
        for _ in range(SUBSTEPS):
            push = GAIN * one - DAMPING * now
            if now or abs(push) > DRY:
                further = now + step * (push - DRY * np.sign(now or push))
                now = 0.0 if now * further < 0 else further
        found.append(now)
    return np.array(found) + 0.01 * np.random.default_rng(seed).standard_normal(len(volts))


@pytest.fixture(scope="module")
def records():
    """A step, and a slow ramp on which it stands for three quarters of a volt."""
    drives = {"step": np.full(1100, -7.0), "ramp": 0.25 * np.arange(2700) / RATE}
    return [
        FitRecord(
            name,
            torch.as_tensor(speed(volts, seed)),
            RATE,
            inputs={"force": torch.as_tensor(volts)},
            observed=Observed("velocity"),
        )
        for seed, (name, volts) in enumerate(drives.items())
    ]


def _moved(records, damping, gain, offset):
    """Squares left of a linear motor from rest, in steps of one sample, exactly."""
    decay, left = np.exp(-damping / RATE), 0.0
    for record in records:
        now, volts = 0.0, record.inputs["force"].numpy()
        for one, next_one, value in zip(volts[:-1], volts[1:], record.response.numpy()[1:], strict=True):
            now = decay * now + (1 - decay) / damping * (gain * (one + next_one) / 2 + offset)
            left += (value - now) ** 2
    return left


@pytest.mark.parametrize("seconds", [7.5, 100.0])
def test_a_stretch_in_which_nothing_moves_leads_to_no_motor_without_damping(records, seconds):
    known = Known({"stiffness": 0.0, "damping_coefficient": DAMPING, "force_gain": GAIN}, {})
    found = fit_oscillator(records, known=known, segments=Segments(seconds))
    given = found.given
    damping = given["viscous_damping.damping_coefficient"]
    left = float(sum(found.residuals[record.name].square().sum() for record in records))
    by_hand = [
        _moved(records, damping * factor, given["force_gain"] * factor, given["offset_force.force"] * factor)
        for factor in (0.8, 1.25)
    ]
    assert 5 < damping < 15
    assert left < min(by_hand)
