"""A sine of the torque at the frequency of the mains may be a hum of the sensor, which is said."""

import pytest

from gear_damping.physics.effects.torque_variation import TorqueVariation


@pytest.mark.parametrize(
    ("form", "frequency", "said"),
    [("sine", 50.006, "50 Hz"), ("sine", 59.8, "60 Hz"), ("sine", 53.0, ""), ("ramp", 50.0, "")],
)
def test_it_is_said_at_50_and_60_hz_alone(form, frequency, said):
    found = TorqueVariation.cause.also({"form": form}, {"sine_frequency": frequency}, {})
    assert bool(found) is bool(said)
    assert said in found
