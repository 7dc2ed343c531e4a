"""The configuration of a command: composed by Hydra, in plain containers."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hydra import compose, initialize_config_dir
from hydra.core.global_hydra import GlobalHydra
from hydra.errors import HydraException
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException

from gear_damping.config.folders import unusable
from gear_damping.config.locate import conf_folder, groups
from gear_damping.config.settings import read_settings
from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem
from gear_damping.tasks.own_effects import errors_in, plugins_of


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
    except (HydraException, OmegaConfBaseException) as error:
        said = str(error).split("\n")[0]
        raise InputError(Problem("configuration", said, remedy="see python -m gear_damping --help")) from error


def problems_of(overrides: Sequence[str]) -> list[Problem]:
    """Everything that is wrong with the configuration of these overrides."""
    try:
        config, origin = composed(overrides)
        with errors_in(plugins_of(config), origin.of("simulator.plugins")):
            read_settings(config, origin)
    except InputError as error:
        return error.problems
    return []


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
