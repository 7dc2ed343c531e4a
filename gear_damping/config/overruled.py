"""Values that were given in the experiment or on the command line, and that another value of the group overrules."""

from gear_damping.config.acting import Found
from gear_damping.config.source import ORDER, Origin
from gear_damping.config.whole import Whole
from gear_damping.units import SUFFIXES

PRINTED = ("equivalent_mass", "inertia_pinion", "inertia_gear", "module", "pressure_angle")  # as_printed has its own
ON_TEETH = "tooth_friction"  # the effect that takes lever arms from inertias, module and pressure angle


def given_on_top(name: str, origin: Origin, group: str = "simulator", after: str = "family") -> str | None:
    """The key under which a file that comes after a group's, or the command line, gives a value; None where none does.

    Args:
        name: Of the value, without a unit.
        origin: Where values come from.
        group: The group that it belongs to.
        after: The member of ORDER that does not count as given, nor what comes before.
    """
    keys = [f"{group}.{name}", *(f"{group}.{name}_{suffix}" for suffix in SUFFIXES)]
    return next((key for key in keys if origin.rank(key) > ORDER.index(after)), None)


def overruled_torque(whole: Whole) -> Found:
    """The torque on the gear follows from that on the pinion unless it is held."""
    key, chosen = given_on_top("gear_torque", whole.origin), whole.simulator.model.system.chosen
    if key and chosen.get("gear_torque_mode") == "balanced":
        rule = "has no effect where simulator.gear_torque_mode is balanced: it follows from the pinion's torque"
        remedy = "leave it out, or add simulator.gear_torque_mode=held"
        yield key, rule, whole.simulator.given["gear_torque"], remedy


def overruled_by_print(whole: Whole) -> Found:
    """The mass and the base circles that the paper prints take the place of what they follow from."""
    simulator = whole.simulator
    chosen = simulator.model.system.chosen
    if not chosen.get("as_printed"):
        return
    is_read = chosen["gear_torque_mode"] == "held" or any(one.name == ON_TEETH for one in simulator.model.effects)
    for name in PRINTED[:1] if is_read else PRINTED:
        key = given_on_top(name, whole.origin)
        if key:
            rule = (
                "has no effect beside simulator.as_printed=true: mass and base circles are those that the paper prints"
            )
            yield key, rule, simulator.given[name], "leave one of them out"


def overruled_accuracy(whole: Whole) -> Found:
    """Sub-steps that are given do not follow from an accuracy."""
    solver, key = whole.simulator.solver, given_on_top("solver.accuracy", whole.origin)
    if key and solver.substeps is not None:
        rule = f"has no effect beside simulator.solver.substeps={solver.substeps}, which would follow from it"
        yield key, rule, solver.accuracy, "leave one of them out"


def overruled_perturbation(whole: Whole) -> Found:
    """A start at rest is not perturbed."""
    family = whole.simulator.family
    key = given_on_top("perturbation", whole.origin, "family")
    if key and family.start == "rest" and family.perturbation:
        rule = "has no effect where family.start is rest, from which no run departs"
        yield key, rule, family.perturbation, "leave it out, or choose family.start=static"


def overruled_run(whole: Whole) -> Found:
    """Only the paper's protocol takes one run of many."""
    protocol, key = whole["protocol"], given_on_top("run", whole.origin, "protocol", "protocol")
    if key and protocol["name"] != "paper" and protocol["run"]:
        rule = f"acts in protocol=paper, which takes one run, and this is {protocol['name']}, which takes all"
        yield key, rule, protocol["run"], "leave it out, or choose protocol=paper"


OVERRULED = (
    (("simulator",), overruled_torque),
    (("simulator",), overruled_by_print),
    (("simulator",), overruled_accuracy),
    (("simulator", "family"), overruled_perturbation),
    (("protocol",), overruled_run),
)
