"""Runs one configured job: checks it, opens its folder, does the task, says how it ended."""

import logging
import signal
import traceback
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any

from gear_damping.config.folders import resumable
from gear_damping.config.measured import INSPECT
from gear_damping.config.shown import going_on
from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem, met_in_writing, unread
from gear_damping.own_files import errors_in
from gear_damping.reporting.run_report import REPORTED
from gear_damping.tasks.lease import leased
from gear_damping.tasks.own_parts import plugins_of
from gear_damping.tasks.run_folder import FAILED, FINISHED, INTERRUPTED, RunFolder, problem_with_used
from gear_damping.tasks.wrong_declaration import WRONG_INPUT, log_problems

if TYPE_CHECKING:
    from gear_damping.config.light import InspectSettings
    from gear_damping.config.settings import Settings

log = logging.getLogger("gear_damping")
OK, INTERRUPTED_CODE = 0, 130  # exit codes; 128 + SIGINT as shells have it


def run_alone(config: Mapping[str, Any], origin: Origin, folder: Path) -> int:
    """Do one job that is none of a sweep, and hold the lease of its folder meanwhile; returns its exit code."""
    try:
        with leased(folder):
            return run_job(config, origin, folder)
    except OSError as error:  # of the lease: those of the job were said
        log_problems(InputError(_not_written(error, folder)))
        return WRONG_INPUT


def run_job(config: Mapping[str, Any], origin: Origin, folder: Path) -> int:
    """Do one job; returns its exit code. A KeyboardInterrupt is passed on after the folder was closed."""
    signal.signal(signal.SIGTERM, _interrupt)
    used = problem_with_used(folder, config)
    if used is not None:
        log_problems(InputError(used))
        return WRONG_INPUT
    try:
        run_folder = RunFolder(folder, config, origin)
    except OSError as error:
        log_problems(InputError(_not_written(error, folder)))
        return WRONG_INPUT
    try:
        with errors_in(plugins_of(config), origin.of):
            settings = _settings(config, origin)
            for path, key in plugins_of(config).items():
                run_folder.add_inputs([Path(path)], key)
            metrics = task_of(settings)(settings, run_folder)
            _report(run_folder)
        run_folder.close(FINISHED, metrics)
    except InputError as error:
        return _failed(run_folder, InputError([_placed(problem, config, origin) for problem in error.problems]))
    except KeyboardInterrupt:
        _close(run_folder, INTERRUPTED)
        again = going_on(run_folder.record["command"], folder)
        log.info("interrupted%s", f"; go on with: {again}" if resumable(config["task"], folder) else "")
        raise
    except Exception as error:
        if isinstance(error, OSError) and error.errno is not None:  # of the machine: a full disk, a missing right
            return _failed(run_folder, InputError(_of_the_machine(error, folder, config, origin)))
        _close(run_folder, FAILED, f"{type(error).__name__}: {error}")
        log.error("%s\n%s", traceback.format_exc(), _whose(plugins_of(config)))
        return WRONG_INPUT
    log.info("everything lies in %s", folder)
    return OK


def _report(run_folder: RunFolder) -> None:
    """Write report.html; what draws and writes it is imported for the tasks that have one."""
    if run_folder.record["task"] in REPORTED:
        from gear_damping.reporting.run_report.write import write_report

        write_report(run_folder.path, run_folder.record)


def _settings(config: Mapping[str, Any], origin: Origin) -> "Settings | InspectSettings":
    """The settings of the task; what simulates is imported where the task needs it."""
    if config.get("task") == INSPECT:
        from gear_damping.config.light import read_inspect_settings

        return read_inspect_settings(config, origin)
    from gear_damping.config.settings import read_settings

    return read_settings(config, origin)


def _whose(plugins: Mapping[str, str]) -> str:
    """Where to look for the cause of an error that no line of the user's own files raised."""
    if not plugins:
        return "This is a defect of gear_damping, not of your input."
    files = ", ".join(plugins)
    without = " ".join(f"{key}=[]" for key in dict.fromkeys(plugins.values()))
    return f"This is a defect of what {files} returns, or of gear_damping: try it with {without}."


def _placed(problem: Problem, config: Mapping[str, Any], origin: Origin) -> Problem:
    """A problem that a task found with a key of the configuration, with the place that the key came from."""
    node: Any = config
    for part in problem.key.split("."):
        node = node.get(part, config) if isinstance(node, Mapping) else config
    if problem.source or isinstance(node, Mapping):  # a group comes from many places
        return problem
    return replace(problem, source=origin.of(problem.key))


def _failed(run_folder: RunFolder, error: InputError) -> int:
    log_problems(error)
    _close(run_folder, FAILED, str(error))
    return WRONG_INPUT


def _close(run_folder: RunFolder, status: str, error: str | None = None) -> None:
    """Say in run.json how the run ended, where that can still be written."""
    try:
        run_folder.close(status, error=error)
    except OSError as again:
        log.error("run.json could not be brought up to date: %s", again)


def _of_the_machine(error: OSError, folder: Path, config: Mapping[str, Any], origin: Origin) -> Problem:
    """The problem with a file: an output where it was met in writing, an input where the configuration names it."""
    if met_in_writing(error):
        return _not_written(error, folder)
    name, reason = error.filename, error.strerror or str(error)
    keys = [] if name is None else [key for key, value in _named(config) if Path(value) == Path(str(name))]
    if keys:
        return unread(error, str(name), keys[0], origin.of(keys[0]))
    remedy = "see that it is there, and that you have the right to it"
    return Problem("file", f"cannot be read or written: {reason}", None if name is None else str(name), remedy)


def _named(node: Any, key: str = "") -> Iterator[tuple[str, str]]:
    """Every text of a configuration with its key; those of a list have that of the list."""
    if isinstance(node, Mapping):
        for name, value in node.items():
            yield from _named(value, f"{key}.{name}".lstrip("."))
    elif isinstance(node, list):
        for value in node:
            yield from _named(value, key)
    elif isinstance(node, str):
        yield key, node


def _not_written(error: OSError, folder: Path) -> Problem:
    """The problem with an output; one without a name is a file of the run."""
    rule = error.strerror or str(error)
    name = error.filename2 or error.filename  # of two, the one that was to be written
    if name is not None:
        return Problem(str(name), rule, remedy="make room, give the right to it, or name another place")
    rule = f"a file of the run could not be written: {rule}"
    return Problem("hydra.run.dir", rule, str(folder), "make room there and in data_folder, or name other folders")


def task_of(settings: "Settings | InspectSettings") -> Callable[[Any, RunFolder], dict[str, Any]]:
    """The function that does the task."""
    return import_module(f"gear_damping.tasks.{settings.task}").run


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt
