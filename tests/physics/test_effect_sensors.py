"""Sensors in closed form, and what the drawn loads and noises promise."""

import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from effect_bench import EFFECTS
from scipy import signal as scipy_signal

from gear_damping.physics.terms import Recording, Sensor

RATE, COUNT, BATCH = 1000.0, 2000, 3
TIME = torch.arange(COUNT, dtype=torch.float64) / RATE


def recording(seed: int = 0) -> Recording:
    angle = 2 * math.pi * 7.3 * TIME.expand(BATCH, -1) + 0.2
    radii = {"base_radius_pinion": torch.full((BATCH,), 0.028), "base_radius_gear": torch.full((BATCH,), 0.056)}
    return Recording(RATE, torch.Generator().manual_seed(seed), radii, angle, angle / 2 + 0.1)


def measured(
    name: str, record: torch.Tensor, options: dict | None = None, seed: int = 0, **values: float
) -> np.ndarray:
    sensor = EFFECTS[name](**(options or {}))
    given = {p.name: values.get(p.name, p.default) for p in sensor.parameters}
    rows = {k: torch.as_tensor(v, dtype=torch.float64).expand(BATCH) for k, v in given.items()}
    before = record.clone()
    found = sensor.measure(record, rows, recording(seed))
    assert torch.equal(record, before)
    assert found.shape == record.shape
    assert found.dtype == record.dtype
    return found.numpy()


def tone(frequency: float, phase: float = 0.0) -> torch.Tensor:
    return torch.cos(2 * math.pi * frequency * TIME + phase).expand(BATCH, -1)


MIDDLE = slice(400, 1600)


def test_gain_offset_and_drift():
    record = tone(20.0)
    np.testing.assert_allclose(measured("sensor_gain", record, gain=1.3), 1.3 * record.numpy(), rtol=1e-15)
    np.testing.assert_allclose(measured("sensor_offset", record, offset=0.4), record.numpy() + 0.4, rtol=1e-15)
    wanted = record.numpy() + 0.7 * TIME.numpy()
    np.testing.assert_allclose(measured("sensor_drift", record, rate=0.7), wanted, rtol=1e-14)


@pytest.mark.parametrize("delay", [0.0, 1e-3, 0.37e-3, 2.61e-3, -0.4e-3])
def test_a_delayed_tone_is_the_tone_of_earlier_instants(delay):
    found = measured("sensor_delay", tone(83.0, 0.3), delay=delay)
    wanted = np.cos(2 * np.pi * 83.0 * (TIME.numpy() - delay) + 0.3)
    np.testing.assert_allclose(found[:, MIDDLE], np.broadcast_to(wanted[MIDDLE], (BATCH, 1200)), atol=2e-3)


def test_a_whole_delay_moves_the_samples_and_keeps_a_slope():
    record = (0.5 * TIME - 0.2).expand(BATCH, -1) + 0.01 * tone(31.0)
    found = measured("sensor_delay", record, delay=3e-3)
    np.testing.assert_allclose(found[:, 3:], record[:, :-3].numpy(), atol=1e-12)


def test_members_have_delays_of_their_own():
    delays = torch.tensor([0.0, 1e-3, 5e-3], dtype=torch.float64)
    found = EFFECTS["sensor_delay"]().measure(tone(31.0), {"delay": delays}, recording())
    for row, shift in zip(found, (0, 1, 5), strict=True):
        assert torch.allclose(row[MIDDLE], tone(31.0)[0, 400 - shift : 1600 - shift], atol=1e-9)


@pytest.mark.parametrize("order", [1, 2, 4])
@pytest.mark.parametrize("frequency", [20.0, 90.0, 200.0])
def test_lowpass_has_the_response_of_the_butterworth_filter(order, frequency):
    found = measured("sensor_lowpass", tone(frequency), {"order": order}, cutoff=90.0)
    numerator, denominator = scipy_signal.butter(order, 2 * np.pi * 90.0, analog=True)
    _, response = scipy_signal.freqs(numerator, denominator, [2 * np.pi * frequency])
    wanted = np.real(response[0] * np.exp(2j * np.pi * frequency * TIME.numpy()))
    np.testing.assert_allclose(found[0, MIDDLE], wanted[MIDDLE], atol=2e-3)


def test_lowpass_leaves_the_mean_and_a_slow_ramp_follows_late():
    record = (2.0 + 3.0 * TIME).expand(BATCH, -1)
    found = measured("sensor_lowpass", record, {"order": 1}, cutoff=50.0)
    late = 2.0 + 3.0 * (TIME.numpy() - 1 / (2 * np.pi * 50.0))
    np.testing.assert_allclose(found[0, MIDDLE], late[MIDDLE], rtol=1e-4)


def test_saturation_and_quantisation():
    record = tone(20.37)
    np.testing.assert_array_equal(measured("sensor_saturation", record, limit=0.6), record.clamp(-0.6, 0.6).numpy())
    found = measured("sensor_quantisation", record, step=0.03)
    assert np.abs(found - record.numpy()).max() <= 0.015 + 1e-15
    assert (found - record.numpy()).std() == pytest.approx(0.03 / math.sqrt(12), rel=0.05)
    np.testing.assert_allclose(found / 0.03, np.round(found / 0.03), atol=1e-12)


