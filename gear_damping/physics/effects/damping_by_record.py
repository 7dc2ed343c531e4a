"""Viscous damping that is another one in every record."""

from typing import ClassVar

from torch import Tensor

from gear_damping.physics.cause import Cause, of_several_records
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import DampingForce, Values


class DampingByRecord(DampingForce):
    """What the temperature of the oil, a mounting or wear change between records, and nothing within one."""

    name = "damping_by_record"
    equation = "F_d = s z delta', with z of the record's own"
    reference = "random effects: Laird & Ware (1982), Biometrics 38(4)"
    parameters: ClassVar = (
        Parameter("spread", "N*s/m", 10.0, "s, standard deviation of the damping coefficient between records", 0, 1e12),
        Parameter("level", "1", 1.0, "z, of the record: by how many of them it is off the mean", -1e3, 1e3),
    )
    dissipative = True  # with the mean, which it is off
    cause: ClassVar = Cause(
        "a damping that differs from record to record, as with the temperature of the oil",
        of_several_records,
        separated_by="ring_down",
        turns_with="record",
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The coefficient beyond the mean one, and the rate at which it alone brings a velocity to rest."""
        coefficient = values["spread"] * values["level"]
        return {"coefficient": coefficient, "fastest_rate": coefficient.abs() / base["equivalent_mass"]}

    def damping_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant."""
        return p["coefficient"] * at.delta_rate
