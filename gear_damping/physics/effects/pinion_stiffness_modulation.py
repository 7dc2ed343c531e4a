"""Modulation of the mesh stiffness by the pinion shaft."""

from gear_damping.physics.shaft_order import StiffnessModulation


class PinionStiffnessModulation(StiffnessModulation):
    """The stiffness varies once per turn of the pinion: sidebands of the mesh lines."""

    name = "pinion_stiffness_modulation"
    equation = "k (1 + eps cos(theta_1 + phi))"
    shaft = "pinion"
