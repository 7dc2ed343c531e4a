"""The settings of one run: what every task receives."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gear_damping.config import schema
from gear_damping.config.locate import conf_folder
from gear_damping.config.simulator import SimulatorSettings, read_simulator
from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem


@dataclass(frozen=True)
class Settings:
    """A checked configuration; the groups `protocol`, `wavelet`, `model` and `training` as plain values."""

    task: str
    name: str
    seed: int
    seeds: int
    checkpoint: Path | None
    resume: Path | None
    data_folder: Path
    progress: bool
    write_measurement: bool
    simulator: SimulatorSettings
    protocol: dict[str, Any]
    wavelet: dict[str, Any]
    model: dict[str, Any]
    training: dict[str, Any]
    measurement_path: Path | None
    measurement_channel: str | None

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
    simulator = None
    for group in schema.ELSEWHERE:
        if not isinstance(config.get(group), Mapping):
            problems.append(Problem(group, "is a group of keys", config.get(group), f"choose {group}=<choice>"))
    if all(isinstance(config.get(group), Mapping) for group in schema.ELSEWHERE):
        try:
            simulator = read_simulator(config["simulator"], config["family"], origin)
        except InputError as error:
            problems += error.problems
    problems += [] if problems else _combinations(config, simulator, origin)
    if problems:
        raise InputError(problems)
    path = config["measurement"]["path"]
    return Settings(
        task=config["task"],
        name=config["name"],
        seed=config["seed"],
        seeds=config["seeds"],
        checkpoint=_path(config["checkpoint"]),
        resume=_path(config["resume"]),
        data_folder=Path(config["data_folder"]),
        progress=config["progress"],
        write_measurement=config["write_measurement"],
        simulator=simulator,
        protocol=dict(config["protocol"]),
        wavelet={key: value for key, value in config["wavelet"].items() if value is not None},
        model=dict(config["model"]),
        training=dict(config["training"]),
        measurement_path=_measurement(path),
        measurement_channel=config["measurement"]["channel"],
    )


def _combinations(config: Mapping[str, Any], simulator: SimulatorSettings, origin: Origin) -> list[Problem]:
    """What is wrong with values that are each right by themselves."""
    problems = []

    def add(key: str, rule: str, value: Any, remedy: str) -> None:
        problems.append(Problem(key, rule, value, remedy, origin.of(key)))

    task, protocol = config["task"], config["protocol"]
    for key, path in (("checkpoint", config["checkpoint"]), ("resume", config["resume"])):
        if path is not None and not Path(path).exists():
            add(key, "no such file or folder", path, "give the path of an earlier run's")
    if task in ("identify", "explain") and config["measurement"]["path"] is None:
        add("measurement.path", f"task={task} needs a measurement", None, "measurement.path=PATH/measurement.yaml")
    if task == "evaluate" and config["checkpoint"] is None:
        add("checkpoint", "task=evaluate needs a trained estimator", None, "checkpoint=…/best.ckpt")
    if protocol["window"] > simulator.n_samples:
        add(
            "protocol.window",
            f"must not exceed simulator.n_samples = {simulator.n_samples}",
            protocol["window"],
            "shorten it",
        )
    wavelet = config["wavelet"]
    if wavelet["frequency_min_hz"] >= wavelet["frequency_max_hz"]:
        add("wavelet.frequency_min_hz", "must lie below frequency_max_hz", wavelet["frequency_min_hz"], "lower it")
    if wavelet["frequency_max_hz"] >= simulator.sampling_rate / 2 and task == "train":
        rule = f"must lie below half the sampling rate, {simulator.sampling_rate / 2:g} Hz"
        add("wavelet.frequency_max_hz", rule, wavelet["frequency_max_hz"], "lower it, or sample faster")
    if simulator.damping_ratio_percent is not None and protocol["name"] != "by_run" and task == "train":
        rule = "test runs of one ratio need whole runs to test on"
        add("simulator.damping_ratio_percent", rule, simulator.damping_ratio_percent, "choose protocol=by_run")
    return problems


def _path(text: str | None) -> Path | None:
    return None if text is None else Path(text)


def _measurement(text: str | None) -> Path | None:
    """The measurement file; one that comes with the package is found from any folder."""
    if text is None:
        return None
    path = Path(text)
    packaged = conf_folder().parent / path
    return packaged if not path.exists() and text.startswith("conf/") and packaged.exists() else path