def test_sensor_noise_has_its_ratio_to_the_moving_part_whatever_the_offset():
    record = 5.0 + torch.tensor([[1.0], [2.0], [0.5]], dtype=torch.float64) * tone(20.0)
    noise = measured("sensor_noise", record, snr_db=20.0, seed=3) - record.numpy()
    ratio = 20 * np.log10(record.numpy().std(axis=1) / noise.std(axis=1))
    np.testing.assert_allclose(ratio, 20.0, atol=0.5)
    assert abs(np.corrcoef(noise)[0, 1]) < 0.1
    np.testing.assert_array_equal(noise, measured("sensor_noise", record, snr_db=20.0, seed=3) - record.numpy())
    assert np.abs(noise[:, 1:] * noise[:, :-1]).mean() > 0
    assert abs((noise[:, 1:] * noise[:, :-1]).mean() / noise.var()) < 0.06


def test_load_noise_has_its_ratio_to_the_mean_load():
    effect = EFFECTS["load_noise"]()
    mean = torch.tensor([100.0, -300.0], dtype=torch.float64)
    source = torch.Generator().manual_seed(1)
    snr = torch.tensor([20.0, 6.0], dtype=torch.float64)
    drawn = effect.draw({"snr_db": snr}, mean, 20000, source)
    assert drawn.shape == (2, 20000)
    np.testing.assert_allclose(drawn.std(dim=1).numpy(), [10.0, 300.0 * 10 ** (-0.3)], rtol=0.02)
    assert (drawn.mean(dim=1) / drawn.std(dim=1)).abs().max() < 0.02


def test_encoder_error_is_the_angle_error_times_the_base_radius():
    values = {"pinion_amplitude": 1e-3, "pinion_phase": 0.3, "gear_amplitude": 2e-3, "gear_phase": -0.4}
    values |= {"lines": 90.0, "pinion_line_amplitude": 1e-4, "gear_line_amplitude": 3e-4}
    record = 1e-6 * tone(20.0)
    found = measured("encoder_error", record, **values)
    one = recording().pinion_angle.numpy()
    two = one / 2 + 0.1
    pinion = 1e-3 * np.cos(one + 0.3) + 1e-4 * np.cos(90 * one)
    gear = 2e-3 * np.cos(two - 0.4) + 3e-4 * np.cos(90 * two)
    np.testing.assert_allclose(found, record.numpy() + 0.028 * pinion - 0.056 * gear, atol=1e-9)


def test_an_encoder_error_looks_exactly_like_eccentricity():
    still = torch.zeros(BATCH, COUNT, dtype=torch.float64)
    found = measured("encoder_error", still, pinion_amplitude=25e-6 / 0.028, pinion_phase=0.3)
    np.testing.assert_allclose(found, 25e-6 * np.cos(recording().pinion_angle.numpy() + 0.3), rtol=1e-5, atol=1e-12)


def test_shaft_angle_error_is_in_the_channel_of_the_angle():
    assert EFFECTS["shaft_angle_error"].channel == "pinion_angle"
    angle = recording().pinion_angle
    found = measured("shaft_angle_error", angle, amplitude=0.01, phase=0.2)
    np.testing.assert_allclose(found - angle.numpy(), 0.01 * np.cos(angle.numpy() + 0.2), atol=1e-13)


@pytest.mark.parametrize("shaft", ["pinion", "gear"])
def test_an_accelerometer_feels_gravity_once_a_turn_of_its_shaft(shaft):
    sensor = EFFECTS["accelerometer_gravity"](shaft=shaft)
    assert sensor.acts_on == f"{shaft}_acceleration"
    still = torch.zeros(BATCH, COUNT, dtype=torch.float64)
    found = measured("accelerometer_gravity", still, {"shaft": shaft}, phase=0.4)
    angle = 2 * math.pi * 7.3 * TIME.numpy() + 0.2
    turned = {"pinion": angle, "gear": angle / 2 + 0.1}[shaft]
    np.testing.assert_allclose(found[0], 9.80665 * np.cos(turned + 0.4), atol=1e-12)


def test_hum_goes_on_from_segment_to_segment():
    begins = torch.tensor([0.0, 0.013, 0.4], dtype=torch.float64)
    values = {"amplitude": 0.3, "frequency": 49.8, "phase": 0.4}
    rows = {name: torch.full((BATCH,), value, dtype=torch.float64) for name, value in values.items()}
    still = torch.zeros(BATCH, COUNT, dtype=torch.float64)
    found = EFFECTS["mains_hum"]().measure(still, rows, replace(recording(), begins=begins))
    wanted = 0.3 * np.sin(2 * math.pi * 49.8 * (TIME.numpy() + begins.numpy()[:, None]) + 0.4)
    np.testing.assert_allclose(found.numpy(), wanted, atol=1e-12)


def test_the_chain_runs_from_the_motion_to_the_file():
    order = [
        "encoder_error",
        "sensor_gain",
        "sensor_offset",
        "sensor_drift",
        "mains_hum",
        "sensor_lowpass",
        "sensor_delay",
        "sensor_noise",
        "sensor_saturation",
        "sensor_quantisation",
    ]
    positions = [EFFECTS[name].position for name in order]
    assert positions == sorted(set(positions))
    others = {n for n, c in EFFECTS.items() if issubclass(c, Sensor) and c.channel is None} - set(order)
    assert not others
