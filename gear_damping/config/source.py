"""Which file or override a value came from, for messages and where two spellings meet."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from gear_damping.config.command_line import parse
from gear_damping.config.locate import conf_folder, groups
from gear_damping.units import SUFFIXES

EXTENDED, EXPERIMENT, COMMAND_LINE = "extended", "experiment", "command line"
# Later ones beat earlier ones, as in the defaults list of config.yaml.
ORDER = (
    "config", "simulator", EXTENDED, "family", "protocol", "wavelet", "model", "training", "measurement",
    "plan", EXPERIMENT, COMMAND_LINE,
)  # fmt: skip


@dataclass(frozen=True)
class Origin:
    """Where values come from.

    Args:
        overrides: What was typed.
        choices: The choice of each group.
        extended: Path and content of the file that `simulator.extended` names.
    """

    overrides: Sequence[str] = ()
    choices: Mapping[str, str | None] = ()
    extended: tuple[str, Mapping[str, Any]] | None = None

    def with_extended(self, path: str, content: Mapping[str, Any]) -> "Origin":
        """The same with the file of an extended simulator."""
        return replace(self, extended=(path, content))

    def of(self, key: str) -> str:
        """The override, or the last file that gives the key; where none does, what switches its effect on.

        For a key without either it is the file that should give it.
        """
        place = self.place(key)
        parent = key.rpartition(".")[0]
        if place is None and "." in parent:
            return self.of(parent)
        if place == COMMAND_LINE:
            return f"command line: {_typed(self.overrides, key)}"
        if place == EXTENDED:
            return self.extended[0]
        group = key.split(".")[0] if place is None else place
        chosen = dict(self.choices).get(group)
        return f"conf/{group}/{chosen}.yaml" if chosen else "conf/config.yaml"

    def place(self, key: str) -> str | None:
        """The member of ORDER that gives the key, or None."""
        if _typed(self.overrides, key):
            return COMMAND_LINE
        return next((place for place in reversed(ORDER[:-1]) if self._gives(place, key)), None)

    def rank(self, key: str) -> int:
        """How late in ORDER the key is given; -1 where it is not."""
        place = self.place(key)
        return -1 if place is None else ORDER.index(place)

    def is_of_the_file(self, key: str) -> bool:
        """Whether the file of an extended simulator gives the key, and nothing after it does."""
        return self.place(key) == EXTENDED

    def typed(self) -> Iterator[tuple[str, str]]:
        """Key and value of what was typed."""
        for override in self.overrides:
            key, _, value = override.lstrip("+~").partition("=")
            yield key, value

    def given_by(self, group: str) -> dict[str, Any]:
        """The full keys that the chosen file of a group gives, a quantity with its unit as one."""
        return dict(_leaves({name: node for name, node in self._file(group).items() if name != "defaults"}))

    def usual(self, group: str) -> str | None:
        """The choice of a group where none is typed or given by an experiment."""
        defaults = self._file("config").get("defaults", ())
        return next((one[group] for one in defaults if isinstance(one, Mapping) and group in one), None)

    def _gives(self, place: str, key: str) -> bool:
        if place == EXTENDED:
            return self.extended is not None and _has({"simulator": self.extended[1]}, key)
        return _has(self._file(place), key)

    def _file(self, place: str) -> Mapping[str, Any]:
        """The content of the chosen file of a group; empty where none is chosen."""
        chosen = dict(self.choices).get(place)
        name = "config.yaml" if place == "config" else f"{place}/{chosen}.yaml"
        return _content(conf_folder() / name, place) if place == "config" or chosen else {}


def spellings(key: str) -> list[str]:
    """A key of a parameter, and with each unit that it may end in."""
    return [key, *(f"{key}_{suffix}" for suffix in SUFFIXES)]


@cache
def _content(path: Path, place: str) -> Mapping[str, Any]:
    """What a file gives, by full keys: those of a group's own file lack the group's name."""
    if not path.is_file():
        return {}
    text = path.read_text()
    content = yaml.safe_load(text) or {}
    return content if place == "config" or "@package _global_" in text else {place: content}


def _leaves(node: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Key and value of all that mappings hold."""
    if isinstance(node, Mapping) and node and "value" not in node:
        for name, inner in node.items():
            yield from _leaves(inner, f"{key}.{name}".lstrip("."))
    elif key:
        yield key, node


def _has(node: Any, key: str) -> bool:
    for part in key.split("."):
        if not isinstance(node, Mapping) or part not in node:
            return False
        node = node[part]
    return True


def _typed(overrides: Sequence[str], key: str) -> str:
    """What the command line gave for a key or one below it, as typed; empty where it gave nothing."""
    for override in reversed(overrides):
        parsed = parse(override)
        name = parsed.key_or_group
        if name in groups() or parsed.is_delete() or parsed.is_sweep_override():
            continue
        inside = key.startswith(name + ".") and _has(parsed.value(), key.removeprefix(name + "."))
        if name == key or name.startswith(key + ".") or inside:
            return override.lstrip("+")
    return ""
