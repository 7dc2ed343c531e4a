"""Checks of a configuration that need no physics: they are done before anything that takes long is imported."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gear_damping.config import keys
from gear_damping.config.acting import Found, idle_keys
from gear_damping.config.measured import INSPECT, MEASURED, measurement_file
from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem

_NAME = re.compile(r"^[\w][\w.-]*$")


@dataclass(frozen=True)
class InspectSettings:
    """What task=inspect is told: nothing of it is simulated, so that its simulator is not read.

    Args:
        task: `inspect`.
        name: Of the experiment.
        measurement_path: A measurement.yaml or a file of data.
        measurement_plugins: The user's own files of formats.
    """

    task: str
    name: str
    measurement_path: Path
    measurement_plugins: tuple[str, ...] = ()


def read_inspect_settings(config: Mapping[str, Any], origin: Origin) -> InspectSettings:
    """The settings of task=inspect.

    Raises:
        InputError: every problem outside the simulator and its family.
    """
    problems = light_problems(config, origin)
    if problems:
        raise InputError(problems)
    measurement = config["measurement"]
    plugins = tuple(measurement["plugins"] or ())
    return InspectSettings(config["task"], config["name"], measurement_file(measurement["path"]), plugins)


def light_problems(config: Mapping[str, Any], origin: Origin) -> list[Problem]:
    """The problems with the keys outside simulator and family, and with the path of the measurement."""
    plain = {key: value for key, value in config.items() if key != "hydra"}
    _, problems = keys.check(plain, origin)
    wrong = {problem.key.split(".")[0] for problem in problems}
    for needed, check in LIGHT:
        if not wrong & set(needed):
            found = check(plain, origin)
            problems += [Problem(key, rule, value, remedy, origin.of(key)) for key, rule, value, remedy in found]
    return problems


def wrong_name(config: Mapping[str, Any], origin: Origin) -> Found:
    """The name of the experiment is one of a folder."""
    if not _NAME.match(config["name"]):
        yield "name", "names a folder: letters, digits, '_', '-' and '.'", config["name"], "rename it"


def wrong_measurement(config: Mapping[str, Any], origin: Origin) -> Found:
    """A task that reads a measurement is given one."""
    path, task = config["measurement"]["path"], config["task"]
    if task not in MEASURED:
        return
    kind = "a measurement.yaml or of a file of data" if task == INSPECT else "a measurement.yaml"
    if path is None:
        example = "PATH/FILE" if task == INSPECT else "PATH/measurement.yaml"
        yield "measurement.path", f"task={task} needs a measurement", None, f"measurement.path={example}"
    elif not measurement_file(path).is_file():
        each = _for_each(measurement_file(path))
        yield "measurement.path", no_file(measurement_file(path)), path, f"give the path of {kind}{each}"


def _for_each(path: Path) -> str:
    """How several measurements are asked about: those of a folder, or those that match a pattern."""
    if path.is_dir():
        return ", or --multirun for a job for each measurement in it"
    return ", or --multirun for a job for each file that matches" if set("*?") & set(path.name) else ""


def no_file(path: Path) -> str:
    """Why there is no file at a path."""
    return "is a folder, no file" if path.is_dir() else "no such file"


LIGHT = ((("name",), wrong_name), (("task", "measurement"), wrong_measurement), (("task",), idle_keys))
