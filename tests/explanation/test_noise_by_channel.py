"""Records of one rig through other first channels: each has its noise in its own unit, and counts by that."""

import numpy as np
import pytest
import torch

from gear_damping.explanation.evidence.noise import noise_of, weighted
from gear_damping.identification.output_error.records import FitRecord, Observed
from gear_damping.measurement.record import Channel

LEVELS = {"displacement": 1e-3, "velocity": 3.0}


class Measured:
    """Of a measurement what the noise is worked out from."""

    records = tuple(
        type("Recorded", (), {"name": f"{name} {seed}", "channels": {name: Channel(name, np.zeros(1), "1")}})()
        for name in LEVELS
        for seed in range(2)
    )


def record(name, seed):
    values = LEVELS[name] * np.random.default_rng(seed).standard_normal(4000)
    return FitRecord(f"{name} {seed}", torch.as_tensor(values), 1000.0, observed=Observed(name))


def test_every_channel_has_its_own_noise_and_counts_by_it():
    records = [record(name, seed) for name in LEVELS for seed in range(2)]
    fit, _, noise = noise_of(records, [], Measured)
    for one in records:
        assert noise.by_record[one.name] == pytest.approx(LEVELS[one.observed.name], rel=0.1)
    assert noise.value == pytest.approx(LEVELS["displacement"], rel=0.1)
    sizes = [float((one.response * one.weight).std()) for one in weighted(fit, noise)]
    assert sizes == pytest.approx([noise.value] * 4, rel=0.1)


def test_the_noise_is_no_less_than_what_rounding_left_before_the_rate_was_lowered():
    channels = {"velocity": Channel("velocity", np.zeros(1), "1")}
    recorded = type("Recorded", (), {"name": "a", "channels": channels})()
    measurement = type("Measured", (), {"records": (recorded,)})

    values = torch.as_tensor(0.01 * np.random.default_rng(2).standard_normal(4000))
    one = [FitRecord("a", values, 1000.0, observed=Observed("velocity"))]
    assert noise_of(one, [], measurement)[2].value == pytest.approx(0.01, rel=0.1)
    channels["velocity"] = Channel("velocity", np.zeros(1), "1", rounding=0.05)
    assert noise_of(one, [], measurement)[2].value == pytest.approx(0.05, rel=1e-6)
