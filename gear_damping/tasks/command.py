"""The command line from its words to its exit code."""

import logging
import sys
from collections.abc import Sequence
from pathlib import Path

import hydra
from hydra.core.hydra_config import HydraConfig
from omegaconf import DictConfig

from gear_damping.config.command_line import CommandLine, read_command_line, swept_keys
from gear_damping.config.locate import conf_folder, groups
from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem
from gear_damping.tasks import sweep
from gear_damping.tasks.composed import choices_of, plain, problems_of
from gear_damping.tasks.dispatch import INTERRUPTED_CODE, OK, run_job
from gear_damping.tasks.wrong_declaration import WRONG_INPUT, say_problems, start_logging

_codes: list[int] = []
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
        say_problems(InputError(problems))
        return WRONG_INPUT
    return _run(typed)


def _problems_of(typed: CommandLine) -> list[Problem]:
    """What is wrong with the configuration; of a sweep, what every job of it shares."""
    if typed.shows:
        return []
    swept = swept_keys(typed.overrides) if typed.many else []
    problems = problems_of(typed.first_job(), declared=not _CHOOSING & {*swept})
    return [problem for problem in problems if not any(_concerns(problem, key) for key in swept)]


def _concerns(problem: Problem, swept: str) -> bool:
    """Whether the problem may lie in the first value of a swept key: the other jobs shall run."""
    return swept in groups() or problem.key == swept or problem.key.startswith(swept + ".")


def _run(typed: CommandLine) -> int:
    _codes.clear()
    sweep.current.clear()
    handlers = list(logging.root.handlers)  # Hydra puts its own in their place
    old, sys.argv = sys.argv, ["gear_damping", *typed.flags, *typed.overrides]
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
    failed = _summarise() if typed.many else 0
    return max([WRONG_INPUT if failed else OK, *_codes])


def _job(config: DictConfig) -> int:
    """One job as Hydra calls it, in this process or in a worker of a launcher."""
    own = HydraConfig.get()
    origin = Origin(list(own.overrides.task), choices_of(own))
    code = run_job(plain(config), origin, Path(own.runtime.output_dir))
    _codes.append(code)
    return code


def _summarise() -> int:
    failed = 0
    for folder, keys in sweep.current:
        failed += sweep.summarise(folder, keys)
        if (folder / "sweep.csv").exists():
            logging.getLogger("gear_damping").info("the sweep lies in %s (sweep.csv, sweep.png)", folder)
    return failed


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
        "",
        "task        train (default), simulate, evaluate, identify, explain, inspect, plan, paper",
        "groups      choose with group=choice:",
    ]
    lines += [f"  {group:<12}{', '.join(choices)}" for group, choices in groups().items()]
    lines += [
        "keys        set with key=value:",
        "  seed, seeds, checkpoint, resume, measurement.path, training.max_epochs, training.batch_size",
        "  simulator.<effect>.<parameter>, simulator.damping_ratio_percent, simulator.solver.accuracy",
        "  --cfg job   shows the whole configuration with every key",
    ]
    return "\n".join(lines)
