"""The command line from its words to its exit code."""

import logging
import sys
from collections.abc import Sequence
from pathlib import Path

import hydra
from hydra import compose, initialize_config_dir
from hydra.core.global_hydra import GlobalHydra
from hydra.core.hydra_config import HydraConfig
from hydra.errors import HydraException
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException

from gear_damping.config.command_line import prepare
from gear_damping.config.locate import conf_folder, groups
from gear_damping.config.settings import read_settings
from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem
from gear_damping.tasks import sweep
from gear_damping.tasks.dispatch import INTERRUPTED_CODE, OK, WRONG_INPUT, overrides_of, run_job, say_problems

HYDRA_ONLY = ("--cfg", "-c", "--info", "-i", "--resolve", "--version", "--shell-completion", "-sc", "--hydra-help")
MULTIRUN = ("--multirun", "-m")
_codes: list[int] = []


def main(arguments: Sequence[str]) -> int:
    """Run the command; returns its exit code."""
    logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stderr)
    if {"--help", "-h"} & set(arguments):
        print(help_text())
        return OK
    prepared, problems = prepare(arguments)
    many = bool(set(MULTIRUN) & set(arguments))
    if not many and not set(HYDRA_ONLY) & set(arguments):
        problems += _problems_of(overrides_of(prepared))
    if problems:
        say_problems(InputError(problems))
        return WRONG_INPUT
    return _run(prepared, many)


def _problems_of(overrides: Sequence[str]) -> list[Problem]:
    """Everything that is wrong with the configuration of these overrides."""
    try:
        read_settings(*_composed(overrides))
    except InputError as error:
        return error.problems
    return []


def _composed(overrides: Sequence[str]) -> tuple[dict, Origin]:
    """The configuration of these overrides and where its values come from; refusals of Hydra as InputError."""
    GlobalHydra.instance().clear()
    try:
        with initialize_config_dir(str(conf_folder()), version_base="1.3"):
            config = compose("config", list(overrides), return_hydra_config=True)
            return _plain(config), _origin(config, overrides)
    except (HydraException, OmegaConfBaseException) as error:
        said = str(error).split("\n")[0]
        raise InputError(Problem("configuration", said, remedy="see python -m gear_damping --help")) from error


def _plain(config: DictConfig) -> dict:
    """Plain containers without Hydra's own part."""
    own = OmegaConf.masked_copy(config, [key for key in config if key != "hydra"])
    return OmegaConf.to_container(own, resolve=True)


def _origin(config: DictConfig, overrides: Sequence[str]) -> Origin:
    return Origin(list(overrides), dict(config.hydra.runtime.choices))


def _run(arguments: list[str], many: bool) -> int:
    _codes.clear()
    sweep.current.clear()
    old, sys.argv = sys.argv, ["gear_damping", *arguments]
    command = hydra.main(version_base="1.3", config_path=str(conf_folder()), config_name="config")(_job)
    try:
        command()
    except KeyboardInterrupt:
        _codes.append(INTERRUPTED_CODE)
    except SystemExit as stop:
        _codes.append(int(stop.code or 0))
    finally:
        sys.argv = old
    failed = _summarise() if many else 0
    return max([WRONG_INPUT if failed else OK, *_codes])


def _job(config: DictConfig) -> int:
    """One job as Hydra calls it, in this process or in a worker of a launcher."""
    own = HydraConfig.get()
    plain = OmegaConf.to_container(config, resolve=True)
    origin = Origin(list(own.overrides.task), dict(own.runtime.choices))
    code = run_job(plain, origin, Path(own.runtime.output_dir))
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
        "  python -m gear_damping task=identify measurement.path=PATH/measurement.yaml",
        "",
        "task        train (default), simulate, evaluate, identify, explain",
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
