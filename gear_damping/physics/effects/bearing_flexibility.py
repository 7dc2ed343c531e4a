"""Flexibility of the pinion's bearing."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import ExtraStates, TransmissionErrorSource, Values

PLACE, RATE = "bearing_flexibility.displacement", "bearing_flexibility.velocity"
STIFFNESSES = (1.5, 6.0, 30.0, 120.0)  # of the mean mesh stiffness
MASSES = (5.5, 15.0)  # of the equivalent mass; a disc alone has twice it
HEAVIEST = 100.0  # of it: no pinion with its shaft weighs more
LIGHTEST = 0.5  # of it: less than the lightest pinion, a ring of its outer radius


def _beside_the_mesh(rig: Rig) -> tuple[Recipe, ...]:
    equivalent = rig.values["equivalent_mass"]
    within = {"bearing_flexibility.mass": (LIGHTEST * equivalent, HEAVIEST * equivalent)}
    return tuple(
        Recipe({"stiffness": k}, non_nested=True, scanned={"mass": m, "damping_ratio": 0.02}, within=within)
        for k in STIFFNESSES
        for m in MASSES
    )


class BearingFlexibility(ExtraStates, TransmissionErrorSource):
    """The pinion gives way along the line of action: one more degree of freedom y. The gear's bearing does the same."""

    name = "bearing_flexibility"
    equation = "delta = x - e - y, m_b y'' + c_b y' + k_b y = N + F_d, c_b = 2 zeta_b sqrt(k_b m_b)"
    reference = "Özgüven (1991), J. Sound Vib. 145(2)"
    parameters: ClassVar = (
        Parameter("stiffness", "N/m", 5e8, "k_b", 1e3, 1e14),
        Parameter("mass", "kg", 2.0, "m_b, pinion and its part of the shaft", 1e-3, 1e4),
        Parameter("damping_ratio", "1", 0.02, "zeta_b, of the bearing alone", 0, 10),
    )
    needs: ClassVar = (Trait.TEETH,)
    states: ClassVar = {"displacement": "m", "velocity": "m/s"}
    cause: ClassVar = Cause(
        "the flexibility of a bearing",
        _beside_the_mesh,
        separated_by="bearing",
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The bearing, and a bound on the fastest rate of mesh and bearing together."""
        stiffness, mass = values["stiffness"], values["mass"]
        damping = 2 * values["damping_ratio"] * torch.sqrt(stiffness * mass)
        mesh = base["mean_stiffness"]
        fastest = torch.sqrt(mesh / base["equivalent_mass"] + (mesh + stiffness) / mass)
        slowest = torch.sqrt(stiffness / mass)
        found = {"stiffness": stiffness, "mass": mass, "damping": damping}
        return found | {"slowest_rate": slowest, "fastest_rate": fastest}

    def initial(self, p: Values, base: Values) -> dict[str, Tensor]:
        """Where the mean load holds it."""
        place = base["mean_load"] / p["stiffness"]
        return {"displacement": place, "velocity": torch.zeros_like(place)}

    def error(self, at: Kinematics, p: Values) -> tuple[Tensor, Tensor]:
        """How far the pinion has given way."""
        return at.extra[PLACE], at.extra[RATE]

    def state_rates(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """Pressed by the mesh force and the forces on the bearing."""
        force = at.mesh_force + at.bearing_force - p["stiffness"] * at.extra[PLACE] - p["damping"] * at.extra[RATE]
        return {"displacement": at.extra[RATE], "velocity": force / p["mass"]}
