"""Stiffness that is another one in every record."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, Rig, of_several_records, where_there_is_a_spring
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import ElasticForce, Values


def _of_springs(rig: Rig) -> tuple[Recipe, ...]:
    """Its variant where something pulls the rig back."""
    return where_there_is_a_spring(*of_several_records(rig))(rig)


class StiffnessByRecord(ElasticForce):
    """What temperature, tension, an added mass or a mounting changes between records, and nothing within one."""

    name = "stiffness_by_record"
    equation = "N + s z delta, with z of the record's own"
    reference = "random effects: Laird & Ware (1982), Biometrics 38(4)"
    needs: ClassVar = (Trait.REST,)
    told_alone: ClassVar = "stiffness"
    parameters: ClassVar = (
        Parameter("spread", "N/m", 1e6, "s, standard deviation of the stiffness between records", 0, 1e14),
        Parameter("level", "1", 1.0, "z, of the record: by how many of them it is off the mean", -1e3, 1e3),
    )
    cause: ClassVar = Cause(
        "a stiffness, or a mass, that differs from record to record, as with the temperature or the mounting",
        _of_springs,
        separated_by="remount",
        turns_with="record",
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The coefficient beyond the mean one, and the rate at one natural length of deflection."""
        coefficient = values["spread"] * values["level"]
        stiffness = base["mean_stiffness"] + coefficient.abs()
        return {"coefficient": coefficient, "fastest_rate": torch.sqrt(stiffness / base["equivalent_mass"])}

    def elastic_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant."""
        return p["coefficient"] * at.deflection
