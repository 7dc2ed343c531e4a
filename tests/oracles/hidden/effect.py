"""What a hidden effect is: canonical name, parameters drawn at their largest, how they shrink, what they turn."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from .knobs import Knobs
from .pair import Rig

Params = dict[str, float | list[float] | str]
Draw = Callable[[np.random.Generator, float], Params]  # (generator, duration / s)
Turn = Callable[[Params, Knobs], Knobs]  # (parameters, the record without the effect) -> the knobs it changes


@dataclass(frozen=True)
class Effect:
    """An effect that can be hidden.

    sizes: parameters that carry the size s, each in proportion to s to this power; s = 1 is the largest, `least`
    the smallest. shrink: replaces that rule. as_modelled: knobs of a model misled by the effect, where the motion
    itself does not change. plan: the plan of records that can show it. given: what the nominal model already has.
    on_rig: what is drawn besides where the rig is not the usual one.
    """

    name: str
    draw: Draw
    turn: Turn
    sizes: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    shrink: Callable[[Params, float], Params] | None = None
    as_modelled: Turn | None = None
    least: float = 1.0 / 512.0
    plan: str = "full"
    given: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    on_rig: Callable[[np.random.Generator, Rig], Params] | None = None

    @property
    def has_size(self) -> bool:
        """Whether its size can be chosen."""
        return bool(self.sizes) or self.shrink is not None

    def at(self, params: Params, size: float) -> Params:
        """The parameters at a size between `least` and 1."""
        if self.shrink is not None:
            return self.shrink(params, size)
        return {name: _scaled(value, size ** self.sizes[name]) if name in self.sizes else value
                for name, value in params.items()}  # fmt: skip


def _scaled(value: float | list[float], factor: float) -> float | list[float]:
    return [entry * factor for entry in value] if isinstance(value, list) else value * factor


def phase(rng: np.random.Generator) -> float:
    """Anywhere on the circle / rad."""
    return float(rng.uniform(-np.pi, np.pi))


def signed(rng: np.random.Generator, value: float) -> float:
    """The value or its opposite."""
    return value if rng.random() < 0.5 else -value


def between(rng: np.random.Generator, low: float, high: float) -> float:
    """Log-uniform."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
