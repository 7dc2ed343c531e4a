"""Values of a system that one of its options decides: what is refused on the command line, in a file and in Python."""

from collections.abc import Container
from dataclasses import dataclass

from gear_damping.config.source import Origin, spellings
from gear_damping.physics.model import Model
from gear_damping.physics.terms import TANGENTIAL, Sensor

PRINTED = ("equivalent_mass", "inertia_pinion", "inertia_gear", "module", "pressure_angle")  # as_printed has its own
ON_TEETH = "tooth_friction"  # the effect that takes lever arms from inertias, module and pressure angle
MODE, HELD, BALANCED = "gear_torque_mode", "held", "balanced"
TORQUE = "gear_torque"
UNSAID = "must be given where it is held"  # the rule of such a torque


@dataclass(frozen=True)
class Decided:
    """Why a value has no effect.

    Args:
        option: The option of the system that decides it.
        rule: What holds.
        remedy: What helps.
    """

    option: str
    rule: str
    remedy: str


def decided_by_options(model: Model, group: str = "") -> dict[str, Decided]:
    """Parameters of a model's system that its options decide, by name.

    Args:
        model: The model.
        group: What stands before a key on the command line and in files; empty in Python.
    """
    chosen, found = model.system.chosen, {}
    if chosen.get(MODE) == BALANCED:
        rule = f"has no effect where {group}{MODE} is {BALANCED}: it follows from the pinion's torque"
        instead = f"add {group}{MODE}={HELD}" if group else f"make the system with {MODE}='{HELD}'"
        found[TORQUE] = Decided(MODE, rule, f"leave it out, or {instead}")
    if chosen.get("as_printed"):
        is_read = chosen.get(MODE) == HELD or any(one.name == ON_TEETH for one in model.effects)
        beside = f"{group}as_printed={'true' if group else True}"
        rule = f"has no effect beside {beside}: mass and base circles are those that the paper prints"
        printed = Decided("as_printed", rule, "leave one of them out")
        found |= dict.fromkeys(PRINTED[:1] if is_read else PRINTED, printed)
    return found


def unseen_sensors(model: Model) -> list[tuple[str, str, str]]:
    """Sensor effects of a model that nothing simulated shows, each with rule and remedy.

    A simulation gives the response and the angles of the shafts. What acts on an accelerometer on a shaft shows in
    measured records, which say where it sits.
    """
    rule = "has no effect on what a simulation gives: it acts on an accelerometer that sits on a shaft"
    remedy = "leave it out; task=explain and task=identify take it where such an acceleration was measured"
    effects = (one for one in model.effects if isinstance(one, Sensor) and one.channel == TANGENTIAL)
    return [(one.name, rule, remedy) for one in effects]


def holds_unsaid(model: Model, given: Container[str]) -> bool:
    """Whether the torque on the gear of a model is held, and nobody says at what.

    Args:
        model: The model.
        given: Names of what is given.
    """
    return model.system.chosen.get(MODE) == HELD and TORQUE not in given


def decided_in_one_file(model: Model, origin: Origin) -> dict[str, Decided]:
    """Those that one file or mapping gives beside the option that decides them, by full key.

    An option that comes on top of a file, as from the command line, takes the place of what the file has.
    """
    found = {}
    for name, decided in decided_by_options(model, "simulator.").items():
        for key in spellings(f"simulator.{name}"):
            if origin.is_of_the_file(key) and origin.rank(f"simulator.{decided.option}") <= origin.rank(key):
                found[key] = decided
    return found
