"""A recorder that leaves out samples while its stamps go on: the place leaps ahead, the way it moves."""

import numpy as np
import pytest

from gear_damping.measurement.lost_samples import lost_samples
from gear_damping.measurement.record import Channel

RATE = 1000.0


def swing(kept, noise=0.0, unit=1.0):
    """A free swing of 1.3 rad at 1.7 Hz, sampled at the instants of `kept` in samples."""
    time = kept / RATE
    values = 1.3 * np.exp(-0.06 * time) * np.cos(2 * np.pi * 1.7 * time)
    return unit * (values + noise * np.random.default_rng(5).normal(size=time.size))


def lacking(every, lost, total=6000):
    """Instants of samples of which so many are left out in every so many."""
    places = np.arange(total)
    return places[places % every >= lost]


def found(values, name="displacement", time=None):
    time = np.arange(len(values)) / RATE if time is None else time
    return lost_samples(Channel(name, values, "rad", "rad"), time)


@pytest.mark.parametrize("noise", [0.0, 5e-4, 2e-3])
@pytest.mark.parametrize("unit", [1.0, -180 / np.pi])
def test_samples_that_are_lost_in_a_comb_are_a_data_problem(noise, unit):
    said = found(swing(lacking(245, 13), noise, unit))
    assert said.kind == "lost_samples"
    assert said.severity == "data_problem"
    assert "as much as it does in 13 samples" in said.message
    share = float(said.message.partition("some ")[2].partition(" %")[0])
    assert share == pytest.approx(100 * 13 / 232, abs=2)


def test_few_lost_ones_are_a_note():
    assert found(swing(lacking(250, 3), 1e-4)).severity == "note"


@pytest.mark.parametrize("noise", [0.0, 1e-3, 2e-2])
def test_what_lost_nothing_is_left_alone(noise):
    assert found(swing(np.arange(6000), noise)) is None


def test_gaps_that_the_stamps_tell_are_no_loss_between_even_ones():
    kept = lacking(245, 13)
    assert found(swing(kept), time=kept / RATE) is None


def test_shocks_and_counts_that_are_lost_lead_to_either_side():
    values, shocks = swing(np.arange(6000), 1e-4), np.zeros(6000)
    shocks[100::245] = 0.1 * np.random.default_rng(2).choice([-1, 1], size=len(shocks[100::245]))
    assert found(values + np.cumsum(shocks)) is None


def test_a_speed_that_a_shock_breaks_is_not_asked():
    assert found(swing(lacking(245, 13)), "velocity") is None


@pytest.mark.parametrize("step", [0.002, 0.02])
def test_steps_of_a_converter_are_none(step):
    assert found(np.round(swing(np.arange(6000)) / step) * step) is None
