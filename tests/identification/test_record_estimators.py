"""Estimators of a record's free vibration, against closed forms and scipy's integrator."""

import math

import numpy as np
import pytest
import torch
from closed_forms import free_decay
from scipy.integrate import solve_ivp
from scipy.linalg import expm, solve_discrete_lyapunov
from scipy.signal import firwin, lfilter

from gear_damping.identification.catalogue import builtin_estimators
from gear_damping.identification.damping_estimate import UnsuitedRecord
from gear_damping.identification.estimators.base import Recorded, RecordEstimator
from gear_damping.identification.free_vibration import Turning, grows
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord, Observed
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator

FREQUENCY, RATE = 12.0, 600.0  # Hz: fifty samples a period
OMEGA = 2 * math.pi * FREQUENCY
OF_RECORDS = {name: kind for name, kind in builtin_estimators().items() if issubclass(kind, RecordEstimator)}
KINDS = {name: kind for name, kind in OF_RECORDS.items() if kind.of_ring_downs}
NOISE = 1e-4
QUADRATIC = 2.5  # 1/m


def recorded(values, inputs=None, angle=None, stamps=None, offset=False):
    series = torch.as_tensor(np.asarray(values, dtype=float))
    drives = {name: torch.as_tensor(drive) for name, drive in (inputs or {}).items()}
    observed = Observed("displacement", offset=offset)
    record = FitRecord("run", series, RATE, drives, observed=observed, stamps=stamps)
    system = Oscillator if angle is None else GearPair
    return Recorded(record, system, Known({}, {}), None if angle is None else Turning(angle, (20, 33)))


def decay(ratio, seconds=8.0, amplitude=0.02, time=None):
    """A linear decay from rest at its amplitude, in closed form."""
    time = np.arange(round(seconds * RATE)) / RATE if time is None else time
    return free_decay(time, 1.0, 2 * ratio * OMEGA, OMEGA**2, amplitude, 0.0)[0]


def noise(count, seed, size=NOISE):
    return size * np.random.default_rng(seed).normal(size=count)


@pytest.mark.parametrize("name", sorted(KINDS))
@pytest.mark.parametrize("ratio", [0.004, 0.02])
def test_a_linear_decay(name, ratio):
    clean, errors, inside = decay(ratio), [], 0
    for seed in range(8):
        found = KINDS[name]({}).estimate(recorded(clean + noise(clean.size, seed)))
        errors.append(found.damping_ratio_percent / (100 * ratio) - 1)
        inside += found.interval95[0] <= 100 * ratio <= found.interval95[1]
    assert abs(np.mean(errors)) < 0.01
    assert np.std(errors) < 0.02
    assert inside >= 5  # of eight: fewer come by chance once in 3000 times
    assert found.frequency_hz == pytest.approx(FREQUENCY * math.sqrt(1 - ratio**2), rel=2e-3)
    assert found.amplitudes[0] == pytest.approx(0.02, rel=0.12)
    assert found.amplitudes[1] < found.amplitudes[0]
    assert found.doubt == ""


def test_the_width_of_a_resonance_is_told_through_the_noise_that_is_beside_it():
    """Noise of the first order, which has most of its power below the resonance and at it."""
    clean, outside = decay(0.01, seconds=4.0), 0
    for seed in range(20):
        coloured = lfilter([1.0], [1.0, -0.95], noise(clean.size, seed, 4e-4))
        found = KINDS["half_power"]({}).estimate(recorded(clean + coloured))
        outside += not found.interval95[0] <= 1 <= found.interval95[1]
    assert outside <= 3  # more come by chance once in sixty times


def quadratic_decay():
    """x'' + c x'|x'| + w^2 x = 0 by an integrator."""
    time = np.arange(12000) / RATE
    rates = lambda t, y: (y[1], -QUADRATIC * y[1] * abs(y[1]) - OMEGA**2 * y[0])  # noqa: E731
    return solve_ivp(rates, (0, time[-1]), (0.02, 0.0), t_eval=time, rtol=1e-9, atol=1e-12).y[0]


