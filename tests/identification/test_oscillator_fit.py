"""Output error on oscillators whose parameters are known, and on real records."""

from dataclasses import replace

import closed_forms
import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp

from gear_damping.identification.observation import Known, fit_record
from gear_damping.identification.oscillator.first_frequency import first_frequency
from gear_damping.identification.oscillator.fit import fit_oscillator
from gear_damping.identification.oscillator.linear_model import DAMPING
from gear_damping.identification.output_error.records import FitRecord, Observed
from gear_damping.measurement.files import data_root
from gear_damping.measurement.load import load_measurement
from gear_damping.physics.systems.oscillator import Oscillator

RATE, FREQUENCY, RATIO = 500.0, 20.0, 0.02
OMEGA = 2 * np.pi * FREQUENCY


def free_decay_record(seed, noise=0.0, name="decay"):
    times = np.arange(1500) / RATE
    clean, _ = closed_forms.free_decay(times, 1.0, 2 * RATIO * OMEGA, OMEGA**2, 2e-3, 0.05)
    noisy = clean + 1e-5 + noise * np.random.default_rng(seed).standard_normal(1500)
    return FitRecord(name, torch.as_tensor(noisy), RATE, observed=Observed(offset=True))


def forced_record(seed, noise=0.0, name="forced"):
    """Independent truth: scipy with a band-limited force written as a sum of tones."""
    generator = np.random.default_rng(seed)
    times = np.arange(2000) / RATE
    lines = np.arange(2, 160) * 0.25
    amplitudes, phases = generator.uniform(0.5, 1, len(lines)), generator.uniform(0, 2 * np.pi, len(lines))

    def force(t):
        return float(amplitudes @ np.sin(2 * np.pi * lines * t + phases))

    def slope(t, y):
        return [y[1], 3.0 * force(t) - 2 * RATIO * OMEGA * y[1] - OMEGA**2 * y[0]]

    found = solve_ivp(slope, (0, times[-1]), [1e-3, 0.0], "DOP853", times, rtol=1e-9, atol=1e-12)
    response = found.y[0] + noise * generator.standard_normal(2000)
    measured = torch.as_tensor([force(t) for t in times])
    return FitRecord(name, torch.as_tensor(response), RATE, {"force": measured}, observed=Observed(offset=True))


def test_a_clean_free_decay_is_found_exactly():
    found = fit_oscillator([free_decay_record(0)])
    assert found.converged
    assert found.natural_frequency_hz.value == pytest.approx(FREQUENCY, rel=1e-6)
    assert found.damping_ratio_percent.value == pytest.approx(100 * RATIO, rel=1e-5)
    assert found.log_decrement.value == pytest.approx(2 * np.pi * RATIO / np.sqrt(1 - RATIO**2), rel=1e-5)
    assert found.own["offset.displacement@decay"] == pytest.approx(1e-5, rel=1e-3)
    assert found.rmse["holdout"] is None


def test_a_wide_swing_that_loses_step_is_fitted_in_segments():
    """A pendulum from 70 degrees: over the whole record the nearest linear oscillator runs out of step."""
    times = np.arange(6000) / 50.0
    omega, ratio = 2 * np.pi, 0.002

    def rates(_, state):
        return state[1], -2 * ratio * omega * state[1] - omega**2 * np.sin(state[0])

    swing = solve_ivp(rates, (0, times[-1]), (1.2, 0.0), "DOP853", times, rtol=1e-9, atol=1e-12).y[0]
    noisy = swing + 1e-3 * np.random.default_rng(2).standard_normal(6000)
    found = fit_oscillator([FitRecord("wide", torch.as_tensor(noisy), 50.0)])
    assert found.segments.seconds == pytest.approx(5 / 0.95, rel=0.1)
    assert found.damping_ratio_percent.value == pytest.approx(100 * ratio, rel=0.3)
    narrow = fit_oscillator([FitRecord("narrow", torch.as_tensor(0.05 * swing[5400:]), 50.0)])
    assert not narrow.segments


@pytest.mark.parametrize("starts_at", [0.0, 20.0])
def test_what_gains_speed_by_itself_is_pushed_and_what_coasts_is_not(starts_at):
    """A motor behind a step of its voltage, and a wheel that coasts to rest: v' = push - v / tau, in closed form."""
    tau, push, time = 0.2, 45.0 if starts_at == 0 else 0.0, np.arange(400) / 200.0
    speed = push * tau + (starts_at - push * tau) * np.exp(-time / tau)
    speed += 0.02 * np.random.default_rng(3).normal(size=time.size)
    record = FitRecord("run", torch.as_tensor(speed), 200.0, observed=Observed("velocity"))
    found = fit_oscillator([record], known=Known({"stiffness": 0.0}, {}))
    assert found.parameters["damping_coefficient"].value == pytest.approx(1 / tau, rel=0.02)
    assert ("offset_force.force" in found.given) is (starts_at == 0)
    if starts_at == 0:
        assert found.given["offset_force.force"] == pytest.approx(push, rel=0.02)


