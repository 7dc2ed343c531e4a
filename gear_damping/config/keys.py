"""The keys outside the simulator: type, range and choices of each, and their check."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem
from gear_damping.explanation.settings import SearchSettings
from gear_damping.reporting.paper.printed import EFFECTS
from gear_damping.schema.mappings import Group, group, read_declared, values_of
from gear_damping.schema.values import Flag, Given, Levels, Names, Number, OneOf, Problems, Text, Value
from gear_damping.units import SUFFIXES

TASKS = ("train", "simulate", "evaluate", "identify", "explain", "inspect", "plan", "paper", "collect")


def _thresholds() -> dict[str, Number]:
    """Of the search, as `SearchSettings` declares them."""
    return {
        one.name: Number(one.metadata["lower"], one.metadata["upper"], one.type is int, unit=one.metadata["unit"])
        for one in fields(SearchSettings)
    }


_SHARE = Number(0, 1, exclusive=True, unit="1")  # of the runs: something is left on either side
SCHEMA: dict[str, Any] = {
    "task": OneOf(TASKS),
    "name": Text(),
    "seed": Number(0, 2**31 - 1, whole=True),
    "seeds": Number(1, 1000, whole=True),
    "checkpoint": Given(Text(), optional=True),
    "resume": Given(Text(), optional=True),
    "sweep": Given(Text(), optional=True),
    "data_folder": Text(),
    "progress": Flag(),
    "ruled_out": Given(Names(), optional=True),
    "explain": {"minutes": Number(0, 1e6, exclusive=True, unit="min")} | _thresholds(),
    "write_measurement": Flag(),
    "figures": Given(Names(tuple(EFFECTS)), optional=True),
    "protocol": {
        "name": OneOf(("by_run", "paper", "paper_many_runs")),
        "window": Number(2, 1_000_000, whole=True),
        "stride": Number(1, 1_000_000, whole=True),
        "evaluation_stride": Number(1, 1_000_000, whole=True),
        "validation_fraction": _SHARE,
        "test_fraction": _SHARE,
        "windows_per_epoch": Given(Number(1, 10**9, whole=True), optional=True),
        "run": Number(0, 10**9, whole=True),
    },
    "training": {
        "max_epochs": Number(1, 1_000_000, whole=True),
        "batch_size": Number(1, 1_000_000, whole=True),
        "patience": Number(1, 1_000_000, whole=True),
        "learning_rate": Number(0, 10, exclusive=True),
        "schedule": OneOf(("constant", "cosine")),
        "gradient_clip": Given(Number(0, 1e6, exclusive=True), optional=True),
        "noise_snr_db": Given(Levels(Number(-100, 200, unit="dB"), ascend=True), optional=True),
        "devices": Number(1, 64, whole=True),
    },
    "evaluation": {
        "snr_db": Given(Levels(Number(-100, 200, unit="dB")), optional=True),
        "known_model": Flag(),
        "effects": Given(Names(), optional=True),
    },
    "measurement": {
        "path": Given(Text(), optional=True),
        "channel": Given(Text(), optional=True),
        "plugins": Given(Names(), optional=True),
    },
}
OF_A_FILE = ("data", "file", "path", "record", "measurement_path", "input", "yaml")  # what people call the file to read
ELSEWHERE = ("simulator", "family", "model", "wavelet", "plan")  # groups with a check of their own


def check(config: Mapping[str, Any], origin: Origin) -> tuple[dict[str, Any], list[Problem]]:
    """The keys outside simulator and family, numbers in the unit of their key, and every problem with them."""
    found, problems = read_keys(config, SCHEMA, "", origin, ELSEWHERE)
    known = {**config, **{key: value for key, value in found.items() if key not in ELSEWHERE}}
    return known, [_with_its_group(problem) if problem.key not in SCHEMA else problem for problem in problems]


def without_group(key: str) -> str:
    """The remedy for a key of no group that was given in one, `explain.seed`; empty for any other key."""
    inside, _, name = key.rpartition(".")
    alone = inside and name in SCHEMA and not isinstance(SCHEMA[name], Mapping)
    return f"did you mean '{name}', which stands in no group?" if alone else ""


def _with_its_group(problem: Problem) -> Problem:
    """Of a key that is one of a group's and was given without it, the remedy names the group."""
    if problem.key in OF_A_FILE:
        return replace(problem, remedy="write measurement.path=FILE")
    groups = [name for name, kinds in SCHEMA.items() if isinstance(kinds, Mapping) and problem.key in kinds]
    return replace(problem, remedy=f"did you mean '{groups[0]}.{problem.key}'?") if len(groups) == 1 else problem


def read_keys(
    values: Mapping[str, Any], kinds: Mapping[str, Any], prefix: str, origin: Origin, others: Sequence[str] = ()
) -> tuple[dict[str, Any], list[Problem]]:
    """The values of a group of keys, without those that are wrong, and every problem with them.

    Args:
        values: The group.
        kinds: What each key may hold, groups within it as mappings.
        prefix: What stands before each key, `model.` for example.
        origin: Where values come from.
        others: Keys that are checked elsewhere.
    """
    problems = Problems()
    found = read_declared(group(kinds, others), values, problems, origin.of, prefix)
    told = [replace(p, remedy=without_group(p.key) or p.remedy) if p.rule == Group.unknown else p for p in problems]
    return ({} if found is None else _as_given(values, values_of(found))), told


def _as_given(given: Any, read: Any) -> Any:
    """What was read, a plain number as it was given: 1 is told as 1, not as 1.0."""
    if isinstance(read, Mapping) and isinstance(given, Mapping):
        return {name: _as_given(given.get(name), value) for name, value in read.items()}
    return given if isinstance(given, int | float) else read


def unit_of(key: str) -> str | None:
    """The unit of the plain number under a full key, `1` where it is SI; None where the key has none.

    A key has the unit that its kind declares, or what it ends in. Of a parameter of the simulator or of a plan that
    ends in none the plain number is SI.
    """
    ending = SUFFIXES.get(key.rpartition("_")[2])
    if ending is not None or key.split(".")[0] in ("simulator", "plan"):
        return ending or "1"
    kind: Any = SCHEMA
    for part in key.split("."):
        kind = kind.get(part) if isinstance(kind, Mapping) else None
    kind = kind.kind if isinstance(kind, Given) else kind
    kind = kind.each if isinstance(kind, Levels) else kind
    return kind.unit or None if isinstance(kind, Number) else None


def problem_with(value: Any, kind: Value, key: str, origin: Origin) -> Problem | None:
    """The problem with one value, or None."""
    return read_value(value, kind, key, origin)[1]


def read_value(value: Any, kind: Value, key: str, origin: Origin) -> tuple[Any, Problem | None]:
    """One value, a number in the unit of its key, and the problem with it: one of both is None."""
    try:
        return _as_given(value, (kind if isinstance(kind, Given) else Given(kind)).read(value, key)), None
    except InputError as error:
        return None, replace(error.problems[0], key=key, source=origin.of(key))
