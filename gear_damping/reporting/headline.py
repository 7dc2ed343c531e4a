"""Which of the figures of a run are shown first. Nothing is imported here that takes long."""

from collections.abc import Iterable, Mapping
from typing import Any

from gear_damping.reporting.numbers import number

FIRST = ("rmse_percent", "verdict", "misfit_after", "damping_ratio_percent")  # how the names end of those shown first
SHOWN = 2  # figures in one line


def ranked(names: Iterable[str]) -> list[str]:
    """Names of figures, those first that are shown first; else in their order."""
    return sorted(names, key=lambda name: not name.endswith(FIRST))


def headline(metrics: Mapping[str, Any]) -> str:
    """The first figures of a run in one line.

    Args:
        metrics: Of its run.json.
    """
    shown = [(name, metrics[name]) for name in ranked(metrics) if metrics[name] not in (None, [])][:SHOWN]
    return ", ".join(f"{name} {number(value) if isinstance(value, float) else value}" for name, value in shown)
