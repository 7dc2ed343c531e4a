"""The keys outside the simulator: type, range and choices of each, and their check."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem
from gear_damping.explanation.settings import SearchSettings
from gear_damping.reporting.paper.printed import EFFECTS
from gear_damping.schema.mappings import group, read_declared
from gear_damping.schema.values import Flag, Given, Levels, Names, Number, OneOf, Problems, Text, Value

TASKS = ("train", "simulate", "evaluate", "identify", "explain", "inspect", "plan", "paper", "collect")


def _thresholds() -> dict[str, Number]:
    """Of the search, as `SearchSettings` declares them."""
    return {
        one.name: Number(one.metadata["lower"], one.metadata["upper"], whole=one.type is int)
        for one in fields(SearchSettings)
    }


_SHARE = Number(0, 1, exclusive=True)  # of the runs: something is left on either side
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
    "explain": {"minutes": Number(0, 1e6, exclusive=True)} | _thresholds(),
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
        "noise_snr_db": Given(Levels(Number(-100, 200), ascend=True), optional=True),
        "devices": Number(1, 64, whole=True),
    },
    "evaluation": {
        "snr_db": Given(Levels(Number(-100, 200)), optional=True),
        "known_model": Flag(),
        "effects": Given(Names(), optional=True),
    },
    "measurement": {
        "path": Given(Text(), optional=True),
        "channel": Given(Text(), optional=True),
        "plugins": Given(Names(), optional=True),
    },
}
ELSEWHERE = ("simulator", "family", "model", "wavelet", "plan")  # groups with a check of their own


def check(config: Mapping[str, Any], origin: Origin) -> list[Problem]:
    """Every problem with the keys outside simulator and family."""
    return problems_with(config, SCHEMA, "", origin, ELSEWHERE)


def problems_with(
    values: Mapping[str, Any], kinds: Mapping[str, Any], prefix: str, origin: Origin, others: Sequence[str] = ()
) -> list[Problem]:
    """Every problem with a group of keys.

    Args:
        values: The group.
        kinds: What each key may hold, groups within it as mappings.
        prefix: What stands before each key, `model.` for example.
        origin: Where values come from.
        others: Keys that are checked elsewhere.
    """
    problems = Problems()
    read_declared(group(kinds, others), values, problems, origin.of, prefix)
    return problems


def problem_with(value: Any, kind: Value, key: str, origin: Origin) -> Problem | None:
    """The problem with one value, or None."""
    try:
        (kind if isinstance(kind, Given) else Given(kind)).read(value, key)
    except InputError as error:
        return replace(error.problems[0], key=key, source=origin.of(key))
    return None
