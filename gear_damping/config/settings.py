"""The settings of one run: what every task receives."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, TypeVar

from gear_damping.config import keys
from gear_damping.config.acting import IDLE
from gear_damping.config.combinations import combination_problems
from gear_damping.config.learners import ModelSettings, read_models, read_wavelet
from gear_damping.config.measured import measurement_file
from gear_damping.config.planned import PlanSettings, read_plan
from gear_damping.config.simulator import SimulatorSettings, read_simulator
from gear_damping.config.source import Origin
from gear_damping.config.whole import Whole
from gear_damping.errors import InputError, Problem
from gear_damping.explanation.settings import SearchSettings

Read = TypeVar("Read")


@dataclass(frozen=True)
class Settings:
    """A checked configuration; the groups `protocol`, `wavelet` and `training` as plain values."""

    task: str
    name: str
    seed: int
    seeds: int
    checkpoint: Path | None
    resume: Path | None
    sweep: Path | None
    data_folder: Path
    progress: bool
    ruled_out: tuple[str, ...]
    explain_minutes: float
    search: SearchSettings
    write_measurement: bool
    figures: tuple[str, ...]
    simulator: SimulatorSettings
    protocol: dict[str, Any]
    wavelet: dict[str, Any]
    model: ModelSettings
    training: dict[str, Any]
    evaluation: dict[str, Any]
    measurement_path: Path | None
    measurement_channel: str | None
    measurement_plugins: tuple[str, ...]
    plan: PlanSettings | None = None

    @property
    def all_seeds(self) -> list[int]:
        """The seed of each training."""
        return list(range(self.seed, self.seed + self.seeds))


def read_settings(config: Mapping[str, Any], origin: Origin) -> Settings:
    """Check a composed configuration (plain containers) and turn it into settings.

    Raises:
        InputError: every problem of the whole configuration.
    """
    config = {key: value for key, value in config.items() if key != "hydra"}
    config, problems = keys.check(config, origin)
    nodes = {group: config.get(group) for group in keys.ELSEWHERE}
    for group, node in nodes.items():
        if not isinstance(node, Mapping):
            problems.append(Problem(group, "is a group of keys", node, f"choose {group}=<choice>", origin.of(group)))

    def tried(read: Callable[..., Read], groups: Sequence[str], *more: Any) -> Read | None:
        """What a reader makes of groups; None where one of them cannot be read."""
        if not all(isinstance(nodes[group], Mapping) for group in groups):
            return None
        try:
            return read(*(nodes[group] for group in groups), *more, origin)
        except InputError as error:
            problems.extend(error.problems)
            return None

    models = tried(read_models, ["model"])
    wavelet = tried(read_wavelet, ["wavelet"], models.plugins if models else ())
    simulator = tried(read_simulator, ["simulator", "family"])
    plan = tried(read_plan, ["plan"], simulator) if simulator and config.get("task") == "plan" else None
    path = (config.get("measurement") or {}).get("path")
    if wavelet is not None:
        config["wavelet"] = wavelet  # its numbers are in the unit of their key now
    whole = Whole(config, simulator, origin, models)
    problems = _with_combinations(problems, whole)
    if problems:
        raise InputError(problems)
    return Settings(
        task=config["task"],
        name=config["name"],
        seed=config["seed"],
        seeds=config["seeds"],
        checkpoint=_path(config["checkpoint"]),
        resume=_path(config["resume"]),
        sweep=_path(config["sweep"]),
        data_folder=Path(config["data_folder"]),
        progress=config["progress"],
        ruled_out=tuple(config["ruled_out"] or ()),
        explain_minutes=float(config["explain"]["minutes"]),
        search=SearchSettings(**{one.name: config["explain"][one.name] for one in fields(SearchSettings)}),
        write_measurement=config["write_measurement"],
        figures=tuple(config["figures"] or ()),
        simulator=simulator,
        protocol=dict(config["protocol"]),
        wavelet=wavelet,
        model=models,
        training=dict(config["training"]),
        evaluation=dict(config["evaluation"]),
        measurement_path=measurement_file(path) if path else None,
        measurement_channel=config["measurement"]["channel"],
        measurement_plugins=tuple(config["measurement"]["plugins"] or ()),
        plan=plan,
    )


def _with_combinations(problems: Sequence[Problem], whole: Whole) -> list[Problem]:
    """Problems of single keys, then those of several; of a key of the simulator that cannot act the latter alone.

    The simulator that is read is not the one of the measurement, and no other name of a key helps.
    """
    found = combination_problems(whole, {problem.key for problem in problems})
    idle = {one.key for one in found if one.rule.startswith(IDLE) and one.key.startswith("simulator.")}
    return [*(one for one in problems if one.key not in idle), *found]


def _path(text: str | None) -> Path | None:
    return None if text is None else Path(text)
