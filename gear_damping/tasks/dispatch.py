"""Runs one configured job: checks it, opens its folder, does the task, says how it ended."""

import logging
import signal
import traceback
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from types import FrameType
from typing import Any

from gear_damping.config.settings import Settings, read_settings
from gear_damping.config.source import Origin
from gear_damping.errors import InputError
from gear_damping.tasks.run_folder import FAILED, FINISHED, INTERRUPTED, RunFolder

log = logging.getLogger("gear_damping")
OK, WRONG_INPUT, INTERRUPTED_CODE = 0, 1, 130


def run_job(config: Mapping[str, Any], origin: Origin, folder: Path) -> int:
    """Do one job; returns its exit code. A KeyboardInterrupt is passed on after the folder was closed."""
    signal.signal(signal.SIGTERM, _interrupt)
    run_folder = RunFolder(folder, config, origin.choices)
    try:
        settings = read_settings(config, origin)
        metrics = task_of(settings)(settings, run_folder)
    except InputError as error:
        say_problems(error)
        run_folder.close(FAILED, error=str(error))
        return WRONG_INPUT
    except KeyboardInterrupt:
        run_folder.close(INTERRUPTED)
        log.info("interrupted; go on with: resume=%s", folder)
        raise
    except Exception as error:
        run_folder.close(FAILED, error=f"{type(error).__name__}: {error}")
        log.error("%s\nThis is a defect of gear_damping, not of your input.", traceback.format_exc())
        return WRONG_INPUT
    run_folder.close(FINISHED, metrics)
    log.info("everything lies in %s", folder)
    return OK


def task_of(settings: Settings) -> Callable[[Settings, RunFolder], dict[str, Any]]:
    """The function that does the task."""
    return import_module(f"gear_damping.tasks.{settings.task}").run


def say_problems(error: InputError) -> None:
    """Every problem, one a line."""
    count = len(error.problems)
    log.error("%s\n%s", "This cannot run:" if count == 1 else f"This cannot run, {count} problems:", error)


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt
