"""Eccentricity of the pinion."""

from gear_damping.physics.shaft_order import Eccentricity


class PinionEccentricity(Eccentricity):
    """The pinion runs eccentric: a pure line at its shaft order in the transmission error."""

    name = "pinion_eccentricity"
    equation = "e = E cos(theta_1 + phi), delta = x - e"
    shaft = "pinion"
