"""Every estimator and every wavelet by name: those of the package, and the user's own."""

from collections.abc import Mapping, Sequence
from functools import cache
from inspect import isabstract
from pathlib import Path
from typing import Any

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.identification import estimators as room
from gear_damping.identification.estimators.base import Estimator, LearnedEstimator, RecordEstimator
from gear_damping.own_files import REMEDY, classes_of, load_module, modules_of
from gear_damping.setting import Setting
from gear_damping.signals.wavelets.base import ContinuousWavelet
from gear_damping.signals.wavelets.catalogue import builtin_wavelets

KEY = "model.plugins"
TAKEN = ("mean", "white_noise", "names", "plugins", "kind", "frequency_min_hz", "frequency_max_hz", "n_scales")
BASES = ("RecordEstimator", "WindowEstimator", "RecordNetwork", "ContinuousWavelet")
Part = type[Estimator] | type[ContinuousWavelet]


@cache
def builtin_estimators() -> dict[str, type[Estimator]]:
    """The estimators that come with the package: of records, and networks of windows."""
    kinds = (kind for module in modules_of(room) for kind in classes_of(module, Estimator))
    return {kind.name: kind for kind in kinds if not isabstract(kind)}


def estimator_catalogue(plugins: Sequence[str | Path] = ()) -> dict[str, type[Estimator]]:
    """Every known estimator, with those of the user's own files added.

    Raises:
        InputError: a file is missing, cannot be loaded, declares nothing complete, or repeats a name.
    """
    return {**builtin_estimators(), **_own(plugins, Estimator)}


def wavelet_catalogue(plugins: Sequence[str | Path] = ()) -> dict[str, type[ContinuousWavelet]]:
    """The same of wavelets."""
    return {**builtin_wavelets(), **_own(plugins, ContinuousWavelet)}


def kind_of(name: str, plugins: Sequence[str | Path] = ()) -> type[LearnedEstimator]:
    """The network of this name.

    Raises:
        InputError: there is none, or a file cannot be used.
    """
    return _of_kind(name, plugins, LearnedEstimator)


def record_estimator(
    name: str, settings: Mapping[str, float | int | bool], plugins: Sequence[str | Path] = ()
) -> RecordEstimator:
    """The estimator of records of this name, with its settings.

    Raises:
        InputError: there is none, a setting is unknown or out of range, or a file cannot be used.
    """
    kind = _of_kind(name, plugins, RecordEstimator)
    try:
        return kind(settings)
    except ValueError as error:
        raise InputError(Problem(f"estimator {name}", str(error), dict(settings))) from error


def _of_kind(name: str, plugins: Sequence[str | Path], base: type[Estimator]) -> Any:
    known = {one: kind for one, kind in estimator_catalogue(plugins).items() if issubclass(kind, base)}
    return _named("estimator", name, known)


def make_wavelet(settings: Mapping[str, Any], sampling_rate: float, plugins: Sequence[str] = ()) -> ContinuousWavelet:
    """The transform named by settings["kind"] with its other plain arguments.

    Raises:
        InputError: the kind is unknown, or a file cannot be used.
        ValueError: the transform refuses an argument.
    """
    arguments = dict(settings)
    kind = _named("wavelet.kind", str(arguments.pop("kind", None)), wavelet_catalogue(plugins))
    return kind(sampling_rate, **arguments)


def _named(key: str, name: str, known: Mapping[str, Any]) -> Any:
    if name not in known:
        what = key.partition(".")[0]
        remedy = f"{nearest(name, list(known))}; one of your own needs {KEY}=[its file]"
        raise InputError(Problem(key, f"no such {what}", name, remedy))
    return known[name]


def _own(plugins: Sequence[str | Path], base: type) -> dict[str, Any]:
    """What the user's own files declare of one kind of part."""
    found: dict[str, Any] = {}
    for path in map(Path, plugins):
        parts = _parts_of(path)
        faults = [f"the class {kind.__name__} {fault}" for kind in parts for fault in _faults(kind)]
        if not parts:
            faults = [f"declares no estimator and no wavelet: derive it from {', '.join(BASES)}"]
        taken = {*builtin_estimators(), *builtin_wavelets(), *found, *TAKEN}
        repeated = sorted({kind.name for kind in parts if not faults} & taken)
        if repeated:
            faults = [f"repeats the name {repeated}"]
        if faults:
            raise InputError([Problem(KEY, fault, str(path), REMEDY) for fault in faults])
        found |= {kind.name: kind for kind in parts}
    return {name: kind for name, kind in found.items() if issubclass(kind, base)}


def _parts_of(path: Path) -> list[Part]:
    """The parts that a file declares."""
    module = load_module(path, KEY)
    return [kind for base in (Estimator, ContinuousWavelet) for kind in classes_of(module, base)]


def _faults(kind: Part) -> list[str]:
    """What is missing or wrong in a class."""
    is_estimator = issubclass(kind, Estimator)
    found = [f"lacks {method}" for method in sorted(kind.__abstractmethods__)]
    texts = ("name", "reference") if is_estimator else ("name",)
    found += [f"lacks {one}, a text" for one in texts if not isinstance(getattr(kind, one, None), str)]
    if not found and not kind.name.isidentifier():
        found.append(f"has the name {kind.name!r}: letters, digits and '_' make a key")
    settings = kind.settings if is_estimator else kind.own_settings
    if not isinstance(settings, tuple) or not all(isinstance(one, Setting) for one in settings):
        return [*found, "lacks settings, a tuple of Setting(…); () where it has none"]
    found += [f"gives {one.name} a default outside its bounds" for one in settings if one.problem(one.default)]
    taken = [one.name for one in settings if one.name in TAKEN]
    return found + [f"has a setting called {name}, which is a key of its own" for name in taken]
