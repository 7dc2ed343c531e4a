"""The slow change of a shaft's speed: fitted beside the vibration, and only where it is one."""

import math
from dataclasses import replace

import numpy as np
import pytest
import torch
import yaml
from closed_forms import free_decay
from numpy.polynomial.legendre import legval

from gear_damping.explanation.evidence.records import evidence_of
from gear_damping.explanation.evidence.slow_rotation import gear_ratio, with_slow_rotation
from gear_damping.identification.output_error.least_squares import fit
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FitRecord, FreeParameter, Observed, SlowChange
from gear_damping.identification.output_error.segments import part
from gear_damping.measurement.load import load_measurement
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator

STIFFNESS, DAMPING, RATE, SAMPLES = (2 * math.pi * 20) ** 2, 3.0, 1000.0, 900
SIZES = (0.3, -0.2, 0.05)
SLOW = SlowChange(3, SAMPLES / RATE, 0.5)


def decay(slow=SLOW):
    """The velocity of a decay in closed form, and a speed that sways."""
    time = np.arange(SAMPLES) / RATE
    seen = free_decay(time, 1.0, DAMPING, STIFFNESS, 0.01, 0.0)[1]
    sway = legval(2 * time / SLOW.span - 1, (0.0, *SIZES))
    observed = Observed("velocity", offset=True, slow=slow)
    return FitRecord("run", torch.as_tensor(seen + sway), RATE, observed=observed)


def fitted(records):
    free = [
        FreeParameter("stiffness", STIFFNESS, logarithmic=True),
        FreeParameter("viscous_damping.damping_coefficient", 1.2 * DAMPING, logarithmic=True),
    ]
    problem = OutputErrorProblem(Model(Oscillator(), [ViscousDamping()]), {"amplitude": 0.01}, free, records)
    found = fit(problem, torch.zeros(1, 2, dtype=torch.float64))
    return {name: float(value) for name, value in problem.unknowns.parameters(found.shared).items()}


@pytest.mark.parametrize("cuts", [1, 3])
def test_the_sway_is_found_beside_the_motion_over_the_whole_record_and_in_segments(cuts):
    length = SAMPLES // cuts
    whole = decay()
    segmented = [part(whole, slice(i * length, (i + 1) * length)) for i in range(cuts)] if cuts > 1 else [whole]
    found = fitted(segmented)
    assert found["viscous_damping.damping_coefficient"] == pytest.approx(DAMPING, rel=1e-3)
    for k, size in enumerate(SIZES):
        assert found[f"offset.velocity[{k + 1}]@run"] == pytest.approx(size, abs=1e-3)


def test_without_it_the_sway_is_taken_for_motion():
    found = fitted([decay(slow=None)])
    assert abs(found["viscous_damping.damping_coefficient"] / DAMPING - 1) > 0.02


def gears(speed=200.0, seconds=0.1, channel="gear_speed"):
    samples = round(seconds * RATE)
    response = torch.zeros(samples, dtype=torch.float64)
    other = (Observed("pinion_speed"), response)
    conditions = {"pinion_speed": speed}
    return FitRecord("run", response, RATE, conditions=conditions, observed=Observed(channel), others=(other,))


def test_speeds_of_shafts_sway_by_a_share_of_what_they_are():
    (found,) = with_slow_rotation([gears()], 0.5)
    assert found.observed.slow == SlowChange(3, 0.1, pytest.approx(1e-3 * 200 * 0.5))
    assert found.others[0][0].slow.deviation == pytest.approx(1e-3 * 200)


def test_nothing_as_quick_as_a_turn_of_the_slower_shaft_is_taken():
    turn = 2 * math.pi / 100  # of a gear that turns half as fast as the pinion
    (found,) = with_slow_rotation([gears(seconds=8.4 * turn)], 0.5)
    assert found.observed.slow.terms == 8
    (short, long) = with_slow_rotation([gears(seconds=4.4 * turn), gears(seconds=100 * turn)], 0.5)
    assert short.observed.slow == long.observed.slow == replace(found.observed.slow, terms=4, span=long.duration)


def test_a_channel_that_is_no_speed_and_a_rig_at_rest_have_none():
    (found,) = with_slow_rotation([gears(channel="transmission_error")], 0.5)
    assert found.observed.slow is None
    (found,) = with_slow_rotation([gears(speed=0.0)], 0.5)
    assert found.observed.slow is None


def test_the_ratio_is_that_of_the_teeth():
    assert gear_ratio({"n_teeth_pinion": 17, "n_teeth_gear": 51}) == pytest.approx(1 / 3)
    assert gear_ratio({}) == 0.5


@pytest.mark.parametrize("load", ["balanced", "held", {"column": "T2", "unit": "N*m"}])
def test_measured_torques_tell_how_shafts_speed_up_but_for_their_noise(tmp_path, load):
    time = np.arange(2000) / 20e3
    columns = {"theta": 100 * time, "w2": 50 + 0.01 * np.sin(3000 * time), "T1": 20 + 0 * time, "T2": 40 + 0 * time}
    columns |= {name: columns[name] + np.random.default_rng(1).normal(0, 1e-3, 2000) for name in ("T1", "T2", "w2")}
    table = np.column_stack(list(columns.values()))
    np.savetxt(tmp_path / "a.csv", table, delimiter=",", header=",".join(columns), comments="")
    channels = {"sampling_rate": "20 kHz", "gear_torque": load}
    for name, column, unit in (
        ("pinion_angle", "theta", "rad"),
        ("gear_speed", "w2", "rad/s"),
        ("pinion_torque", "T1", "N*m"),
    ):
        channels[name] = {"column": column, "unit": unit}
    parameters = {"n_teeth_pinion": 20, "n_teeth_gear": 40}
    content = {"system": "gear_pair", "parameters": parameters, "records": [{"file": "a.csv", "channels": channels}]}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(content))
    record = evidence_of(load_measurement(tmp_path / "measurement.yaml")).records[0]
    assert record.observed.slow.deviation == pytest.approx(1e-3 * 100 * 0.5, rel=1e-3)