@pytest.mark.parametrize("swing", [0.1, 2.0])
def test_half_power_doubts_a_line_that_a_moving_frequency_widens(swing):
    """A pendulum of 1 % of critical for small swings, by an integrator: a wide one is slower, and has a wider line."""
    time = np.arange(6000) / RATE
    rates = lambda t, y: (y[1], -0.02 * OMEGA * y[1] - OMEGA**2 * np.sin(y[0]))  # noqa: E731
    swung = solve_ivp(rates, (0, time[-1]), (swing, 0.0), t_eval=time, rtol=1e-9, atol=1e-12).y[0]
    found = KINDS["half_power"]({}).estimate(recorded(swung + noise(swung.size, 1, swing / 100)))
    if swing < 1:
        assert found.doubt == ""
        assert found.damping_ratio_percent == pytest.approx(1.0, abs=0.03)
    else:
        assert "wavelet_ridge" in found.doubt
        assert found.damping_ratio_percent > 1.5


def test_the_ridge_tells_damping_that_grows_with_amplitude():
    """The fall of a cycle is that of the ratio 4 c A / (3 pi) (Krylov & Bogoliubov), to first order of it."""
    clean = quadratic_decay()
    size = 0.01 * np.std(clean)  # 40 dB
    found = KINDS["wavelet_ridge"]({}).estimate(recorded(clean + noise(clean.size, 1, size)))
    amplitude, ratio = found.curve.amplitude, found.curve.damping_ratio_percent
    expected = 100 * 4 * QUADRATIC * amplitude / (3 * math.pi)
    decade = amplitude > amplitude.max() / 10
    assert amplitude.max() / amplitude.min() > 8
    assert np.median(np.abs(ratio / expected - 1)[decade]) < 0.03
    low, high = found.curve.interval95.T
    twice = np.abs(ratio - expected) <= (high - low)
    assert np.mean(twice) > 0.9
    assert np.all(np.diff(amplitude) <= 0)
    np.testing.assert_allclose(found.curve.frequency_hz, FREQUENCY, rtol=5e-3)


@pytest.mark.parametrize("name", sorted(set(KINDS) - {"output_error"}))
def test_lines_of_a_mesh_that_turns_unevenly_are_no_vibration(name):
    clean = decay(0.01, seconds=4.0)
    time = np.arange(clean.size) / RATE
    angle = 2 * math.pi * (17 * time + 0.3 * np.sin(2 * math.pi * 0.4 * time))
    lines = 0.01 * np.cos(angle + 1) + 0.004 * np.cos(2 * angle) + 0.003
    lines = lines + 0.05 * np.cos(angle / 20) + 0.02 * np.cos(2 * angle / 33 + 1) + 0.005 * np.cos(angle - angle / 20)
    found = KINDS[name]({}).estimate(recorded(clean + lines + noise(clean.size, 2), angle=angle))
    assert found.damping_ratio_percent == pytest.approx(1.0, rel=0.06)


@pytest.mark.parametrize("name", sorted(set(KINDS) - {"output_error"}))
def test_a_line_that_goes_on_is_no_free_vibration(name):
    values = 0.01 * np.cos(OMEGA * np.arange(4800) / RATE) + noise(4800, 2)
    with pytest.raises(UnsuitedRecord, match="does not die away"):
        KINDS[name]({}).estimate(recorded(values))


def test_what_does_not_swing_has_no_ratio():
    values = 0.01 * np.exp(-np.arange(1200) / RATE / 0.05) + noise(1200, 2)
    with pytest.raises(UnsuitedRecord, match="does not swing"):
        KINDS["output_error"]({}).estimate(recorded(values))


def test_amplitudes_end_where_noise_begins():
    values = decay(0.02, seconds=100.0)
    found = KINDS["output_error"]({}).estimate(recorded(values + noise(values.size, 2)))
    assert found.amplitudes[1] == pytest.approx(3 * NOISE, rel=0.1)


