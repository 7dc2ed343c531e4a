"""The `model` node: which estimators are trained, and the numbers that they are built by."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from gear_damping.config.schema import Key, problem_with, problems_with
from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem
from gear_damping.identification.estimators.base import Setting, WindowEstimator
from gear_damping.identification.estimators.catalogue import KEY, estimator_catalogue

PLUGINS = Key("names", optional=True)


@dataclass(frozen=True)
class ModelSettings:
    """The estimators of a run.

    Args:
        settings: The numbers that each is built by, by name of the estimator and of the setting.
        plugins: The user's own estimator files.
    """

    settings: dict[str, dict[str, float | int]]
    plugins: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The estimators."""
        return tuple(self.settings)


def read_models(node: Mapping[str, Any], origin: Origin) -> ModelSettings:
    """The checked `model` node.

    A setting counts for every estimator that has it.

    Raises:
        InputError: everything that is wrong with it.
    """
    plugins = node.get("plugins") or []
    wrong = problem_with(plugins, PLUGINS, KEY, origin) if plugins else None
    if wrong:
        raise InputError(wrong)
    try:
        known = estimator_catalogue(plugins)
    except InputError as error:
        raise InputError([Problem(p.key, p.rule, p.value, p.remedy, origin.of(KEY)) for p in error.problems]) from error
    names = Key("names", choices=tuple(known))
    if "names" not in node or problem_with(node["names"], names, "model.names", origin):
        raise InputError(problems_with({"names": node.get("names")}, {"names": names}, "model.", origin))
    chosen = {name: known[name] for name in node["names"]}
    schema = {"names": names, "plugins": PLUGINS} | _schema_of(chosen)
    given = {setting: node.get(setting, one.default) for setting, one in _settings_of(chosen).items()}
    problems = problems_with({**node, **given, "plugins": plugins or None}, schema, "model.", origin)
    if problems:
        raise InputError(problems)
    own = {name: {one.name: given[one.name] for one in kind.settings} for name, kind in chosen.items()}
    return ModelSettings(own, tuple(plugins))


def _settings_of(chosen: Mapping[str, type[WindowEstimator]]) -> dict[str, Setting]:
    return {one.name: one for kind in chosen.values() for one in kind.settings}


def _schema_of(chosen: Mapping[str, type[WindowEstimator]]) -> dict[str, Key]:
    return {
        name: Key("int" if one.is_whole else "float", one.lower, one.upper)
        for name, one in _settings_of(chosen).items()
    }
