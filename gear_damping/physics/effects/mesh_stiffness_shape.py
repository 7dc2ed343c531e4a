"""The shape of the mesh stiffness beyond its ideal wave."""

from typing import ClassVar

from torch import Tensor

from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.shaft_order import periodic
from gear_damping.physics.shapes import padded, same_length
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import StiffnessFactor, Values


class MeshStiffnessShape(StiffnessFactor):
    """Free harmonics of the mesh: what calibration settles before any cause is named."""

    name = "mesh_stiffness_shape"
    equation = "k (1 + sum_h a_h cos(h theta_M) + b_h sin(h theta_M))"
    reference = "Weber & Banaschek (1953), Vieweg; the shape of real teeth is not a rectangle"
    parameters: ClassVar = (
        Parameter("in_phase", "1", (0.0, 0.0), "a_h by harmonic", -1, 1, vector=True),
        Parameter("quadrature", "1", (0.0, 0.0), "b_h by harmonic", -1, 1, vector=True),
    )
    needs: ClassVar = (Trait.TEETH,)

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The lists, once they are of one length."""
        same_length(self.name, values, "in_phase", "quadrature")
        return padded(values)

    def factor(self, at: Kinematics, p: Values) -> Tensor:
        """The factor at this mesh angle."""
        return 1 + periodic(at.mesh, p["in_phase"], p["quadrature"])