@pytest.mark.parametrize("name", sorted(set(KINDS) - {"output_error"}))
def test_uneven_stamps(name):
    jitter = np.random.default_rng(3).uniform(-0.3, 0.3, 4800)
    stamps = np.arange(4800) + jitter
    clean = decay(0.01, time=stamps / RATE)
    found = KINDS[name]({}).estimate(recorded(clean + noise(4800, 4), stamps=torch.as_tensor(stamps)))
    assert found.damping_ratio_percent == pytest.approx(1.0, rel=0.03)


@pytest.mark.parametrize("name", sorted(set(KINDS) - {"output_error"}))
@pytest.mark.parametrize(
    ("values", "drive", "said"),
    [
        (decay(0.01), np.sin(np.arange(4800.0)), "driven by a measured input"),
        (decay(0.01, seconds=0.2), None, "record"),
        (decay(0.01)[::25], None, "samples a period"),
        (noise(4800, 5), None, "record|sample"),
    ],
)
def test_what_does_not_suit_is_said_with_what_would(name, values, drive, said):
    inputs = None if drive is None else {"force": drive}
    with pytest.raises(UnsuitedRecord, match=said):
        KINDS[name]({}).estimate(recorded(values, inputs))


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name == "output_error" else name for name in sorted(KINDS)]
)
def test_noise_in_a_band_tells_no_damping(name):
    """It is refused, or its interval is as wide as what is said."""
    for seed in range(5):
        try:
            found = KINDS[name]({}).estimate(recorded(lfilter(firwin(61, 0.2), 1, noise(4800, seed))))
        except UnsuitedRecord:
            continue
        low, high = found.interval95
        assert high - low > abs(found.damping_ratio_percent)


def test_a_decay_after_a_stroke_is_free():
    clean = np.concatenate([np.zeros(60), decay(0.01)])
    force = np.zeros(clean.size)
    force[55:60] = 30.0
    force = force + noise(force.size, 8, 0.3)  # the sensor of the hammer
    values = clean + noise(clean.size, 6)
    found = KINDS["log_decrement"]({}).estimate(recorded(values, {"force": force}))
    assert found.damping_ratio_percent == pytest.approx(1.0, rel=0.02)


def test_settings_are_checked_and_count():
    with pytest.raises(ValueError, match="omega0 must lie within 5 and 100"):
        KINDS["wavelet_ridge"]({"omega0": 1.0})
    with pytest.raises(ValueError, match=r"has no setting \['omega'\]"):
        KINDS["wavelet_ridge"]({"omega": 6.0})
    values = decay(0.02) + noise(4800, 7)
    found = [KINDS["wavelet_ridge"]({"omega0": w}).estimate(recorded(values)).damping_ratio_percent for w in (6, 20)]
    assert found[0] != found[1]


@pytest.mark.parametrize("ratio", [0.01, 0.05, 0.15, 0.3])
def test_how_quickly_a_decay_falls_is_known_without_an_envelope(ratio):
    values = decay(ratio, seconds=2.0) + noise(1200, 3, 1e-7)
    assert recorded(values).free_vibration.roughly_percent == pytest.approx(100 * ratio, rel=0.02)


@pytest.mark.parametrize(
    ("name", "most"), [("hilbert_envelope", 80 / 15), ("wavelet_ridge", 15.0), ("half_power", 20.0)]
)
def test_what_falls_faster_than_an_estimator_can_follow_is_refused(name, most):
    """Just below it is right within 6 %; beyond, an envelope would fall as its filter does."""
    for seed in range(4):
        below, above = (decay(share * most / 100, seconds=3.0) + noise(1800, seed, 2e-6) for share in (0.95, 1.05))
        found = KINDS[name]({}).estimate(recorded(below))
        assert found.damping_ratio_percent == pytest.approx(0.95 * most, rel=0.06)
        with pytest.raises(UnsuitedRecord, match=f"this estimator follows {most:.2g} % at most"):
            KINDS[name]({}).estimate(recorded(above))


