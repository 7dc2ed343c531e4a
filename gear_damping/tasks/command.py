"""The command line from its words to its exit code."""

import logging
import sys
from collections.abc import Sequence
from pathlib import Path

import hydra
from hydra.core.hydra_config import HydraConfig
from hydra.types import RunMode
from omegaconf import DictConfig

from gear_damping.config.command_line import CommandLine, read_command_line, swept_keys
from gear_damping.config.locate import conf_folder, groups
from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem
from gear_damping.tasks.composed import choices_of, plain, problems_of
from gear_damping.tasks.dispatch import INTERRUPTED_CODE, OK, run_alone
from gear_damping.tasks.run_index import refresh_index
from gear_damping.tasks.sweep import callback
from gear_damping.tasks.sweep.folder import (
    PLACE,
    Place,
    place_of,
    problem_with_place,
    read_sweep,
    sweep_of,
    unfinished,
)
from gear_damping.tasks.sweep.job import limit_cores, run_swept
from gear_damping.tasks.sweep.orphan import end_with_launcher, launching
from gear_damping.tasks.wrong_declaration import WRONG_INPUT, log_problems, start_logging

log = logging.getLogger("gear_damping")
SCRIPT = "gear-damping"  # as pyproject.toml installs it: the shell's completion is for this word
_codes: list[int] = []
_folders: list[Path] = []  # of the runs of this process that are no jobs of a sweep
_CHOOSING = {"task", "experiment", "measurement", "measurement.path"}  # what decides which measurement is read


def main(arguments: Sequence[str]) -> int:
    """Run the command; returns its exit code."""
    start_logging()
    if {"--help", "-h"} & set(arguments):
        print(help_text())
        return OK
    typed = read_command_line(arguments)
    problems = [*typed.problems, *_problems_of(typed)]
    if problems:
        log_problems(InputError(problems))
        return WRONG_INPUT
    for said in () if typed.shows else typed.overruled:
        log.info(said)
    _folders.clear()
    callback.begun.clear()
    code = _sweep(typed) if typed.many and not typed.shows else _run(typed.flags, typed.overrides)
    refresh_index([*_folders, *callback.begun])
    return code


def _problems_of(typed: CommandLine) -> list[Problem]:
    """What is wrong with the configuration; of a sweep, what every job of it shares."""
    if typed.shows and not typed.shows_what_runs:
        return []
    swept = swept_keys(typed.overrides) if typed.many else []
    problems = problems_of(typed.first_job(), declared=not _CHOOSING & {*swept})
    return [problem for problem in problems if not any(_concerns(problem, key) for key in swept)]


def _concerns(problem: Problem, swept: str) -> bool:
    """Whether the problem may lie in the first value of a swept key: the other jobs shall run."""
    return swept in groups() or problem.key == swept or problem.key.startswith(swept + ".")


def _sweep(typed: CommandLine) -> int:
    """Run a sweep, or go on with the one that the same command began; returns the exit code."""
    from gear_damping.tasks.sweep.summary import summarise

    sweep, place, overrides = sweep_of(typed.overrides), place_of(typed.overrides), list(typed.overrides)
    if place is None and (begun := unfinished(sweep)) is not None:
        log.info("going on with the sweep in %s; %s=… begins another", begun, PLACE)
        overrides.append(f"{PLACE}={begun}")
    if place is not None and (problem := problem_with_place(sweep, Path(place))) is not None:
        log_problems(InputError(problem))
        return WRONG_INPUT
    with launching():
        code = _run(typed.flags, overrides)
    for folder in callback.begun:
        try:
            found = summarise(folder)
        except InputError as error:
            log_problems(error)
            return WRONG_INPUT
        log.info("%d of %d jobs are finished; the sweep lies in %s", found.finished, found.jobs, folder)
        if not found.is_complete:
            log.info("the same command goes on from here")
            code = max(code, WRONG_INPUT)
    return code


def _run(flags: Sequence[str], overrides: Sequence[str]) -> int:
    _codes.clear()
    handlers = list(logging.root.handlers)  # Hydra puts its own in their place
    old, sys.argv = sys.argv, [SCRIPT, *flags, *overrides]
    command = hydra.main(version_base="1.3", config_path=str(conf_folder()), config_name="config")(_job)
    try:
        command()
    except KeyboardInterrupt:
        _codes.append(INTERRUPTED_CODE)
    except SystemExit as stop:
        _codes.append(int(stop.code or 0))
    finally:
        sys.argv = old
        logging.root.handlers[:] = handlers
    return max([OK, *_codes])


def _job(config: DictConfig) -> int:
    """One job as Hydra calls it, in this process or in a worker of a launcher."""
    own = HydraConfig.get()
    origin, folder = Origin(list(own.overrides.task), choices_of(own)), Path(own.runtime.output_dir)
    if own.mode == RunMode.MULTIRUN:
        code = _swept(config, origin, folder)
    else:
        _folders.append(folder)
        code = run_alone(plain(config), origin, folder)
    _codes.append(code)
    return code


def _swept(config: DictConfig, origin: Origin, folder: Path) -> int:
    """One job of a sweep."""
    own = HydraConfig.get()
    limit_cores(own.launcher)
    end_with_launcher(own.launcher)
    sweep = Path(own.sweep.dir).absolute()
    keys = (read_sweep(sweep) or sweep_of(())).keys
    typed = [word.lstrip("+") for word in own.overrides.task]
    words = " ".join(word.removeprefix("simulator.") for word in typed if word.partition("=")[0] in keys)
    return run_swept(plain(config), origin, Place(folder, sweep, words))


def help_text() -> str:
    """The tasks, groups and keys that a user needs first."""
    lines = [
        "python -m gear_damping [--multirun] [key=value …]",
        "",
        "How much damping does this gear pair have, and why does my simulation not match my measurement?",
        "",
        "  python -m gear_damping experiment=backlash",
        "  python -m gear_damping --multirun experiment=noise simulator.load_noise.snr_db=1,10,20,30,40,50",
        "  python -m gear_damping task=inspect measurement.path=PATH/FILE",
        "  python -m gear_damping task=identify measurement.path=PATH/measurement.yaml",
        "  python -m gear_damping experiment=plan",
        "  python -m gear_damping task=collect sweep=outputs/sweep/…     # of a sweep, at any time",
        "  python -m gear_damping task=collect                           # outputs/index.html, of all runs",
        "",
        "task        train (default), simulate, evaluate, identify, explain, inspect, plan, paper, collect",
        "groups      choose with group=choice:",
    ]
    lines += [f"  {group:<12}{', '.join(choices)}" for group, choices in groups().items()]
    lines += [
        "keys        set with key=value:",
        "  seed, seeds, checkpoint, resume, measurement.path, training.max_epochs, training.batch_size",
        "  simulator.<effect>.<parameter>, simulator.damping_ratio_percent, simulator.solver.accuracy",
        '  values      in SI, or with their unit: 80um, 3kHz, "4600 rpm", {value: 80, unit: um}',
        "  --cfg job   shows the whole configuration with every key; with --resolve as it will run",
        'completion  eval "$(gear-damping -sc install=bash)", or fish or zsh',
    ]
    return "\n".join(lines)
