"""Which decision a threshold makes, and what it decides at made-up numbers on either side of it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from gear_damping.explanation.settings import SearchSettings


@dataclass(frozen=True)
class Decision:
    """A decision.

    Args:
        made: It, under some settings.
        expected: What comes of it under the defaults.
    """

    made: Callable[[SearchSettings], Any]
    expected: Any


DECISIONS: dict[str, Decision] = {}


def decides(threshold: str, expected: Any) -> Callable:
    """Declare what a threshold decides."""

    def declare(made: Callable[[SearchSettings], Any]) -> Callable[[SearchSettings], Any]:
        assert threshold not in DECISIONS, threshold
        DECISIONS[threshold] = Decision(made, expected)
        return made

    return declare
