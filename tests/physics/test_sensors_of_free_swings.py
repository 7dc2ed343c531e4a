"""How a low-pass and a delay are tried: not of a free swing; without a spring none slower than the motion."""

from dataclasses import replace

import pytest

from gear_damping.physics.cause import Rig
from gear_damping.physics.effects.sensor_delay import SensorDelay
from gear_damping.physics.effects.sensor_lowpass import SensorLowpass
from gear_damping.physics.systems.traits import Trait

CUTOFF = "sensor_lowpass.cutoff"


def test_of_a_rig_that_coasts_no_sensor_is_slower_than_its_motion():
    values = {"natural_frequency": 0.0, "characteristic_time": 8.0}
    recipes = SensorLowpass.cause.recipes_for(Rig("oscillator", values=values))
    assert {recipe.within[CUTOFF][0] for recipe in recipes} == {0.125}
    assert min(recipe.strengths["cutoff"] for recipe in recipes) > 1.0


def test_beside_a_mode_a_sensor_may_be_slower():
    recipes = SensorLowpass.cause.recipes_for(Rig("oscillator", values={"natural_frequency": 30.0}))
    assert {recipe.options["order"] for recipe in recipes} == {1, 2}
    assert min(recipe.strengths["cutoff"] for recipe in recipes) < 1.0
    assert not any(recipe.within for recipe in recipes)


@pytest.mark.parametrize("sensor", [SensorLowpass, SensorDelay])
def test_of_a_free_swing_none_is_tried(sensor):
    free = Rig("oscillator", values={"natural_frequency": 30.0}, traits=frozenset({Trait.REST}))
    assert sensor.cause.recipes_for(free) == ()
    assert sensor.cause.recipes_for(replace(free, inputs=("force",)))
    assert sensor.cause.recipes_for(replace(free, traits=frozenset({Trait.SHAFTS})))
