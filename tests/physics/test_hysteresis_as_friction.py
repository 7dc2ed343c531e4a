"""What a hysteresis comes to where it yields early: its loss over a cycle is that of a dry friction."""

import numpy as np
import pytest

from gear_damping.physics.effects.hysteretic_damping import HystereticDamping

ACTS_AS = HystereticDamping.cause.acts_as


def loss(share, yields, exponent, amplitude, stiffness):
    """Of a cycle of a harmonic motion, by small steps of the law as Bouc and Wen have it."""
    phase = np.linspace(0, 6 * np.pi, 600_001)
    path, z, lost = amplitude * np.sin(phase), 0.0, 0.0
    for k, move in enumerate(np.diff(path)):
        z += move - abs(z / yields) ** exponent * (move + abs(move) * np.sign(z)) / 2
        lost += share * stiffness * z * move * (k >= 400_000)  # of the last cycle
    return lost


@pytest.mark.parametrize(("yields", "exponent"), [(0.02, 1.0), (0.05, 2.0), (0.01, 0.6)])
def test_what_yields_early_loses_what_a_dry_friction_does(yields, exponent):
    amplitude, stiffness, share = 0.4, 20.0, 1.3
    words, force = ACTS_AS(
        {"share": share, "yield_deflection": yields * amplitude, "exponent": exponent}, stiffness, amplitude
    )
    assert "acts as a dry friction" in words
    assert 4 * force * amplitude == pytest.approx(
        loss(share, yields * amplitude, exponent, amplitude, stiffness), rel=0.15
    )


def test_what_hardly_yields_is_no_friction():
    assert ACTS_AS({"share": 0.1, "yield_deflection": 0.2, "exponent": 1.0}, 20.0, 0.4) is None
