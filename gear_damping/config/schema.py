"""The keys outside the simulator: type, range and choices of each, and their check."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from math import inf, isfinite
from typing import Any

from gear_damping.config.source import Origin
from gear_damping.errors import Problem, nearest
from gear_damping.explanation.settings import SearchSettings
from gear_damping.reporting.paper.printed import EFFECTS

TASKS = ("train", "simulate", "evaluate", "identify", "explain", "inspect", "plan", "paper", "collect")


@dataclass(frozen=True)
class Key:
    """What one key may hold.

    Args:
        kind: `int`, `float`, `bool`, `text`, `names`, `span`, two numbers that ascend, or `levels`,
            different numbers.
        lower: Smallest number.
        upper: Largest number.
        choices: Allowed texts or names; empty for any.
        optional: Whether null is allowed.
        exclusive: Whether the bounds themselves are excluded.
    """

    kind: str
    lower: float = -inf
    upper: float = inf
    choices: tuple[str, ...] = ()
    optional: bool = False
    exclusive: bool = False


def _thresholds() -> dict[str, Key]:
    """Of the search, as `SearchSettings` declares them."""
    return {
        one.name: Key("int" if one.type is int else "float", one.metadata["lower"], one.metadata["upper"])
        for one in fields(SearchSettings)
    }


_SHARE = Key("float", 0, 1, exclusive=True)
SCHEMA: dict[str, Any] = {
    "task": Key("text", choices=TASKS),
    "name": Key("text"),
    "seed": Key("int", 0, 2**31 - 1),
    "seeds": Key("int", 1, 1000),
    "checkpoint": Key("text", optional=True),
    "resume": Key("text", optional=True),
    "sweep": Key("text", optional=True),
    "data_folder": Key("text"),
    "progress": Key("bool"),
    "ruled_out": Key("names", optional=True),
    "explain": {"minutes": Key("float", 0, 1e6, exclusive=True)} | _thresholds(),
    "write_measurement": Key("bool"),
    "figures": Key("names", choices=tuple(EFFECTS), optional=True),
    "protocol": {
        "name": Key("text", choices=("by_run", "paper", "paper_many_runs")),
        "window": Key("int", 2, 1_000_000),
        "stride": Key("int", 1, 1_000_000),
        "evaluation_stride": Key("int", 1, 1_000_000),
        "validation_fraction": _SHARE,
        "test_fraction": _SHARE,
        "windows_per_epoch": Key("int", 1, 10**9, optional=True),
        "run": Key("int", 0, 10**9),
    },
    "training": {
        "max_epochs": Key("int", 1, 1_000_000),
        "batch_size": Key("int", 1, 1_000_000),
        "patience": Key("int", 1, 1_000_000),
        "learning_rate": Key("float", 0, 10, exclusive=True),
        "schedule": Key("text", choices=("constant", "cosine")),
        "gradient_clip": Key("float", 0, 1e6, exclusive=True, optional=True),
        "noise_snr_db": Key("span", -100, 200, optional=True),
    },
    "evaluation": {"snr_db": Key("levels", -100, 200, optional=True), "known_model": Key("bool")},
    "measurement": {
        "path": Key("text", optional=True),
        "channel": Key("text", optional=True),
        "plugins": Key("names", optional=True),
    },
}
ELSEWHERE = ("simulator", "family", "model", "wavelet", "plan")  # groups with a check of their own


def check(config: Mapping[str, Any], origin: Origin) -> list[Problem]:
    """Every problem with the keys outside simulator and family."""
    return problems_with(config, SCHEMA, "", origin, ELSEWHERE)


def problems_with(
    values: Mapping[str, Any], schema: Mapping[str, Any], prefix: str, origin: Origin, skip: tuple[str, ...] = ()
) -> list[Problem]:
    """Every problem with a group of keys.

    Args:
        values: The group.
        schema: What each key may hold, groups within it as mappings.
        prefix: What stands before each key, `model.` for example.
        origin: Where values come from.
        skip: Keys that are checked elsewhere.
    """
    problems = [
        Problem(prefix + name, "no such key", remedy=nearest(name, [*schema, *skip]), source=origin.of(prefix + name))
        for name in values
        if name not in schema and name not in skip
    ]
    for name, rule in schema.items():
        key = prefix + name
        if name not in values:
            problems.append(Problem(key, "is missing", remedy="leave the group as it is", source=origin.of(key)))
        elif isinstance(rule, Key):
            found = problem_with(values[name], rule, key, origin)
            problems += [found] if found else []
        elif isinstance(values[name], Mapping):
            problems += problems_with(values[name], rule, key + ".", origin)
        else:
            remedy = f"give {key}.<key>, or choose {name}=<choice>"
            problems.append(Problem(key, "is a group of keys", values[name], remedy, origin.of(key)))
    return problems


def problem_with(value: Any, rule: Key, key: str, origin: Origin) -> Problem | None:
    """The problem with one value, or None."""
    if value is None:
        return None if rule.optional else Problem(key, "must be given", None, _example(rule), origin.of(key))
    said = _wrong_type(value, rule) or _out_of_range(value, rule)
    if said:
        return Problem(key, said[0], value, said[1], origin.of(key))
    names = value if rule.kind == "names" else [value]
    for name in names:
        if rule.choices and name not in rule.choices:
            return Problem(
                key,
                f"must be one of {', '.join(rule.choices)}",
                value,
                nearest(str(name), rule.choices),
                origin.of(key),
            )
    return None


def _example(rule: Key) -> str:
    return f"choose one of {', '.join(rule.choices)}" if rule.choices else "give a value"


def _wrong_type(value: Any, rule: Key) -> tuple[str, str] | None:
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    wanted = {
        "int": (isinstance(value, int) and not isinstance(value, bool), "a whole number"),
        "float": (number, "a number"),
        "bool": (isinstance(value, bool), "true or false"),
        "text": (isinstance(value, str), "text"),
        "span": (_is_span(value), "two numbers that ascend, [1, 30]"),
        "levels": (_are_levels(value), "a list of different numbers, [30, 20, 10]"),
        "names": (
            isinstance(value, list) and len(value) > 0 and len(set(map(str, value))) == len(value),
            "a list of different names",
        ),
    }
    good, said = wanted[rule.kind]
    return None if good else (f"must be {said}", f"write {said}")


def _is_span(value: Any) -> bool:
    good = isinstance(value, list) and len(value) == 2
    return good and all(type(end) in (int, float) and isfinite(end) for end in value) and value[0] <= value[1]


def _are_levels(value: Any) -> bool:
    good = isinstance(value, list) and len(value) > 0 and len(set(map(str, value))) == len(value)
    return good and all(type(level) in (int, float) and isfinite(level) for level in value)


def _out_of_range(value: Any, rule: Key) -> tuple[str, str] | None:
    if rule.kind in ("span", "levels"):
        return next(filter(None, (_out_of_range(end, replace(rule, kind="float")) for end in value)), None)
    if rule.kind not in ("int", "float"):
        return None
    inside = rule.lower < value < rule.upper if rule.exclusive else rule.lower <= value <= rule.upper
    if inside:
        return None
    words = "strictly between" if rule.exclusive else "within"
    said = f"must lie {words} {rule.lower:.10g} and {rule.upper:.10g}"
    return said, f"nearest valid value {_nearest_number(value, rule)}"


def _nearest_number(value: float, rule: Key) -> str:
    if isinstance(value, float) and not isfinite(value):
        return f"{rule.lower:g}"
    near = min(max(value, rule.lower), rule.upper)
    if rule.exclusive and near in (rule.lower, rule.upper):
        return f"just {'above' if near == rule.lower else 'below'} {near:g}"
    return f"{near:.10g}"
