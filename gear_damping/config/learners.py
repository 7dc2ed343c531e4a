"""The `model` and `wavelet` nodes: which estimators are trained, on what, and the numbers that they are built by."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from gear_damping.config.keys import problem_with, read_keys
from gear_damping.config.source import COMMAND_LINE, Origin
from gear_damping.errors import InputError, Problem
from gear_damping.identification.catalogue import KEY, estimator_catalogue, wavelet_catalogue
from gear_damping.identification.estimators.base import Estimator, LearnedEstimator, RecordEstimator, RecordNetwork
from gear_damping.schema.values import Flag, Given, Names, Number, OneOf, Value
from gear_damping.setting import Setting
from gear_damping.signals.wavelets.base import MOST_SCALES

PLUGINS = Given(Names(), optional=True)
FREQUENCIES = {
    "frequency_min_hz": Number(0, 1e12, exclusive=True),
    "frequency_max_hz": Number(0, 1e12, exclusive=True),
    "n_scales": Number(2, MOST_SCALES, whole=True),
}


@dataclass(frozen=True)
class ModelSettings:
    """The estimators of a run.

    Args:
        settings: The numbers that each is built by, by name of the estimator and of the setting.
        plugins: The user's own files of estimators and wavelets.
        of_records: Those that learn nothing and take a record by itself.
        whole: The networks that see whole records, no windows.
        transforming: The networks that read the wavelet transform of the group `wavelet`.
    """

    settings: dict[str, dict[str, float | int | bool]]
    plugins: tuple[str, ...] = ()
    of_records: tuple[str, ...] = ()
    whole: tuple[str, ...] = ()
    transforming: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The estimators."""
        return tuple(self.settings)


def read_models(node: Mapping[str, Any], origin: Origin) -> ModelSettings:
    """The checked `model` node. A setting counts for every estimator that has it.

    Raises:
        InputError: everything that is wrong with it.
    """
    plugins, known = _own(node, origin)
    names = Names(tuple(known))
    _require(node, "names", names, "model.", origin)
    chosen = {name: known[name] for name in node["names"]}
    node = _without_others(node, chosen, known, origin)
    settings = {one.name: one for kind in chosen.values() for one in kind.settings}
    given = {name: node.get(name, one.default) for name, one in settings.items()}
    kinds = {"names": names, "plugins": PLUGINS} | _kinds_of(settings.values())
    read, problems = read_keys({**node, **given, "plugins": list(plugins) or None}, kinds, "model.", origin)
    if problems:
        raise InputError(problems)
    own = {name: {one.name: read[one.name] for one in kind.settings} for name, kind in chosen.items()}
    networks = {name: kind for name, kind in chosen.items() if issubclass(kind, LearnedEstimator)}
    return ModelSettings(
        own,
        plugins,
        of_records=tuple(name for name, kind in chosen.items() if issubclass(kind, RecordEstimator)),
        whole=tuple(name for name, kind in networks.items() if issubclass(kind, RecordNetwork)),
        transforming=tuple(name for name, kind in networks.items() if kind.transforms),
    )


def read_wavelet(node: Mapping[str, Any], plugins: tuple[str, ...], origin: Origin) -> dict[str, Any]:
    """The checked `wavelet` node as the plain arguments of `make_wavelet`.

    Raises:
        InputError: everything that is wrong with it.
    """
    known = wavelet_catalogue(plugins)
    chosen_kind = OneOf(tuple(known))
    _require(node, "kind", chosen_kind, "wavelet.", origin)
    chosen = known[node["kind"]]
    settings = {one.name: one for one in chosen.own_settings}
    own = {name: one.default if node.get(name) is None else node[name] for name, one in settings.items()}
    others = {one.name: name for name, kind in known.items() for one in kind.own_settings if one.name not in settings}
    foreign = {name: value for name, value in node.items() if name in others}
    problems = [
        Problem(
            f"wavelet.{name}",
            f"belongs to the {others[name].capitalize()} wavelet",
            value,
            f"choose wavelet={others[name]}",
            origin.of(f"wavelet.{name}"),
        )
        for name, value in foreign.items()
        if value is not None
    ]
    left = {name: value for name, value in node.items() if name not in foreign}
    kinds = {"kind": chosen_kind} | FREQUENCIES | _kinds_of(settings.values())
    read, wrong = read_keys({**left, **own}, kinds, "wavelet.", origin)
    problems += wrong
    if problems:
        raise InputError(problems)
    return {name: read[name] for name in {**left, **own}}


def _without_others(
    node: Mapping[str, Any], chosen: Iterable[str], known: Mapping[str, type[Estimator]], origin: Origin
) -> dict[str, Any]:
    """The node without what a file of `conf/model` sets for estimators that are not trained; typed, it is refused."""
    used = {one.name for name in chosen for one in known[name].settings}
    others = {one.name for kind in known.values() for one in kind.settings} - used
    return {key: v for key, v in node.items() if key not in others or origin.place(f"model.{key}") == COMMAND_LINE}


def _own(node: Mapping[str, Any], origin: Origin) -> tuple[tuple[str, ...], dict[str, type[Estimator]]]:
    """The user's own files, every one of which can be used, and the estimators that there are with them."""
    plugins = node.get("plugins") or []
    wrong = problem_with(plugins, PLUGINS, KEY, origin) if plugins else None
    if wrong:
        raise InputError(wrong)
    try:
        return tuple(plugins), estimator_catalogue(plugins)
    except InputError as error:
        raise InputError([replace(problem, source=origin.of(KEY)) for problem in error.problems]) from error


def _require(node: Mapping[str, Any], name: str, kind: Value, prefix: str, origin: Origin) -> None:
    """Refuse a node in which a key is missing or wrong, on which all others depend."""
    part = {name: node[name]} if name in node else {}
    _, problems = read_keys(part, {name: kind}, prefix, origin)
    if problems:
        raise InputError(problems)


def _kinds_of(settings: Iterable[Setting]) -> dict[str, Value]:
    return {one.name: Flag() if one.kind == "bool" else Number(one.lower, one.upper, one.kind == "int")
            for one in settings}  # fmt: skip
