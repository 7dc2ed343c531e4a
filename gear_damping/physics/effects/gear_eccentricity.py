"""Eccentricity of the gear."""

from gear_damping.physics.shaft_order import Eccentricity


class GearEccentricity(Eccentricity):
    """The gear runs eccentric: a pure line at its shaft order in the transmission error."""

    name = "gear_eccentricity"
    equation = "e = E cos(theta_2 + phi), delta = x - e"
    shaft = "gear"
