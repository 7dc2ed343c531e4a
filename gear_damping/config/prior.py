"""The `family` node: what varies from run to run."""

from collections.abc import Mapping
from typing import Any

from gear_damping.config.quantities import quantity
from gear_damping.config.reader import Reader
from gear_damping.errors import InputError, Problem, nearest
from gear_damping.physics.parameter import Parameter
from gear_damping.schema.values import Number, OneOf, Text
from gear_damping.simulation.prior import DAMPING_RATIO, Prior, Uniform
from gear_damping.units import spoken

PLAIN = {
    "name": Text(),
    "start": OneOf(("static", "rest")),
    "perturbation": Number(0, 100),
}
KINDS = ("uniform", "factor")
OTHER_FAMILY = "choose family=none, in which nothing varies, or a family for this system"
RATIO = Parameter(DAMPING_RATIO, "1", 0.3, "equivalent damping ratio in % of critical", 0, 50)


def read_prior(
    reader: Reader, node: Mapping[str, Any], declared: Mapping[str, Parameter], given: Mapping[str, Any]
) -> Prior | None:
    """The prior; problems go to the reader.

    Args:
        reader: Collects the problems.
        node: The configuration.
        declared: The parameters of the model by flat name.
        given: Their values where given, SI.
    """
    for key in set(node) - set(PLAIN) - {"spreads"}:
        reader.refuse_unknown(f"family.{key}", [*PLAIN, "spreads"])
    plain = reader.plain(node, PLAIN, "family.")
    listed = node.get("spreads") or {}
    if not isinstance(listed, Mapping):
        reader.refuse("family.spreads", "is a group of keys", listed, "give family.spreads.<parameter>")
        return None
    distributions, declared = {}, {**declared, DAMPING_RATIO: RATIO}
    for name, distribution in listed.items():
        if distribution is not None:
            found = reader.collect(
                lambda name=name, distribution=distribution: _distribution(reader, name, distribution, declared, given)
            )
            distributions |= {name: found} if found else {}
    return Prior(distributions=distributions, **plain)


def _distribution(
    reader: Reader, name: str, node: Any, declared: Mapping[str, Parameter], given: Mapping[str, Any]
) -> Uniform:
    key = f"family.spreads.{name}"
    source = reader.origin.of(key)
    if name not in declared:
        remedy = OTHER_FAMILY if reader.origin.place(key) == "family" else nearest(name, list(declared))
        raise InputError(Problem(key, "the model has no such parameter", None, remedy, source))
    kind = _kind(reader, key, node)
    parameter = declared[name]
    unit, own_unit = ("1", None) if kind == "factor" else (parameter.unit, node.get("unit"))
    if name == DAMPING_RATIO and kind != "factor":
        low, high = (_percent(value, key, source, own_unit) for value in node[kind])
    else:
        low, high = (quantity(value, unit, key, source, own_unit) for value in node[kind])
    if low > high:
        raise InputError(Problem(key, "the lower end must not lie above the upper", node, "swap them", source))
    nominal = given.get(name, parameter.default) if kind == "factor" else 1.0
    if isinstance(nominal, (int, float)):
        ends = [parameter.problem(end * nominal, key, source) for end in (low, high)]
        if any(ends):
            raise InputError([problem for problem in ends if problem])
    return Uniform(low, high, relative=kind == "factor")


def _percent(value: Any, key: str, source: str, own_unit: str | None) -> float:
    """A ratio in %: so is a plain number, `0.3 %` is 0.3, and with the unit 1 a share."""
    has_unit = own_unit or spoken(value) or (isinstance(value, Mapping) and "unit" in value)
    return quantity(value, "1", key, source, own_unit) * (100 if has_unit else 1)


def _kind(reader: Reader, key: str, node: Any) -> str:
    """`uniform` or `factor`; where a file gives one and the command line the other, the latter."""
    kinds = [kind for kind in KINDS if isinstance(node, Mapping) and kind in node]
    kinds.sort(key=lambda kind: reader.origin.rank(f"{key}.{kind}"))
    ranks = [reader.origin.rank(f"{key}.{kind}") for kind in kinds]
    pair = bool(kinds) and isinstance(node[kinds[-1]], list) and len(node[kinds[-1]]) == 2
    if not pair or (len(ranks) == 2 and ranks[0] == ranks[1]) or set(node) - {*KINDS, "unit"}:
        rule = "must be {uniform: [low, high], unit: …} or {factor: [low, high]}"
        raise InputError(Problem(key, rule, node, "for example {factor: [0.8, 1.2]}", reader.origin.of(key)))
    return kinds[-1]
