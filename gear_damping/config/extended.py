"""`simulator.extended`: a file whose system, values and effects take the place of the chosen simulator's."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from gear_damping.config.source import EXTENDED, ORDER, Origin
from gear_damping.errors import InputError, Problem

KEY = "simulator.extended"
REMEDY = "give the path of an extended_simulator.yaml"
_FILE_RANK = ORDER.index(EXTENDED)


def with_extended(node: Mapping[str, Any], origin: Origin, settings: tuple[str, ...]) -> tuple[dict[str, Any], Origin]:
    """The `simulator` node with the extended simulator in it, and where its values come from.

    What a family, an experiment or the command line gives comes on top of the file, so that every
    experiment runs with the extended model.

    Args:
        node: The composed node.
        origin: Where its values come from.
        settings: Keys that say how to simulate, not what: they stay as chosen.

    Raises:
        InputError: the file is missing or does not hold a simulator.
    """
    path = node.get("extended")
    if not isinstance(path, str):
        return dict(node), origin
    content = _content(Path(path), origin.of(KEY), settings)
    kept = {key: value for key, value in node.items() if key in settings}
    top = {key: _added(f"simulator.{key}", value, origin) for key, value in node.items() if key not in kept}
    merged = dict(content)
    for key, value in top.items():
        if value is not _NOTHING:
            both = isinstance(value, Mapping) and isinstance(merged.get(key), Mapping)
            merged[key] = {**merged[key], **value} if both else value
    return kept | merged, origin.with_extended(path, content)


_NOTHING = object()


def _added(key: str, value: Any, origin: Origin) -> Any:
    """What of a value comes on top of the file; _NOTHING where nothing does."""
    if isinstance(value, Mapping) and "value" not in value:
        inner = {name: v for name, v in value.items() if origin.rank(f"{key}.{name}") > _FILE_RANK}
        return inner if inner or origin.rank(key) > _FILE_RANK else _NOTHING
    return value if origin.rank(key) > _FILE_RANK else _NOTHING


def _content(path: Path, source: str, settings: tuple[str, ...]) -> dict[str, Any]:
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        rule = f"cannot be read: {str(error).splitlines()[0]}"
        raise InputError(Problem(KEY, rule, str(path), REMEDY, source)) from error
    if not isinstance(content, dict) or "system" not in content:
        raise InputError(Problem(KEY, "holds no simulator: it names no system", str(path), REMEDY, source))
    foreign = sorted(set(content) & set(settings))
    if foreign:
        rule = f"sets {', '.join(foreign)}, which the configuration decides"
        raise InputError(Problem(KEY, rule, str(path), "remove it from the file", source))
    return content
