"""One broken sample is a fault of the data; a hammer's stroke and a motion's own peaks are none."""

from pathlib import Path

import numpy as np
import pytest

from gear_damping.measurement.record import Channel, Record
from gear_damping.measurement.record_checks import check_record

TIME = np.arange(2000) / 1e3
RING = np.exp(-5 * TIME) * np.cos(2 * np.pi * 30 * TIME)
STROKE = np.where(TIME < 0.004, np.sin(np.pi * TIME / 0.004), 0.0)


def spikes(values):
    channels = {"acceleration": Channel("acceleration", values, "m/s^2")}
    record = Record("one", Path("-"), "", "fit", 1e3, TIME, channels)
    return [finding for finding in check_record(record) if finding.kind == "spike"]


@pytest.mark.parametrize("at", [0, 700, 1999])
@pytest.mark.parametrize("length", [1, 2])
def test_a_broken_sample_is_named(at, length):
    values = RING + 0.01 * np.random.default_rng(1).normal(size=2000)
    at = min(at, 2000 - length)
    values[at : at + length] = -80.0
    found = spikes(values)
    assert [(finding.sample, finding.severity) for finding in found] == [(at, "data_problem")]


@pytest.mark.parametrize("values", [RING, STROKE, np.random.default_rng(2).standard_t(3, 2000), np.sign(RING)])
def test_what_moves_like_that_is_none(values):
    assert spikes(values) == []