def test_a_wider_band_follows_a_quicker_fall():
    values = decay(0.08, seconds=3.0) + noise(1800, 1, 2e-6)
    found = KINDS["hilbert_envelope"]({"bandwidth": 1.6}).estimate(recorded(values))
    assert found.damping_ratio_percent == pytest.approx(8.0, rel=0.1)


def test_a_motion_that_grows_has_no_damping():
    grown = decay(0.005)[::-1].copy() + noise(4800, 2)
    with pytest.raises(UnsuitedRecord, match="its motion grows"):
        KINDS["output_error"]({}).estimate(recorded(grown))


def test_a_motion_that_is_let_go_late_does_not_grow():
    """Noise before the release, and a decay behind it that fills less than the second half."""
    late = np.concatenate([np.zeros(6000), decay(0.01)])
    assert not grows(recorded(late + noise(late.size, 4)).record)
    assert grows(recorded(decay(0.005)[::-1].copy() + noise(4800, 2)).record)


def ambient(ratio, seconds, seed=3):
    """A motion under a random load, exactly sampled: two states, whose covariance is that of a steady process."""
    count, damped = round(seconds * RATE), OMEGA * math.sqrt(1 - ratio**2)
    pole = np.exp((-ratio * OMEGA + 1j * damped) / RATE)
    drive = np.random.default_rng(seed).normal(size=count)
    return lfilter([0, 1.0], [1, -2 * pole.real, abs(pole) ** 2], drive)


@pytest.mark.parametrize("name", sorted(set(KINDS) - {"output_error"}))
@pytest.mark.parametrize("ratio", [0.005, 0.02])
def test_a_motion_under_an_unmeasured_load_has_no_ring_down(name, ratio):
    """But for the one in six or so that happens to begin with a long fall."""
    refused = 0
    for seed in range(6):
        values = ambient(ratio, 40.0, seed)
        try:
            KINDS[name]({}).estimate(recorded(values / values.std()))
        except UnsuitedRecord as error:
            refused += "does not die away" in str(error) or "something that was not measured drives it" in str(error)
    assert refused >= 5


@pytest.mark.slow
def test_output_error_doubts_what_is_no_ring_down():
    values = ambient(0.02, 20.0)
    assert "something that was not measured drives it" in KINDS["output_error"]({}).estimate(recorded(values)).doubt
    line = np.sin(OMEGA * np.arange(6000) / RATE) + noise(6000, 1)
    assert "does not die away" in KINDS["output_error"]({}).estimate(recorded(line)).doubt
    assert not KINDS["output_error"]({}).estimate(recorded(decay(0.01) + noise(4800, 2))).doubt


@pytest.mark.parametrize("name", sorted(KINDS))
def test_what_was_tapped_before_is_told_by_its_last_ring_down(name):
    """Three taps that nobody measured: the largest is the last, and what is before it is no part of a decay."""
    taps = [0.3 * decay(0.02, 2.0), 0.5 * decay(0.02, 2.0), decay(0.02, 4.0)]
    values = np.concatenate(taps)
    found = KINDS[name]({}).estimate(recorded(values + noise(values.size, 4)))
    assert found.damping_ratio_percent == pytest.approx(2.0, rel=0.02)


@pytest.mark.parametrize("name", sorted(set(KINDS) - {"output_error"}))
def test_what_swings_evenly_before_it_dies_away_is_no_ring_down_alone(name):
    """A shaker at the resonance, which is switched off after four seconds, and whose force nobody measured."""
    time = np.arange(round(4 * RATE)) / RATE  # 48 periods
    steady = 0.02 * (0.98 + 0.005 * time) * np.cos(OMEGA * time)
    values = np.concatenate([steady, decay(0.01, 4.0)])
    with pytest.raises(UnsuitedRecord, match="grows by itself: something that was not measured drives it"):
        KINDS[name]({}).estimate(recorded(values + noise(values.size, 6)))


