"""Which file or override a value came from, for messages."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import yaml

from gear_damping.config.command_line import typed_value
from gear_damping.config.locate import conf_folder


@dataclass(frozen=True)
class Origin:
    """Where values come from: the overrides, and the choice of each group."""

    overrides: Sequence[str] = ()
    choices: Mapping[str, str | None] = ()

    def of(self, key: str) -> str:
        """The command line, or the last file that gives the key."""
        typed = typed_value(self.overrides, key)
        if typed is not None:
            return f"command line: {typed}"
        group = key.split(".")[0]
        chosen = dict(self.choices)
        places = [("experiment", chosen.get("experiment")), ("training", chosen.get("training"))]
        places += [("family", chosen.get("family")), (group, chosen.get(group))]
        for place, choice in places:
            path = conf_folder() / place / f"{choice}.yaml"
            if choice and path.is_file() and _gives(path.read_text(), key, group if place == group else ""):
                return f"conf/{place}/{choice}.yaml"
        return "conf/config.yaml"


def _gives(text: str, key: str, group: str) -> bool:
    """Whether a YAML text has the key; keys of a group's own file lack the group's name."""
    node: Any = yaml.safe_load(text)
    parts = key.split(".")
    if group and "@package _global_" not in text:
        parts = parts[1:]
    for part in parts:
        if not isinstance(node, Mapping) or part not in node:
            return False
        node = node[part]
    return True
