"""Reads a node of the configuration and collects every problem on the way."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

from gear_damping.config.keys import read_value, without_group
from gear_damping.config.quantities import parameter_value, split_suffix
from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem, nearest
from gear_damping.physics.parameter import Parameter
from gear_damping.schema.values import Value


class Reader:
    """Where problems gather while the simulator and the family are read."""

    def __init__(self, origin: Origin) -> None:
        self.origin = origin
        self.problems: list[Problem] = []

    def refuse(self, key: str, rule: str, value: Any = None, remedy: str = "") -> None:
        """Note a problem with a key."""
        self.problems.append(Problem(key, rule, value, remedy, self.origin.of(key)))

    def refuse_unknown(self, key: str, choices: Iterable[str], rule: str = "no such key") -> None:
        """Note a key whose last part is none of the choices."""
        names = list(choices)
        near = nearest(key.split(".")[-1], names) if names else "it takes none"
        self.refuse(key, rule, remedy=without_group(key) or near)

    def collect(self, work: Callable[[], Any], group: str = "") -> Any:
        """The result of `work`; None where it raised an InputError, whose problems are kept.

        Args:
            work: What may raise.
            group: The group that keys without one belong to.
        """
        try:
            return work()
        except InputError as error:
            self.problems += [self._placed(problem, group) for problem in error.problems]
            return None

    def _placed(self, problem: Problem, group: str) -> Problem:
        if problem.source:
            return problem
        inside = not group or problem.key.split(".")[0] == group
        key = problem.key if inside else f"{group}.{problem.key}"
        return replace(problem, key=key, source=self.origin.of(key))

    def plain(self, node: Mapping[str, Any], kinds: Mapping[str, Value], prefix: str) -> dict[str, Any]:
        """Values of the keys in `kinds`, None where one is wrong."""
        found = {}
        for name, kind in kinds.items():
            found[name], problem = read_value(node.get(name), kind, prefix + name, self.origin)
            self.problems += [problem] if problem else []
        return found

    def parameters(self, node: Mapping[str, Any], declared: Mapping[str, Parameter], prefix: str) -> dict[str, Any]:
        """Values in SI by parameter name; keys that are not declared are left to the caller."""
        spellings: dict[str, list[str]] = {}
        for key in node:
            name, _ = split_suffix(key, declared)
            if name in declared:
                spellings.setdefault(name, []).append(key)
        found = {name: self._parameter(node, declared[name], keys, prefix) for name, keys in spellings.items()}
        return {name: value for name, value in found.items() if value is not None}

    def _parameter(self, node: Mapping[str, Any], parameter: Parameter, keys: list[str], prefix: str) -> Any:
        """The value under the spelling that was given last: `pinion_speed` beats an earlier `pinion_speed_rpm`."""
        ranked = sorted(keys, key=lambda key: self.origin.rank(prefix + key))
        ranks = [self.origin.rank(prefix + key) for key in ranked]
        if len(ranks) > 1 and ranks[-1] == ranks[-2]:
            both = " and ".join(prefix + key for key in ranked[-2:])
            self.refuse(prefix + ranked[-1], f"is given twice, as {both}", node[ranked[-1]], "keep one")
        key = ranked[-1]
        unit = split_suffix(key, {parameter.name: parameter})[1]
        full = prefix + key
        return self.collect(lambda: parameter_value(node[key], parameter, full, self.origin.of(full), unit))
