"""A record without a shaft angle: its speed may vary a little, and only then."""

from dataclasses import make_dataclass
from types import SimpleNamespace

import numpy as np
import pytest
import torch
from scipy.integrate import quad

from gear_damping.explanation.evidence.unsteady import has_unsteady_shafts, with_unsteady_shafts
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.physics.systems.gear_pair import GearPair

SPEED, RATE, SAMPLES = 300.0, 10e3, 1000


def record(own=(), **inputs):
    return FitRecord("run", torch.zeros(SAMPLES), RATE, inputs, {"pinion_speed": SPEED}, own=own)


def unsteady(one):
    evidence = make_dataclass("Records", ["fit", "holdout"], frozen=True)((one,), ())
    return with_unsteady_shafts(evidence).fit


def test_a_shaft_without_an_angle_has_a_speed_near_the_stated_one():
    found = {parameter.name: parameter for parameter in unsteady(record())[0].own}
    assert {*found} == {"pinion_speed", "pinion_acceleration", "pinion_jerk"}
    assert found["pinion_speed"].start == SPEED
    assert found["pinion_speed"].deviation == pytest.approx(1e-3 * SPEED)
    rate = 2 * np.pi * RATE / SAMPLES
    assert found["pinion_acceleration"].deviation == pytest.approx(1e-3 * SPEED * rate)
    assert found["pinion_jerk"].deviation == pytest.approx(1e-3 * SPEED * rate**2)
    assert all(p.lower < p.start < p.upper < p.start + 10 * p.deviation for p in found.values())


def test_what_the_file_says_of_the_speed_stays():
    said = FreeParameter("pinion_speed", SPEED, 3.0, deviation=3.0, expected=SPEED)
    own = unsteady(record((said,)))[0].own
    assert own[0] is said
    assert [p.name for p in own].count("pinion_speed") == 1
    assert len(own) == 3


def test_a_measured_angle_is_followed_as_it_is():
    found = unsteady(record(pinion_angle=torch.zeros(SAMPLES)))
    assert found[0].own == ()
    assert not has_unsteady_shafts(found)
    assert has_unsteady_shafts(unsteady(record()))


@pytest.mark.parametrize("later", [0.0, 0.4])
def test_angle_and_speed_of_a_shaft_that_speeds_up(later):
    values = {"pinion_speed": 3.0, "pinion_acceleration": -2.0, "pinion_jerk": 1.2, "pinion_angle": 0.1}
    values |= {"angle_error": 0.04, "angle_error_rate": -0.3}
    given = {**values, "n_teeth_pinion": 20.0, "n_teeth_gear": 50.0, "mesh_phase": 0.3, "gear_phase": 0.2}
    given = {name: torch.tensor([value], dtype=torch.float64) for name, value in given.items()}
    given |= GearPair().begun_later(given, torch.tensor([later], dtype=torch.float64))
    given |= {"contact_advance": torch.zeros(1), "base_radius_pinion": torch.ones(1)}
    turned = GearPair().rotations(torch.tensor([0.7], dtype=torch.float64), {}, given, torch.ones(1))
    end = 0.7 + later
    angle = 0.1 + 0.04 - 0.3 * end + quad(lambda t: 3.0 + quad(lambda s: -2.0 + 1.2 * s, 0, t)[0], 0, end)[0]
    speed = 3.0 - 0.3 + quad(lambda t: -2.0 + 1.2 * t, 0, end)[0]
    found = SimpleNamespace(**{name: (float(r.angle), float(r.speed)) for name, r in turned.items()})
    assert found.pinion == pytest.approx((angle, speed), rel=1e-12)
    assert found.gear == pytest.approx((0.4 * angle + 0.2, 0.4 * speed), rel=1e-12)
    assert found.mesh == pytest.approx((20 * angle + 0.3, 20 * speed), rel=1e-12)
