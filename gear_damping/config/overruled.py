"""Values that were given in the experiment or on the command line, and that another value of the group overrules."""

from gear_damping.config.acting import Found
from gear_damping.config.decided import decided_by_options
from gear_damping.config.source import ORDER, Origin, spellings
from gear_damping.config.whole import Whole


def given_on_top(name: str, origin: Origin, group: str = "simulator", after: str = "family") -> str | None:
    """The key under which a file that comes after a group's, or the command line, gives a value; None where none does.

    Args:
        name: Of the value, without a unit.
        origin: Where values come from.
        group: The group that it belongs to.
        after: The member of ORDER that does not count as given, nor what comes before.
    """
    keys = spellings(f"{group}.{name}")
    return next((key for key in keys if origin.rank(key) > ORDER.index(after)), None)


def overruled_value(whole: Whole) -> Found:
    """Values of the system that one of its options decides."""
    simulator = whole.simulator
    for name, decided in decided_by_options(simulator.model, "simulator.").items():
        key = given_on_top(name, whole.origin)
        if key:
            yield key, decided.rule, simulator.given[name], decided.remedy


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
    (("simulator",), overruled_value),
    (("simulator",), overruled_accuracy),
    (("simulator", "family"), overruled_perturbation),
    (("protocol",), overruled_run),
)
