"""A ripple of both torques is told as one of the pinion's alone, by the two shafts' equations of motion."""

import re

import numpy as np
import pytest

from gear_damping.physics.cause import Rig
from gear_damping.physics.effects.torque_ripple import TorqueRipple

J, R = (0.0978, 0.00767), (0.156, 0.0677)  # kg m^2 and m, of pinion and gear
BASE = {
    "base_radius_pinion": R[0], "base_radius_gear": R[1], "inertia_pinion": J[0], "inertia_gear": J[1],
    "load_per_pinion_torque": 1 / R[0],
}  # fmt: skip
VALUES = {"amplitude": 12.3, "share": 0.0, "order": 36.0, "phase": 0.0}
BOTH = {"proportional": False, "gear_torque": "follows"}


def acceleration(pinion, gear):
    """Of the transmission error by torques on both shafts, while the mesh force is held."""
    return R[0] * pinion / J[0] + R[1] * gear / J[1]


def test_a_ripple_of_the_pinion_alone_that_does_the_same():
    both = acceleration(VALUES["amplitude"], VALUES["amplitude"] * R[1] / R[0])
    alone = both / acceleration(1.0, 0.0)
    said = TorqueRipple.cause.also(BOTH, VALUES, BASE)
    (size,) = re.findall(r"([\d.]+) N\*m", said)
    assert float(size) == pytest.approx(alone, rel=2e-3)
    assert np.isclose(alone, 41.9, rtol=1e-2)


@pytest.mark.parametrize("other", [{"proportional": True}, {"gear_torque": "stays"}])
def test_nothing_is_said_of_a_share_or_of_what_is_the_pinion_s_already(other):
    assert TorqueRipple.cause.also(BOTH | other, VALUES, BASE) == ""


def test_a_gear_torque_that_is_held_leaves_one_form_and_nothing_to_be_said():
    base = BASE | {"load_per_gear_torque": 2.0}
    rig = Rig("gear_pair", n_teeth_pinion=20, n_teeth_gear=40, on_shafts=True, values=base)
    assert {recipe.options["gear_torque"] for recipe in TorqueRipple.cause.recipes_for(rig)} == {"follows"}
    assert TorqueRipple.cause.also(BOTH, VALUES, base) == ""
