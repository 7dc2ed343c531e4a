"""A system of one's own in a measurement.yaml: what the file may hold follows from the system's declaration."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType as Frozen
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import create_model

from gear_damping.errors import InputError, Problem
from gear_damping.measurement import layout
from gear_damping.measurement.quantities import Measured
from gear_damping.measurement.record import Quantity
from gear_damping.measurement.rig import KNOWN, START
from gear_damping.schema.mappings import Declared, Item, Listed, key
from gear_damping.schema.values import OneOf

if TYPE_CHECKING:
    from gear_damping.physics.parameter import Parameter
    from gear_damping.physics.systems.base import System

KEY = "measurement.plugins"
OF_MOTION = ("m", "m/s", "m/s^2")  # SI units of a motion and its rates
NONE: Mapping[str, "type[System]"] = Frozen({})


def own_systems(plugins: Sequence[str | Path]) -> "dict[str, type[System]]":
    """The systems that a user's files declare, by name.

    Raises:
        InputError: a file is missing, cannot be loaded, or declares a system that cannot be measured.
    """
    if not plugins:
        return {}
    from gear_damping.physics.system_files import load_systems

    found = {}
    for path in map(Path, plugins):
        found |= load_systems(path, KEY)
    wrong = [Problem(KEY, rule, kind.name, _REMEDY) for kind in found.values() for rule in _unmeasurable(kind)]
    if wrong:
        raise InputError(wrong)
    return found


_REMEDY = "derive it from Swinging and add the trait mass; records of any other rig are those of an oscillator"


def _unmeasurable(kind: "type[System]") -> list[str]:
    """Why no records of it can be read."""
    from gear_damping.physics.systems.known import SYSTEMS
    from gear_damping.physics.systems.traits import Trait

    rules = [f"repeats the name '{kind.name}'"] if kind.name in SYSTEMS else []
    if not kind.has(Trait.REST, Trait.MASS):
        rules.append("has no records: they need the traits rest and mass")
    known = set(layout.OscillatorChannels.model_fields)
    if unknown := sorted({*kind.responses, *kind.inputs} - known):
        rules.append(f"names the channels {unknown}, which no record has")
    return rules


def si_units(kind: "type[System]") -> dict[str, str]:
    """The SI unit of every channel of a system."""
    return dict(zip(kind.responses, OF_MOTION, strict=False)) | kind.inputs


def file_of(kind: "type[System]") -> type[layout.OscillatorFile]:
    """The layout of its measurement.yaml: channels as of an oscillator, its own parameters, all in SI."""
    from gear_damping.physics.systems.swinging import MOTION

    solver = {one.name for one in MOTION}
    own = {one.name: _field(one, kind) for one in kind.parameters if one.name not in solver}
    own["damping_coefficient"] = _quantity("N*s/m", "not negative", "Coefficient of the viscous damping.", START)
    own["damping_ratio"] = _quantity("1", "not negative", "Its ratio to the critical one, instead.", START)
    parameters = create_model("OwnParameters", __base__=_OwnParameters, **own)
    parameters.title = kind.name
    record = create_model("OwnRecord", __base__=layout.OscillatorRecord)
    system = (Annotated[str, OneOf((kind.name,))], key("What was measured.", "model", missing=kind.name))
    listed = Annotated[list[Annotated[record, Item()]], Listed("record", layout.BEGIN)]
    fields = {
        "system": system,
        "parameters": (parameters, key(layout.NOMINAL, "fit")),
        "records": (listed, key("The records, each with its file.", "values", missing=layout.BEGIN)),
    }
    return create_model("OwnFile", __base__=layout.OscillatorFile, **fields)


class _OwnParameters(Declared):
    """Nominal values of a system of one's own."""

    damping_ratio: Any = None
    damping_coefficient: Any = None

    def model_post_init(self, context: Any) -> None:
        """One damping, not two."""
        if self.given("damping_ratio") and self.given("damping_coefficient"):
            rule, value = "damping_coefficient gives the damping too", self.damping_ratio.value
            raise InputError(Problem("damping_ratio", rule, value, "keep the one that is right"))


def _field(declared: "Parameter", kind: "type[System]") -> tuple[Any, Any]:
    """A parameter as a key of the file, within its declared bounds."""
    is_fitted = declared.name in (kind.spring, *kind.gains.values())
    bounds = (declared.lower, declared.upper)
    meaning = f"{declared.meaning[:1].upper()}{declared.meaning[1:]}."
    return _quantity(declared.unit, "any", meaning, START if is_fitted else KNOWN, bounds)


def _quantity(
    unit: str, sign: str, meaning: str, acts: str, within: tuple[float, float] | None = None
) -> tuple[Any, Any]:
    return Annotated[Quantity, Measured(unit, sign, uncertain=True, within=within)], key(meaning, acts)
