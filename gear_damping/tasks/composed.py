"""The configuration of a command: composed by Hydra, in plain containers, and what is wrong with it.

What checks is imported where it is needed: `--help` needs none of it, a mistake in a measurement.yaml is answered
before anything that simulates, and task=inspect does without that.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hydra import compose, initialize_config_dir
from hydra.core.global_hydra import GlobalHydra
from hydra.errors import HydraException
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException

from gear_damping.config.command_line import parse
from gear_damping.config.folders import unusable
from gear_damping.config.locate import conf_folder, groups
from gear_damping.config.measured import INSPECT, MEASURED, declares, measurement_file
from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem
from gear_damping.own_files import errors_in
from gear_damping.tasks.own_parts import plugins_of
from gear_damping.tasks.wrong_declaration import PATH, placed


def composed(overrides: Sequence[str]) -> tuple[dict[str, Any], Origin]:
    """The configuration of these overrides and where its values come from.

    Raises:
        InputError: Hydra refuses them, or the run's folder cannot be made.
    """
    GlobalHydra.instance().clear()
    try:
        with initialize_config_dir(str(conf_folder()), version_base="1.3"):
            config = compose("config", list(overrides), return_hydra_config=True)
            _refuse_folder(config)
            return plain(config), Origin(list(overrides), choices_of(config.hydra))
    except InputError:
        raise
    except (HydraException, OmegaConfBaseException, ValueError) as error:  # of a deletion that names a number, say
        said = str(error).split("\n")[0]
        raise InputError(Problem("configuration", said, remedy="see python -m gear_damping --help")) from error


def problems_of(overrides: Sequence[str], declared: bool = True) -> list[Problem]:
    """Everything that is wrong with the configuration of these overrides.

    Args:
        overrides: As Hydra shall see them.
        declared: Whether a measurement.yaml that they name is looked into.
    """
    try:
        config, origin = composed(overrides)
        problems = _problems_of_measurement(config, origin, declared)
        if problems or (config.get("task") == INSPECT and not _physics_typed(overrides)):
            return problems
        from gear_damping.config.settings import read_settings

        with errors_in(plugins_of(config), origin.of):
            read_settings(config, origin)
    except InputError as error:
        return error.problems
    return []


def _problems_of_measurement(config: Mapping[str, Any], origin: Origin, declared: bool) -> list[Problem]:
    """What is wrong with the YAML of a task that reads one, and with the keys beside it.

    Where only the path is wrong, and the task simulates, the check of the whole configuration says it.
    """
    task = config.get("task")
    if task not in MEASURED:
        return []
    from gear_damping.config.light import light_problems
    from gear_damping.measurement.formats.registry import KEY as PLUGINS
    from gear_damping.measurement.formats.registry import readers
    from gear_damping.measurement.load import check_declaration

    problems = light_problems(config, origin)
    path = (config.get("measurement") or {}).get("path")
    file = measurement_file(path) if isinstance(path, str) else None
    plugins = tuple(plugins_of({"measurement": config.get("measurement")}))
    try:
        if plugins:
            readers(plugins)
        if declared and file is not None and declares(file, task):
            other = _of_another_system(config, origin, check_declaration(file, plugins).system)
            return problems + other if other or task == INSPECT else []
    except InputError as error:
        return problems + placed(error, {key: origin.of(key) for key in (PATH, PLUGINS)})
    return problems if task == INSPECT else []


def _of_another_system(config: Mapping[str, Any], origin: Origin, measured: str) -> list[Problem]:
    """A typed `simulator=` that says of the rig what its measurement.yaml contradicts; a file on top has its own."""
    from gear_damping.config.acting import OF_A_RIG
    from gear_damping.measurement.layout import SYSTEMS

    typed = dict(origin.typed()).get("simulator")
    simulator = config.get("simulator")
    if typed is None or config["task"] not in OF_A_RIG or not isinstance(simulator, Mapping):
        return []
    if typed == measured or not {typed, measured} <= {*SYSTEMS} or simulator.get("extended") is not None:
        return []
    rule = f"contradicts the measurement, which says system: {measured}, by which the rig is simulated here"
    remedy = "leave it out, with family=none beside it, or correct system in the measurement.yaml"
    return [Problem("simulator", rule, typed, remedy, origin.of("simulator"))]


def _physics_typed(overrides: Sequence[str]) -> bool:
    """Whether the command line says something of the simulator, which is then to be right, used or not."""
    from gear_damping.config.keys import ELSEWHERE

    return any(parse(override).key_or_group.split(".")[0] in ELSEWHERE for override in overrides)


def plain(config: DictConfig) -> dict[str, Any]:
    """Plain containers without Hydra's own part."""
    own = OmegaConf.masked_copy(config, [key for key in config if key != "hydra"])
    return OmegaConf.to_container(own, resolve=True)


def choices_of(hydra_config: DictConfig) -> dict[str, str | None]:
    """The choice of each group that a user may set."""
    return {group: choice for group, choice in hydra_config.runtime.choices.items() if group in groups()}


def _refuse_folder(config: DictConfig) -> None:
    """The folder of the run can be made: said before any work."""
    folder = Path(config.hydra.run.dir).absolute()
    rule = unusable(folder)
    if rule:
        raise InputError(Problem("hydra.run.dir", rule, str(folder), "give another folder", "the command line"))
