"""What the user typed, before Hydra reads it.

Every plain override `key=value` becomes `++key=value`: an effect that is off has no keys yet, and an
unknown key shall meet our own check, which knows the nearest valid one, and not Hydra's first refusal.
"""

from collections.abc import Sequence

from gear_damping.config.locate import conf_folder, groups
from gear_damping.errors import Problem, nearest

FLAGS_WITH_VALUE = ("--config-path", "-cp", "--config-name", "-cn", "--config-dir", "-cd", "--package", "-p")


def prepare(arguments: Sequence[str]) -> tuple[list[str], list[Problem]]:
    """The arguments as Hydra shall see them, and what is wrong with the others, which are left out.

    Wrong are arguments that are no override, and choices that a group does not have.
    """
    problems: list[Problem] = []
    prepared, value_follows = [], False
    for argument in arguments:
        if value_follows or argument.startswith("-"):
            prepared.append(argument)
            value_follows = argument in FLAGS_WITH_VALUE and not value_follows
            continue
        found = _problems_with(argument)
        problems += found
        prepared += [] if found else [_override(argument)]
    return prepared, problems


def _problems_with(argument: str) -> list[Problem]:
    key, equals, value = argument.partition("=")
    if not equals and not argument.startswith("~"):
        remedy = "write key=value, for example experiment=backlash"
        return [Problem(argument, "is not an override", remedy=remedy, source="the command line")]
    group = key.lstrip("+")
    return _unknown_choices(group, value) if group in groups() else []


def _override(argument: str) -> str:
    key, _, value = argument.partition("=")
    plain = key.lstrip("+")
    if argument.startswith("~") or plain.startswith("hydra"):
        return argument
    return f"{plain}={value}" if plain in groups() else f"++{plain}={value}"


def _unknown_choices(group: str, value: str) -> list[Problem]:
    choices = groups()[group]
    if value == "null":
        return []
    source = f"the command line; the choices are the files of {conf_folder() / group}"
    return [
        Problem(group, "no such choice", one, nearest(one, choices), source)
        for one in value.split(",")
        if one not in choices
    ]


def typed_value(overrides: Sequence[str], key: str) -> str | None:
    """What the command line gave for a key or one below it, as typed; None where it gave nothing."""
    for override in reversed(overrides):
        name, _, value = override.lstrip("+").partition("=")
        if name not in groups() and (name == key or name.startswith(key + ".") or key.startswith(name + ".")):
            return f"{name}={value}"
    return None
