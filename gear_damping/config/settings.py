"""The settings of one run: what every task receives."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from gear_damping.config import schema
from gear_damping.config.combinations import Whole, combination_problems
from gear_damping.config.learners import ModelSettings, read_models, read_wavelet
from gear_damping.config.measured import measurement_file
from gear_damping.config.simulator import SimulatorSettings, read_simulator
from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem
from gear_damping.explanation.settings import SearchSettings


@dataclass(frozen=True)
class Settings:
    """A checked configuration; the groups `protocol`, `wavelet` and `training` as plain values."""

    task: str
    name: str
    seed: int
    seeds: int
    checkpoint: Path | None
    resume: Path | None
    data_folder: Path
    progress: bool
    ruled_out: tuple[str, ...]
    explain_minutes: float
    search: SearchSettings
    write_measurement: bool
    simulator: SimulatorSettings
    protocol: dict[str, Any]
    wavelet: dict[str, Any]
    model: ModelSettings
    training: dict[str, Any]
    measurement_path: Path | None
    measurement_channel: str | None
    measurement_plugins: tuple[str, ...]

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
    problems = schema.check(config, origin)
    simulator = models = wavelet = None
    nodes = {group: config.get(group) for group in schema.ELSEWHERE}
    for group, node in nodes.items():
        if not isinstance(node, Mapping):
            problems.append(Problem(group, "is a group of keys", node, f"choose {group}=<choice>", origin.of(group)))
    if isinstance(nodes["model"], Mapping):
        try:
            models = read_models(nodes["model"], origin)
        except InputError as error:
            problems += error.problems
    if isinstance(nodes["wavelet"], Mapping):
        try:
            wavelet = read_wavelet(nodes["wavelet"], models.plugins if models else (), origin)
        except InputError as error:
            problems += error.problems
    if all(isinstance(nodes[group], Mapping) for group in ("simulator", "family")):
        try:
            simulator = read_simulator(nodes["simulator"], nodes["family"], origin)
        except InputError as error:
            problems += error.problems
    path = (config.get("measurement") or {}).get("path")
    whole = Whole(config, simulator, origin)
    problems += combination_problems(whole, {problem.key for problem in problems})
    if problems:
        raise InputError(problems)
    return Settings(
        task=config["task"],
        name=config["name"],
        seed=config["seed"],
        seeds=config["seeds"],
        checkpoint=_path(config["checkpoint"]),
        resume=_path(config["resume"]),
        data_folder=Path(config["data_folder"]),
        progress=config["progress"],
        ruled_out=tuple(config["ruled_out"] or ()),
        explain_minutes=float(config["explain"]["minutes"]),
        search=SearchSettings(**{one.name: config["explain"][one.name] for one in fields(SearchSettings)}),
        write_measurement=config["write_measurement"],
        simulator=simulator,
        protocol=dict(config["protocol"]),
        wavelet=wavelet,
        model=models,
        training=dict(config["training"]),
        measurement_path=measurement_file(path) if path else None,
        measurement_channel=config["measurement"]["channel"],
        measurement_plugins=tuple(config["measurement"]["plugins"] or ()),
    )


def _path(text: str | None) -> Path | None:
    return None if text is None else Path(text)
