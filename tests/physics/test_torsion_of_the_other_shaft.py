"""A soft shaft on one side is told as one on the other, by the equations of motion of all bodies."""

import re

import numpy as np
import pytest

from gear_damping.physics.effects.shaft_torsion import ShaftTorsion

J, R, MESH = {"pinion": 0.06, "gear": 0.03}, {"pinion": 0.108, "gear": 0.082}, 5e7  # kg m^2, m, N/m
BASE = {
    "base_radius_pinion": R["pinion"], "base_radius_gear": R["gear"], "inertia_pinion": 0.06, "inertia_gear": 0.03,
    "equivalent_mass": 1 / (R["pinion"] ** 2 / 0.06 + R["gear"] ** 2 / 0.03),
}  # fmt: skip


def rates(shaft, stiffness, machine):
    """The two rates of a machine, a shaft and two gears that mesh, in 1/s, by the matrices of three inertias."""
    own, other = J[shaft], J["gear" if shaft == "pinion" else "pinion"]
    r_own, r_other = R[shaft], R["gear" if shaft == "pinion" else "pinion"]
    spring = np.array([[stiffness, -stiffness, 0], [-stiffness, stiffness, 0], [0, 0, 0]])
    mesh = np.array([0, r_own, -r_other])
    matrix = np.diag([1 / machine, 1 / own, 1 / other]) @ (spring + MESH * np.outer(mesh, mesh))
    return np.sqrt(np.sort(np.linalg.eigvals(matrix).real)[1:])


@pytest.mark.parametrize(("own", "other"), [("pinion", "gear"), ("gear", "pinion")])
def test_the_other_shaft_and_machine_have_the_same_rates(own, other):
    values = {"stiffness": 3e4, "motor_inertia": 0.02, "damping_ratio": 0.03}
    said = ShaftTorsion.cause.also({"shaft": own}, values, BASE)
    assert f"a shaft of the {other} of" in said
    stiffness, machine = (float(one) for one in re.findall(r"of ([\d.e+]+) (?:N|kg)", said))
    np.testing.assert_allclose(rates(other, stiffness, machine), rates(own, 3e4, 0.02), rtol=5e-3)


def test_nothing_is_said_where_no_machine_is_heavy_enough():
    values = {"stiffness": 3e4, "motor_inertia": 5.0, "damping_ratio": 0.03}
    light = {"inertia_pinion": 0.006, "equivalent_mass": 1 / (R["pinion"] ** 2 / 0.006 + R["gear"] ** 2 / 0.03)}
    assert ShaftTorsion.cause.also({"shaft": "pinion"}, values, BASE | light) == ""
