"""A pendulum without a spring: frequency of small swings, period of wide ones, damping ratio, natural units."""

import numpy as np
import pytest
import torch
from scipy.special import ellipk

from gear_damping.physics.effects.coulomb_friction import CoulombFriction
from gear_damping.physics.effects.hysteretic_damping import HystereticDamping
from gear_damping.physics.effects.sine_restoring import SineRestoring
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.simulate import simulate

STIFFNESS = 64.2  # g / l in 1/s^2
GIVEN = {"stiffness": 0.0, "sine_restoring.stiffness": STIFFNESS, "viscous_damping.damping_coefficient": 0.0}


def pendulum(*effects, length=1.0, **given):
    model = Model(Oscillator(), (SineRestoring(), ViscousDamping(), *effects))
    return model, model.values(1, **(GIVEN | {"sine_restoring.length": length} | given))


def swung(amplitude, length=1.0, seconds=6.0, **given):
    model, values = pendulum(length=length, initial_displacement=amplitude, amplitude=amplitude, **given)
    return simulate(model, values, sampling_rate=500.0, n_samples=round(500 * seconds))


def period(response):
    """From the first to the last fall through zero."""
    x = response[0].numpy()
    falls = np.nonzero((x[:-1] > 0) & (x[1:] <= 0))[0]
    times = falls + x[falls] / (x[falls] - x[falls + 1])
    return (times[-1] - times[0]) / (len(times) - 1) / 500.0


def test_the_natural_frequency_is_that_of_small_swings():
    model, values = pendulum()
    derived = model.prepare(values).derived
    assert derived["mean_stiffness"].item() == pytest.approx(STIFFNESS)
    assert derived["natural_frequency"].item() == pytest.approx(STIFFNESS**0.5)
    assert period(swung(1e-3).response) == pytest.approx(2 * np.pi / STIFFNESS**0.5, rel=1e-4)


@pytest.mark.parametrize(("length", "unit"), [(1.0, 1.0), (180 / np.pi, 180 / np.pi)])
def test_wide_swings_take_longer(length, unit):
    wanted = 4 / STIFFNESS**0.5 * ellipk(np.sin(2.5 / 2) ** 2)
    assert period(swung(2.5 * unit, length).response) == pytest.approx(wanted, rel=1e-4)


def test_beside_a_spring_both_count_once():
    model, values = pendulum(stiffness=35.8)
    prepared = model.prepare(values)
    rate = prepared.terms["sine_restoring"]["fastest_rate"] / prepared.scales.time
    assert prepared.derived["natural_frequency"].item() == pytest.approx(10.0)
    assert rate.item() == pytest.approx(10.0)
    runs = swung(1e-3, stiffness=35.8)
    assert period(runs.response) == pytest.approx(2 * np.pi / 10.0, rel=1e-4)


def test_its_damping_ratio_is_that_of_small_swings():
    coefficient = 2 * 0.02 * STIFFNESS**0.5
    runs = swung(1e-2, **{"viscous_damping.damping_coefficient": coefficient})
    assert runs.damping_ratio_percent.item() == pytest.approx(2.0)
    x = runs.response[0].numpy()
    peaks = x[1:-1][(x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:])]
    decrement = np.log(peaks[0] / peaks[4]) / 4
    assert decrement == pytest.approx(2 * np.pi * 0.02 / np.sqrt(1 - 0.02**2), rel=1e-2)


def test_friction_and_hysteresis_beside_it_have_its_scales():
    model, values = pendulum(CoulombFriction(), HystereticDamping(), amplitude=0.5)
    prepared = model.prepare(values)
    assert prepared.scales.velocity.item() == pytest.approx(0.5 * STIFFNESS**0.5)
    share = torch.tensor([0.02], dtype=torch.float64)
    torch.testing.assert_close(prepared.terms["hysteretic_damping"]["stiffness"], share)


def test_a_stated_unit_of_time_stays():
    model, values = pendulum(amplitude=0.5, characteristic_time=1.0)
    prepared = model.prepare(values)
    assert prepared.scales.time.item() == 1.0
    assert prepared.derived["natural_frequency"].item() == pytest.approx(STIFFNESS**0.5)
    runs = swung(1e-3, characteristic_time=1.0)
    assert period(runs.response) == pytest.approx(2 * np.pi / STIFFNESS**0.5, rel=1e-4)
    assert runs.reference_velocity.item() == pytest.approx(1e-3 * STIFFNESS**0.5)
