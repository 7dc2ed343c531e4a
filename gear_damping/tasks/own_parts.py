"""The user's own files of effects, estimators, wavelets and formats that a configuration names."""

from collections.abc import Mapping
from typing import Any

GROUPS = ("simulator", "model", "measurement")  # that name files of one's own under `plugins`


def plugins_of(config: Mapping[str, Any]) -> dict[str, str]:
    """The files of one's own that a configuration names, which may be wrong in any way, with the key of each."""
    found = {}
    for group in GROUPS:
        node = config.get(group)
        named = node.get("plugins") if isinstance(node, Mapping) else None
        paths = named if isinstance(named, list) else []
        found |= {path: f"{group}.plugins" for path in paths if isinstance(path, str)}
    return found
