"""What the user typed, before Hydra reads it.

Every plain override `key=value` becomes `++key=value`: an effect that is off has no keys yet, and an
unknown key shall meet our own check, which knows the nearest valid one, and not Hydra's first refusal.
"""

from collections.abc import Sequence

from gear_damping.config.locate import conf_folder, groups
from gear_damping.errors import InputError, Problem, nearest

FLAGS_WITH_VALUE = ("--config-path", "-cp", "--config-name", "-cn", "--config-dir", "-cd", "--package", "-p")


def prepare(arguments: Sequence[str]) -> list[str]:
    """The arguments as Hydra shall see them.

    Raises:
        InputError: group choices that do not exist, arguments that are no override.
    """
    problems: list[Problem] = []
    prepared, value_follows = [], False
    for argument in arguments:
        if value_follows or argument.startswith("-"):
            prepared.append(argument)
            value_follows = argument in FLAGS_WITH_VALUE and not value_follows
            continue
        prepared.append(_override(argument, problems))
    if problems:
        raise InputError(problems)
    return prepared


def _override(argument: str, problems: list[Problem]) -> str:
    key, equals, value = argument.partition("=")
    if argument.startswith("~"):
        return argument
    if not equals:
        rule = "is not an override"
        problems.append(Problem(argument, rule, remedy="write key=value, for example experiment=backlash"))
        return argument
    plain = key.lstrip("+")
    if plain.startswith("hydra"):
        return argument
    if plain in groups():
        problems += _unknown_choices(plain, value)
        return f"{plain}={value}"
    return f"++{plain}={value}"


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
        if name == key or name.startswith(key + ".") or key.startswith(name + "."):
            return f"{name}={value}"
    return None