def shaken(ratio, seconds, seed, order):
    """Displacement, velocity or acceleration under white force that holds between samples, in its steady state."""
    dynamics = np.array([[0.0, 1.0], [-(OMEGA**2), -2 * ratio * OMEGA]])
    step = expm(dynamics / RATE)
    push = np.linalg.solve(dynamics, (step - np.eye(2)) @ [0.0, 1.0])
    steady = solve_discrete_lyapunov(step, np.outer(push, push))
    random = np.random.default_rng(seed)
    state = np.linalg.cholesky(steady) @ random.normal(size=2)
    force, found = random.normal(size=round(seconds * RATE)), []
    for drive in force:
        acceleration = drive - 2 * ratio * OMEGA * state[1] - OMEGA**2 * state[0]
        found.append((*state, acceleration)[order])
        state = step @ state + push * drive
    return np.array(found) / np.std(found)


def of_channel(values, order, inputs=None):
    series = torch.as_tensor(values)
    observed = Observed(("displacement", "velocity", "acceleration")[order])
    return Recorded(FitRecord("run", series, RATE, inputs or {}, observed=observed), Oscillator, Known({}, {}))


@pytest.mark.parametrize(
    ("order", "ratio"), [(0, 0.02), *(pytest.param(*one, marks=pytest.mark.slow) for one in ((1, 0.01), (2, 0.05)))]
)
def test_the_spectrum_under_a_random_load_tells_the_damping(order, ratio):
    away, estimator = [], OF_RECORDS["ambient_spectrum"]({})
    for seed in range(8):
        values = shaken(ratio, 20.0, seed, order) + noise(round(20.0 * RATE), seed + 100, 0.05)
        found = estimator.estimate(of_channel(values, order))
        low, high = np.log(np.array(found.interval95) / 100 / ratio)
        away.append((low + high) / (high - low) * 1.96)  # standard errors, of the logarithm
        assert found.frequency_hz == pytest.approx(FREQUENCY, rel=0.02)
    away = np.array(away)
    assert np.sum(np.abs(away) < 1.96) >= 6  # of eight: fewer come by chance once in 170 times
    assert abs(away.mean()) < 3 / 8**0.5  # three standard errors
    assert 0.4 < np.sqrt(np.mean(away**2)) < 1.8


@pytest.mark.parametrize(
    ("values", "inputs", "said"),
    [
        (decay(0.01, 20.0) + noise(12000, 1), {}, "as smooth as that of a ring-down, which the other estimators"),
        (shaken(0.02, 20.0, 1, 0) + 3 * np.sin(1.003 * OMEGA * np.arange(12000) / RATE), {}, "a line at 12"),
        (shaken(0.002, 10.0, 1, 0), {}, "of the times in which its motion forgets itself, and 5 are needed"),
        (shaken(0.02, 1.2, 1, 0), {}, "14 lines of its spectrum show the resonance: record longer"),
        (shaken(0.4, 20.0, 1, 0), {}, "too broad to be told from the load that makes it"),
        (shaken(0.02, 20.0, 1, 0), {"force": torch.arange(12000.0)}, "driven by a measured input, which output_error"),
    ],
)
def test_what_no_random_load_has_made_has_no_such_spectrum(values, inputs, said):
    with pytest.raises(UnsuitedRecord, match=said):
        OF_RECORDS["ambient_spectrum"]({}).estimate(of_channel(values, 0, inputs))


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_two_modes_near_each_other_are_no_one_of_twice_the_damping(seed):
    random, values = np.random.default_rng(seed), 0.0
    for frequency in (FREQUENCY, 1.12 * FREQUENCY):
        omega = 2 * math.pi * frequency
        pole = np.exp((-0.015 * omega + 1j * omega * math.sqrt(1 - 0.015**2)) / RATE)
        values = values + lfilter([0, 1.0], [1, -2 * pole.real, abs(pole) ** 2], random.normal(size=round(60 * RATE)))
    with pytest.raises(UnsuitedRecord, match=r"another shape than that of one mode|a line at"):
        OF_RECORDS["ambient_spectrum"]({}).estimate(of_channel(values / values.std(), 0))
