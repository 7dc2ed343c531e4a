"""Order analysis of a casing on signals whose answer is known in closed form."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import kstest

from gear_damping.explanation.casing import findings, orders
from gear_damping.explanation.casing.averages import by_revolution
from gear_damping.explanation.casing.cycles import patterns, series
from gear_damping.explanation.casing.heard import Heard
from gear_damping.explanation.casing.localised import localised
from gear_damping.explanation.casing.shafts import one_tooth, presence
from gear_damping.explanation.statistics.bursts import kurtosis

RATE, SPEED = 20e3, 25.0  # Hz, turns/s


def turns_of_a_shaft(seconds=1.5, fluctuation=0.02):
    time = np.arange(int(seconds * RATE)) / RATE
    return time, SPEED * (time + fluctuation / (2 * np.pi * 1.3) * np.sin(2 * np.pi * 1.3 * time)) + 0.3


def heard(values, turn, teeth=(20, 43)):
    return Heard("run", None, values, "m/s^2", RATE, turn, teeth)


def pulse(cycle, tooth, teeth, width=0.3):
    """A smooth bump at one tooth of `teeth`, for places in mesh cycles."""
    away = np.mod(cycle - tooth - 0.5 + teeth / 2, teeth) - teeth / 2
    return np.exp(-((away / width) ** 2)) * np.cos(2 * np.pi * 3 * away)


def test_a_tone_at_an_order_keeps_its_line_while_the_speed_varies():
    _time, turn = turns_of_a_shaft()
    values = 3 * np.cos(2 * np.pi * 33.5 * turn + 1)
    places, amplitude = orders.spectrum(heard(values, turn))
    at = int(amplitude.argmax())
    assert places[at] == pytest.approx(33.5, abs=0.03)
    assert amplitude[at] == pytest.approx(3, rel=0.2)  # half a line off: a Hann window loses up to 15 %
    assert np.abs(np.fft.rfft(values * np.hanning(len(values)))).max() * 4 / len(values) < 1  # over time it is smeared


def test_named_lines_have_the_amplitudes_of_carrier_and_sidebands():
    _time, turn = turns_of_a_shaft()
    values = 5 * (1 + 0.2 * np.cos(2 * np.pi * turn)) * np.cos(2 * np.pi * 20 * turn)
    one = heard(values, turn)
    found = {line.what: line.amplitude for line in orders.lines(one, *orders.spectrum(one))}
    assert found["mesh 1"] == pytest.approx(5, rel=0.03)
    assert found["mesh 1 + pinion"] == pytest.approx(0.5, rel=0.05)
    assert found["mesh 1 - pinion"] == pytest.approx(0.5, rel=0.05)
    assert found["mesh 1 + gear"] < 0.05
    assert found["mesh 2"] < 0.01


def test_the_patterns_of_two_shafts_are_told_apart_in_few_turns():
    rng = np.random.default_rng(0)
    _time, turn = turns_of_a_shaft(seconds=0.5, fluctuation=0.0)
    pinion, gear = rng.normal(size=20), rng.normal(size=43)
    cycle = np.floor(turn * 20).astype(int)
    values = 4 * np.cos(2 * np.pi * 20 * turn) + pinion[cycle % 20] + gear[cycle % 43]
    found = patterns(heard(values, turn), whiten=False)
    middle = found.cut.shape[1] // 2
    for shaft, true in (("pinion", pinion), ("gear", gear)):
        got = series(found.shaft(shaft), len(true), 3)[:, middle]
        lines = np.fft.rfft(true)
        lines[:3] = 0  # runout is what the slow part may take
        assert np.corrcoef(got, np.fft.irfft(lines, len(true)))[0, 1] > 0.99


def test_kurtosis_of_a_train_of_bursts():
    values = np.zeros(1000)
    values[::100] = 1.0
    share = 0.01  # of samples that are 1: the fourth central moment over the square of the second
    expected = (share * (1 - share) ** 4 + (1 - share) * share**4) / (share * (1 - share)) ** 2
    assert kurtosis(values) == pytest.approx(expected, rel=1e-9)
    assert kurtosis(np.cos(2 * np.pi * np.arange(1000) / 50)) == pytest.approx(1.5)
    assert kurtosis(np.zeros(5)) == 3


def test_kurtosis_by_revolution_shows_the_turns_with_a_burst():
    _time, turn = turns_of_a_shaft()
    values = 0.1 * np.random.default_rng(1).normal(size=len(turn))
    values += 2 * pulse(turn * 20, 205, 10_000)  # once in the record, in the tenth turn
    found, limit = by_revolution(patterns(heard(values, turn), whiten=False))
    assert int(found.argmax()) == 9
    assert found.max() > 2 * limit
    assert np.median(found) < limit


def test_probabilities_are_uniform_where_the_teeth_differ_without_order():
    rng = np.random.default_rng(2)
    template = rng.normal(size=(1, 12)) * np.exp(-np.arange(12) / 4)
    found = []
    for seed in range(120):
        teeth = 20 + seed % 2
        errors = np.fft.rfft(rng.normal(size=teeth))[1:, None]
        noise = np.fft.rfft(rng.normal(size=(teeth, 12)), axis=0)[1:]
        found.append(localised(errors * template + 0.5 * noise, teeth, draws=250, seed=seed).p)
    assert kstest(found, "uniform").pvalue > 0.01
    assert np.mean(np.array(found) < 0.05) < 0.12


@pytest.mark.parametrize("teeth", [17, 20, 43])
def test_one_tooth_is_found_where_it_is(teeth):
    rng = np.random.default_rng(3)
    pattern = 0.1 * rng.normal(size=(teeth, 12))
    pattern[7] += np.hanning(12)
    found = localised(np.fft.rfft(pattern, axis=0)[1:], teeth)
    assert found.p < 0.002
    assert found.tooth == pytest.approx(7, abs=0.5)
    assert found.share > found.limit > found.usual


RIGS = [((20, 43), 0), ((20, 43), 1), ((20, 40), 0), ((20, 40), 1), ((20, 50), 1)]


@pytest.mark.parametrize(("teeth", "shaft"), RIGS)
def test_a_burst_belongs_to_the_shaft_that_makes_it(teeth, shaft):
    _time, turn = turns_of_a_shaft()
    rng = np.random.default_rng(4)
    values = 4 * np.cos(2 * np.pi * 20 * turn) + 0.3 * rng.normal(size=len(turn))
    values += pulse(turn * 20, 11, teeth[shaft])
    found = patterns(heard(values, turn, teeth))
    tests = one_tooth(found, 1000)
    names = ("pinion", "gear")
    assert tests[names[shaft]].p < 0.003
    assert tests[names[shaft]].tooth == pytest.approx(11, abs=1)
    assert tests[names[1 - shaft]].p > 0.003
    if teeth[1] % teeth[0]:  # else much of the gear's pattern is the pinion's too
        assert presence(found, names[shaft]).p < 0.005


def test_a_single_impact_is_no_burst_of_a_shaft():
    _time, turn = turns_of_a_shaft()
    values = 0.1 * np.random.default_rng(5).normal(size=len(turn)) + 30 * pulse(turn * 20, 311, 10_000)
    found = one_tooth(patterns(heard(values, turn)), 1000)
    assert found["pinion"].p > 0.01
    assert found["gear"].p > 0.01


def test_noise_has_no_pattern_and_no_line():
    _time, turn = turns_of_a_shaft()
    found = patterns(heard(np.random.default_rng(6).normal(size=len(turn)), turn))
    assert presence(found, "pinion").p > 0.01
    assert presence(found, "gear").p > 0.01
    line = orders.asynchronous(found)
    assert line is None or line.p > 0.01


def test_a_line_at_no_order_of_a_shaft_is_asynchronous():
    _time, turn = turns_of_a_shaft(seconds=3.0)
    rng = np.random.default_rng(7)
    values = (
        4 * np.cos(2 * np.pi * 20 * turn) + 0.3 * rng.normal(size=len(turn)) + 0.3 * np.cos(2 * np.pi * 7.67 * turn)
    )
    line = orders.asynchronous(patterns(heard(values, turn)))
    assert line.order == pytest.approx(7.67, abs=0.03)
    assert line.p < 1e-6


@pytest.mark.parametrize(("declared", "said"), [(23, None), (24, 23), (41, 23)])
def test_the_mesh_of_other_teeth_than_the_declared_ones_is_seen(declared, said):
    """Beside a burst once a turn, which has lines at every order."""
    _time, turn = turns_of_a_shaft()
    mesh = sum(np.cos(2 * np.pi * 23 * h * turn + h) / h for h in (1, 2, 3))
    values = mesh + 0.3 * pulse(23 * turn, 5, 23) + 0.1 * np.random.default_rng(4).normal(size=turn.size)
    one = heard(values, turn, (declared, 41 if declared != 41 else 23))
    assert orders.mesh_elsewhere(one, *orders.spectrum(one)) == said


def test_no_mesh_is_seen_elsewhere_in_noise():
    _time, turn = turns_of_a_shaft()
    one = heard(np.random.default_rng(5).normal(size=turn.size), turn)
    assert orders.mesh_elsewhere(one, *orders.spectrum(one)) is None


@pytest.mark.parametrize(("order", "times"), [(5.753, 4), (11.51, 2), (5.9, None)])
def test_a_part_of_the_mesh_order_may_be_the_mesh_of_more_pulses(order, times):
    line = SimpleNamespace(order=order, ratio=900.0, p=0.0)
    study = SimpleNamespace(heard=SimpleNamespace(name="run", orders={"mesh": 23.0}, speed=100.0), asynchronous=line)
    said = findings._asynchronous(study, 0.01)["sentence"]
    assert ("times as many pulses" in said) is (times is not None)
    assert times is None or f"has {times} times as many pulses as are declared." in said