def test_a_forced_record_is_found_and_the_holdout_predicted():
    found = fit_oscillator([forced_record(1)], [forced_record(2, name="other")])
    assert found.natural_frequency_hz.value == pytest.approx(FREQUENCY, rel=1e-3)
    assert found.damping_ratio_percent.value == pytest.approx(100 * RATIO, rel=1e-2)
    assert found.parameters["force_gain"].value == pytest.approx(3.0, rel=1e-2)
    assert found.parameters["force_gain"].unit == "response unit / force unit / s^2"
    deviation = float(forced_record(2).response.std())
    assert found.rmse["holdout"] < 0.02 * deviation


def test_the_gain_of_a_force_on_a_velocity_is_per_second():
    record = forced_record(1)
    rate = torch.as_tensor(np.gradient(record.response.numpy()) * record.sampling_rate)
    found = fit_oscillator([replace(record, response=rate, observed=Observed("velocity"))])
    assert found.parameters["force_gain"].value == pytest.approx(3.0, rel=5e-2)
    assert found.parameters["force_gain"].unit == "response unit / force unit / s"


def test_intervals_cover_the_truth():
    """Twenty noisy decays: about nineteen intervals hold the true ratio; fewer than fifteen would be 1 in 10^4."""
    covered, widths = 0, []
    for seed in range(20):
        found = fit_oscillator([free_decay_record(seed, noise=2e-4)])
        low, high = found.damping_ratio_percent.interval95
        covered += low <= 100 * RATIO <= high
        widths.append(high - low)
    assert covered >= 16
    assert max(widths) < 0.3 * 100 * RATIO


def test_two_records_with_their_own_starts():
    records = [free_decay_record(0, name="a"), free_decay_record(0, name="b")]
    records[1] = replace(records[1], response=records[1].response[300:])
    found = fit_oscillator(records)
    assert found.damping_ratio_percent.value == pytest.approx(100 * RATIO, rel=1e-5)
    assert found.predictions["b"].shape == (1200,)


def test_first_frequency_is_near():
    assert first_frequency(free_decay_record(0)) == pytest.approx(FREQUENCY, rel=0.05)
    assert first_frequency(forced_record(1)) == pytest.approx(FREQUENCY, rel=0.2)


def real(name):
    root = data_root()
    if not root.is_dir():
        pytest.skip("no measured records: set GEAR_DAMPING_DATA")
    from gear_damping.config.locate import conf_folder

    measurement = load_measurement(conf_folder() / "measurement" / "records" / f"{name}.yaml")

    roles = ("fit", "holdout")
    return [[fit_record(r, Oscillator) for r in measurement.with_role(role)] for role in roles]


@pytest.mark.real_record
def test_ship_roll():
    fit_on, holdout = real("ship_roll_21337")
    found = fit_oscillator(fit_on, holdout)
    assert np.degrees(found.rmse["fit"]) <= 0.18
    low, high = found.damping_ratio_percent.interval95
    assert 0.4 < low < high < 0.7


@pytest.mark.real_record
def test_silverbox():
    fit_on, holdout = real("silverbox")
    multisines = [r for r in holdout if r.name != "arrow"]
    found = fit_oscillator(fit_on[:2], multisines)
    assert found.rmse["holdout"] <= 7.0e-3
    assert found.natural_frequency_hz.value == pytest.approx(69.5, rel=0.01)
    assert found.given[DAMPING] > 0


def test_records_seen_through_different_channels_are_fitted_together():
    shown = free_decay_record(0, 1e-6)
    times = np.arange(1500) / RATE
    _, speed = closed_forms.free_decay(times, 1.0, 2 * RATIO * OMEGA, OMEGA**2, 2e-3, 0.05)
    other = FitRecord("speed", torch.as_tensor(speed), RATE, observed=Observed("velocity"), weight=1 / OMEGA)
    found = fit_oscillator([shown, other], [replace(other, name="held")])
    assert found.damping_ratio_percent.value == pytest.approx(100 * RATIO, rel=1e-3)
    assert len(found.predictions["speed"]) == len(found.predictions["held"]) == 1500
    assert float((found.predictions["speed"] - other.response).abs().max()) < 1e-3 * float(other.response.abs().max())


def test_a_damping_that_no_first_stretch_tells_is_found_over_the_whole_of_it():
    """A rod of .0019 % rings beside a line: a hundred of its 837 periods hold no damping at all."""
    rng, time = np.random.default_rng(7), np.arange(5000) / 1e4
    ringing = np.exp(-0.2 * time) * np.cos(2 * np.pi * 1674 * time + 0.3)
    beside = 0.28 * np.exp(-0.33 * time) * np.cos(2 * np.pi * 4978.85 * time + 2) + 0.05 * np.cos(
        2 * np.pi * 538 * time
    )
    values = torch.from_numpy(ringing + beside + 0.004 * rng.standard_normal(time.size))
    record = FitRecord("rod", values, 1e4, observed=Observed(offset=True))
    found = fit_oscillator([record]).damping_ratio_percent
    assert found.interval95[0] < 100 * 0.2 / (2 * np.pi * 1674) < found.interval95[1]
    assert found.interval95[0] > 0
