"""What measurement.yaml says of a rig: the parameters and conditions of each system."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType as Frozen
from typing import Annotated, Any, ClassVar

from pydantic import model_validator

from gear_damping.measurement import other_words as words
from gear_damping.measurement.quantities import Measured, Ratio
from gear_damping.measurement.record import Quantity
from gear_damping.schema.mappings import Declared, key
from gear_damping.schema.values import OneOf, refuse
from gear_damping.units import spoken

GEAR_TORQUE_MODES = ("balanced", "held")
KNOWN = "known, or a prior with its uncertainty"
START = "start of the fit, or a prior with its uncertainty"
MORE_PAIRS = (
    "check the value; where two and three pairs alternate, as of helical teeth, state 1 and what is beyond the whole "
    "number, and the stiffness of three pairs and of two"
)
UNDAMPED = "leave the key out where the damping is not known: the fit then begins at a usual one"
FALLS_AWAY = (
    "leave the key out where its value is not known; a linear oscillator has a spring that pulls back, and a rig that "
    "is pushed away from its place of rest, as a buckled beam, is outside of what one is here"
)
# What people know of a rig, and what it is here.
_PER_MASS = "an oscillator is stated per unit of its mass, or of its inertia where it turns"
_OF_A_MASS = "write force_gain: 1/m in 1/kg for a force in N and a motion in m, and stiffness: k/m in 1/s^2"
_OF_AN_INERTIA = "write force_gain: 1/J in rad/s^2/(N*m) for a torque in N*m and an angle in rad, and stiffness: k/J"
_OF_A_LENGTH = "write the stiffness of a pendulum, g/l: for .5 m stiffness: {value: 19.6, unit: 1/s^2}"
_OF_A_FREQUENCY = "write stiffness: (2 pi f)^2 in 1/s^2, for 1.3 Hz {value: 66.7, unit: 1/s^2}"
_OF_A_GEAR = "write the ratio as gain of the channel that was measured behind the gear: its values are divided by it"
OF_A_RIG = Frozen(
    {
        "mass": (_PER_MASS, _OF_A_MASS),
        "inertia": (_PER_MASS, _OF_AN_INERTIA),
        "moment_of_inertia": (_PER_MASS, _OF_AN_INERTIA),
        "length": (_PER_MASS, _OF_A_LENGTH),
        "natural_frequency": ("its stiffness over its mass says how fast it swings", _OF_A_FREQUENCY),
        "eigenfrequency": ("its stiffness over its mass says how fast it swings", _OF_A_FREQUENCY),
        "gear_ratio": ("it is one mass that moves, and a gear before it scales what is read", _OF_A_GEAR),
    }
)
_TEETH = "write n_teeth_pinion and n_teeth_gear; a worm or a gearbox of many teeth is declared as system: oscillator"


@dataclass(frozen=True)
class Load(Measured):
    """A quantity, or a word that says what it does."""

    def read(self, value: Any, name: str) -> Quantity | str:
        """The word or the quantity in SI."""
        is_word = isinstance(value, str) and spoken(value) is None
        return OneOf(GEAR_TORQUE_MODES).read(value, name) if is_word else super().read(value, name)

    def says(self) -> str:
        """The unit and the words."""
        return f"{super().says()}; or {OneOf(GEAR_TORQUE_MODES).says()}"


class GearParameters(Declared):
    """Nominal values of a gear pair."""

    title: ClassVar[str] = "a gear_pair"
    refused: ClassVar[Frozen[str, tuple[str, str]]] = Frozen({"gear_ratio": ("its teeth say the ratio", _TEETH)})
    meant: ClassVar[Mapping[str, str]] = words.OF_GEAR_PARAMETERS
    n_teeth_pinion: Annotated[Quantity, Measured("1", whole=True, within=(5, 500))] = key(
        "Teeth of the pinion.", "known"
    )
    n_teeth_gear: Annotated[Quantity, Measured("1", whole=True, within=(5, 1000))] = key("Teeth of the gear.", "known")
    module: Annotated[Quantity, Measured("m", uncertain=True, within=(1e-4, 0.1))] = key(
        "Module of the teeth; of helical ones the transverse one, the normal one over cos(helix angle).", KNOWN
    )
    pressure_angle: Annotated[Quantity, Measured("rad", uncertain=True, within=(0.1, 0.7))] = key(
        "Pressure angle; of helical teeth the transverse one, whose tangent is that of the normal one over "
        "cos(helix angle).",
        KNOWN,
    )
    inertia_pinion: Annotated[Quantity, Measured("kg*m^2", uncertain=True, within=(1e-9, 1e4))] = key(
        "Inertia of the pinion.", KNOWN
    )
    inertia_gear: Annotated[Quantity, Measured("kg*m^2", uncertain=True, within=(1e-9, 1e5))] = key(
        "Inertia of the gear.", KNOWN
    )
    mesh_stiffness_max: Annotated[Quantity, Measured("N/m", uncertain=True, within=(0, 1e14))] = key(
        "Mesh stiffness with the larger number of tooth pairs in contact.", START
    )
    mesh_stiffness_min: Annotated[Quantity, Measured("N/m", uncertain=True, within=(0, 1e14))] = key(
        "Mesh stiffness with the smaller number.", START
    )
    contact_ratio: Annotated[Quantity, Measured("1", uncertain=True, within=(1, 2), beyond=MORE_PAIRS)] = key(
        "Contact ratio; of helical teeth in contact by two and three pairs 1 less, 1.3 of 2.3.", START
    )
    damping_ratio: Annotated[Quantity, Ratio("1", uncertain=True, excluded=UNDAMPED)] = key(
        "Viscous damping ratio of the mesh.", START
    )
    equivalent_mass: Annotated[Quantity, Measured("kg", uncertain=True, within=(0, 1e5))] = key(
        "Mass along the line of action, instead of the two inertias.", KNOWN
    )
    backlash_gap: Annotated[Quantity, Measured("m", "not negative", uncertain=True, within=(0, 0.01))] = key(
        "Whole clearance between the flanks; 0 means none.", KNOWN
    )
    torque_gain: Annotated[Quantity, Measured("1", "not zero", uncertain=True, within=(-1e3, 1e3))] = key(
        "True torque = torque_gain * read + torque_offset.", KNOWN
    )
    torque_offset: Annotated[Quantity, Measured("N*m", "any", uncertain=True, within=(-1e6, 1e6))] = key(
        "See torque_gain.", KNOWN
    )

    @model_validator(mode="after")
    def _one_mass(self) -> "GearParameters":
        inertias = [name for name in ("inertia_pinion", "inertia_gear") if self.given(name)]
        if self.given("equivalent_mass") and inertias:
            rule = f"{' and '.join(inertias)} give the mass along the line of action too"
            refuse(rule, self.equivalent_mass.value, "keep the two inertias or equivalent_mass", "equivalent_mass")
        if len(inertias) == 1:
            (missing,) = {"inertia_pinion", "inertia_gear"} - {*inertias}
            remedy = (
                "give it too, or equivalent_mass instead of both: a usual one beside it would be no mass of this rig"
            )
            refuse(f"is missing beside {inertias[0]}", None, remedy, missing)
        if self.mesh_stiffness_max and self.mesh_stiffness_min:
            most, least = self.mesh_stiffness_max.value, self.mesh_stiffness_min.value
            if least > most:
                remedy = (
                    "exchange the two; where it is so that more pairs are the softer ones, as on a wide helix, "
                    "contact_ratio is then 1 and the share of the mesh period with the larger one"
                )
                refuse("must not lie above mesh_stiffness_max", least, remedy, "mesh_stiffness_min")
        return self


class OscillatorParameters(Declared):
    """Nominal values of a mass-normalised oscillator."""

    title: ClassVar[str] = "an oscillator"
    refused: ClassVar[Frozen[str, tuple[str, str]]] = OF_A_RIG
    meant: ClassVar[Mapping[str, str]] = words.OF_AN_OSCILLATOR
    stiffness: Annotated[Quantity, Measured("1/s^2", "not negative", uncertain=True, excluded=FALLS_AWAY)] = key(
        "Stiffness over mass; 0 means that there is no spring.", START
    )
    damping_coefficient: Annotated[Quantity, Measured("1/s", uncertain=True, excluded=UNDAMPED)] = key(
        "Viscous damping over mass.", START
    )
    damping_ratio: Annotated[Quantity, Ratio("1", uncertain=True, excluded=UNDAMPED)] = key(
        "Viscous damping over the critical one, instead of damping_coefficient.", START
    )
    force_gain: Annotated[Quantity, Measured("own", "not zero", uncertain=True)] = key(
        "Acceleration per unit of the force as it was read.", START
    )

    @model_validator(mode="after")
    def _one_damping(self) -> "OscillatorParameters":
        if not self.given("damping_ratio"):
            return self
        if self.given("damping_coefficient"):
            rule = "damping_coefficient gives the damping too"
            refuse(rule, self.damping_ratio.value, "keep the one that is right", "damping_ratio")
        if self.stiffness and self.stiffness.value == 0:
            rule = "without a spring no damping is critical"
            refuse(rule, self.damping_ratio.value, "give damping_coefficient instead", "damping_ratio")
        return self


class GearConditions(Declared):
    """What was constant in a record of a gear pair."""

    title: ClassVar[str] = "a gear_pair"
    meant: ClassVar[Mapping[str, str]] = words.OF_GEAR_CONDITIONS
    pinion_speed: Annotated[Quantity, Measured("rad/s", "any", uncertain=True)] = key(
        "Speed of the pinion. A diagnosis lets it vary by a thousandth within a record without an angle.",
        "angle of the shafts, a prior with its uncertainty; beside a measured angle no more than a check of it",
    )
    pinion_torque: Annotated[Quantity, Measured("N*m", "any", uncertain=True)] = key("Driving torque.", "load")
    gear_torque: Annotated[Quantity | str, Load("N*m", "any", uncertain=True)] = key(
        "Load, positive where it resists; or `balanced` (it follows the pinion's torque) or `held` (it stays at what "
        "balances the mean).",
        "load",
    )


class OscillatorConditions(Declared):
    """What was constant in a record of an oscillator."""

    title: ClassVar[str] = "an oscillator"
    meant: ClassVar[Mapping[str, str]] = words.OF_OSCILLATOR_CONDITIONS
    force: Annotated[Quantity, Measured(None, "any")] = key(
        "Constant force, beside records with another. The same in all it tells nothing: it is left out with a note "
        "where there is no spring, and refused elsewhere.",
        "load",
    )
