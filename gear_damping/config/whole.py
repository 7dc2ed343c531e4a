"""A configuration as its checks meet it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from gear_damping.config.learners import ModelSettings
from gear_damping.config.simulator import SimulatorSettings
from gear_damping.config.source import Origin


@dataclass(frozen=True)
class Whole:
    """A configuration of which the keys that a check reads are right."""

    config: Mapping[str, Any]
    simulator: SimulatorSettings | None
    origin: Origin
    models: ModelSettings | None = None

    def __getitem__(self, key: str) -> Any:
        return self.config[key]
