"""The quantisation step of a channel, through every rounding that a file adds."""

import numpy as np
import pytest

from gear_damping.measurement.files import data_root
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.resolution import rounding_of, step_of

STEPS = (1e-3, 2.9142214e-3, 1 / 30)


def _wave(n: int) -> np.ndarray:
    rng = np.random.default_rng(n)
    return np.sin(np.arange(n) / 17.3) + 0.3 * np.cos(np.arange(n) / 5.1) + 0.02 * rng.standard_normal(n)


SEEN = {
    "as it is": lambda values: values,
    "offset": lambda values: values + 0.12345678,
    "mean taken off": lambda values: values - values.mean(),
    "added to and taken off": lambda values: (values + np.linspace(0, 1, values.size)) - np.linspace(0, 1, values.size),
    "in degrees": np.degrees,
    "in micrometres": lambda values: 1e-6 * values,
    "single precision": lambda values: values.astype(np.float32).astype(float),
    "six decimals": lambda values: np.round(values, 6),
    "text of nine digits": lambda values: np.array([float(f"{value:.9g}") for value in values]),
}


@pytest.mark.parametrize("n", [400, 20000])
@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("seen", SEEN)
def test_the_step_is_found_through_rounding_offset_and_unit(n, step, seen):
    values = SEEN[seen](step * np.round(_wave(n) / step))
    unit = SEEN[seen](np.array([1.0, 0.0])) if seen.startswith("in ") else np.array([1.0, 0.0])
    assert step_of(values) == pytest.approx(step * (unit[0] - unit[1]), rel=1e-5)


def test_few_decimals_are_a_step():
    assert step_of(np.round(_wave(400), 2)) == pytest.approx(0.01, rel=1e-6)


def test_a_few_samples_beside_the_grid_do_not_hide_it():
    values = np.round(_wave(1000), 2)
    values[::25] += 0.0034
    assert step_of(values) == pytest.approx(0.01, rel=1e-3)


@pytest.mark.parametrize("n", [8, 20, 400, 20000])
def test_what_has_no_step_gives_none(n):
    assert step_of(_wave(n)) == 0.0
    assert step_of(np.full(n, 3.7)) == 0.0


def test_two_levels_are_one_step_apart():
    assert step_of(np.array([1.0, 1.5, 1.5, 1.0, 1.5])) == 0.5


def test_coarse_values_that_were_interpolated_have_none_that_is_coarse():
    values = 0.01 * np.round(_wave(400) / 0.01)
    between = np.interp(np.arange(0, 398, np.pi / 5), np.arange(400), values)
    assert step_of(between) < 1e-4


@pytest.mark.real_record
@pytest.mark.skipif(not data_root().is_dir(), reason=f"the measured records are not at {data_root()}")
def test_the_steps_of_the_measured_records():
    steps = {
        (folder, record.name): step_of(next(iter(record.channels.values())).values)
        for folder in ("seismometer", "wheel_gyro")
        for record in load_measurement(data_root() / folder / "measurement.yaml").records
    }
    assert steps == {
        ("seismometer", "early"): pytest.approx(1e-3, rel=2e-3),  # V, three decimals, more near zero
        ("seismometer", "late"): pytest.approx(1e-3, rel=2e-3),
        ("wheel_gyro", "early"): pytest.approx(5.7375e-4, rel=1e-3),  # rad/s, 16 bits
        ("wheel_gyro", "late"): pytest.approx(5.7375e-4, rel=1e-3),
    }


def test_what_the_difference_of_two_large_numbers_is_rounded_to_is_no_step():
    values = (_wave(20000) + 4e4) - 4e4
    assert step_of(1e-5 * values) == 0.0


def test_the_digits_of_single_precision_are_no_step():
    noise = np.random.default_rng(5).standard_normal(20000)
    assert step_of((100 + 1e-5 * noise).astype(np.float32).astype(float)) == 0.0
    assert step_of((100 + np.round(noise, 2)).astype(np.float32).astype(float)) == pytest.approx(0.01, rel=1e-3)


def test_rounding_stays_in_a_mean_of_samples_that_repeat_one_another():
    """A slow wave in steps, 40 samples at each of them; with noise of a step, every sample is rounded on its own."""
    wave, noise = np.sin(np.arange(4000) / 400), 0.05 * np.random.default_rng(8).standard_normal(4000)
    assert rounding_of(np.round(wave / 0.05) * 0.05) == pytest.approx(0.05 / 12**0.5, rel=1e-6)
    assert rounding_of(np.round((wave + noise) / 0.05) * 0.05) == 0.0
    assert rounding_of(wave) == 0.0
