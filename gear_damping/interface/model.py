"""A model with its values, and the configuration that says the same."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import yaml

from gear_damping.config.decided import TORQUE, UNSAID, decided_by_options, holds_unsaid
from gear_damping.config.simulator import SimulatorSettings, read_simulator
from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem
from gear_damping.interface.arguments import file_path
from gear_damping.interface.new_file import written_anew
from gear_damping.interface.stated_ratio import at_its_ratio, refuse_both
from gear_damping.physics import model as physics
from gear_damping.physics.systems.base import System
from gear_damping.physics.terms import Effect

HOW = {
    "n_runs": 1, "n_samples": 2, "damping_law": None, "damping_ratio_percent": None, "diverged_share": 0.0,
    "extended": None, "plugins": [], "solver": {"accuracy": 1e-5, "substeps": None, "engine": "auto", "chunk": 4096},
}  # fmt: skip
FIXED = {"name": "fixed", "start": "static", "perturbation": 0.0}  # a family of which nothing varies
HEADER = (
    "# A simulator; values are SI, or of a `unit` per unit of mass.\n"
    "# Use it by simulator.extended=PATH, or gd.Model.from_config(PATH).\n"
)


class Model(physics.Model):
    """A base system with its effects and the values of both.

    Printed, it is its equation, term by term. Two models are equal where system, effects and values are.
    """

    def __init__(self, system: System, effects: Sequence[Effect] = ()) -> None:
        """Compose it.

        Args:
            system: `GearPair(...)` or `Oscillator(...)`.
            effects: Any of the catalogue's, and of one's own.

        Raises:
            InputError: an effect does not go with the system, is there twice, lacks another one that it needs or a
                value without a default, a value has no effect beside an option of the system, or there is not exactly
                one mesh stiffness in a gear pair.
        """
        super().__init__(system, effects)
        refuse_decided(self, self.given)
        self.prepare(self.values(1))  # lists of unequal length and missing values show here

    @classmethod
    def from_config(cls, node: Mapping[str, Any] | Path | str) -> "Model":
        """The model of a `simulator` node, or of a file that holds one, such as `extended_simulator.yaml`.

        Args:
            node: Keys as on the command line: numbers in SI or {value, unit}, or with the unit in the key. What says
                how to simulate, as `n_samples`, is no part of a model and is left out.

        Raises:
            InputError: everything that is wrong with it.
        """
        what = "a simulator's YAML, or the mapping that it holds"
        is_node = isinstance(node, Mapping)
        content, source = (node, "the mapping") if is_node else (_read(file_path("node", node, what)), str(node))
        if content.get("extended") is not None:
            rule, remedy = "names another file, which is not read here", "give from_config its path alone"
            raise InputError(Problem("simulator.extended", rule, content["extended"], remedy, source))
        settings = read_simulator({**HOW, **content}, FIXED, _Given(source, content))
        refuse_both(settings, source)
        return cls.of_settings(settings)

    @classmethod
    def of_settings(cls, settings: SimulatorSettings) -> "Model":
        """The model that the command line was asked for, at its damping ratio where one is asked for."""
        return cls.holding(settings.model, at_its_ratio(settings))

    @classmethod
    def holding(
        cls,
        model: physics.Model,
        values: Mapping[str, float | tuple[float, ...]],
        options: Mapping[str, Any] = MappingProxyType({}),
    ) -> "Model":
        """A model with values, by flat name in SI or in the unit of its system, in its own hands.

        Args:
            model: What holds none, or other ones.
            values: By flat name.
            options: Of the system, in the place of the model's.
        """
        known = model.parameters().keys() - decided_by_options(model)  # of which a model holds none
        given = {name: value for name, value in values.items() if name in known}
        system = type(model.system)(
            **{**model.system.chosen, **options}, **{k: v for k, v in given.items() if "." not in k}
        )
        effects = [
            type(effect)(**effect.chosen, **{p.name: given[f"{effect.name}.{p.name}"] for p in effect.parameters
                                             if f"{effect.name}.{p.name}" in given})
            for effect in model.effects
        ]  # fmt: skip
        return cls(system, effects)

    def to_config(self) -> dict[str, Any]:
        """The `simulator` node that describes it: every option and every value that was given, as plain values.

        They are in SI, or in its `unit` per unit of mass.
        """
        node: dict[str, Any] = {"system": self.system.name, **self.system.chosen, **_plain(self.system.given)}
        return node | {effect.name: {**effect.chosen, **_plain(effect.given)} for effect in self.effects}

    def write(self, path: Path | str) -> Path:
        """Write the node as YAML, for `simulator.extended=PATH` and `Model.from_config`; an existing file stays.

        Raises:
            FileExistsError: there is such a file.
        """
        return written_anew(path, HEADER + yaml.safe_dump(self.to_config(), sort_keys=False))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Model):
            return NotImplemented
        return (self.system, self.effects) == (other.system, other.effects)

    def __hash__(self) -> int:
        return hash((self.system, self.effects))

    def __repr__(self) -> str:
        return f"Model({self.system!r}, [{', '.join(map(repr, self.effects))}])"

    def __str__(self) -> str:
        declared, lines = self.parameters(), [repr(self.system), *(f"  {effect}" for effect in self.effects)]
        for name, value in self.given.items():
            shown = f"{value:g}" if isinstance(value, float) else "[" + ", ".join(f"{v:g}" for v in value) + "]"
            unit = self.system.told_unit(declared[name].unit)
            lines.append(f"    {name} = {shown}" + ("" if unit == "1" else f" {unit}"))
        return "\n".join(lines)


def refuse_decided(model: physics.Model, given: Mapping[str, Any], series: Collection[str] = ()) -> None:
    """Refuse values and series without effect.

    Args:
        model: The model.
        given: Values by flat name.
        series: Names of series that drive it.

    Raises:
        InputError: an option of the system decides one of them.
    """
    decided = decided_by_options(model)
    problems = [Problem(name, one.rule, given[name], one.remedy) for name, one in decided.items() if name in given]
    problems += [
        Problem(f"inputs.{name}", one.rule, None, one.remedy) for name, one in decided.items() if name in series
    ]
    if problems:
        raise InputError(problems)


def refuse_unsaid(model: physics.Model, given: Collection[str]) -> None:
    """Refuse to simulate a gear whose torque is held where nobody says at what: 0 would be no usual value.

    Args:
        model: The model.
        given: Names of values and series.

    Raises:
        InputError: its torque is not given.
    """
    if holds_unsaid(model, given):
        remedy = f"give {TORQUE}: n_teeth_gear / n_teeth_pinion times the torque on the pinion balances it"
        raise InputError(Problem(TORQUE, UNSAID, remedy=remedy))


class _Given(Origin):
    """Where values come from that were handed over in Python."""

    def __init__(self, source: str, content: Mapping[str, Any]) -> None:
        super().__init__()
        vars(self).update(source=source, content=content)

    def of(self, key: str) -> str:
        """The mapping, or the file."""
        return self.source

    def is_of_the_file(self, key: str) -> bool:
        """Whether it gives the key, as the file of an extended simulator does."""
        return key.partition(".")[2] in self.content


def _read(path: Path) -> Mapping[str, Any]:
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        rule = f"cannot be read: {str(error).splitlines()[0]}"
        raise InputError(Problem("simulator", rule, str(path), "give the path of a simulator's YAML")) from error
    if not isinstance(content, Mapping) or "system" not in content:
        remedy = "give a file that begins with `system: gear_pair`, as extended_simulator.yaml does"
        raise InputError(Problem("simulator", "holds no simulator: it names no system", str(path), remedy))
    return content


def _plain(given: Mapping[str, float | tuple[float, ...]]) -> dict[str, Any]:
    return {name: list(value) if isinstance(value, tuple) else value for name, value in given.items()}
