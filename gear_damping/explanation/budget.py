"""The time that a search may take, and what it then has not tried."""

from dataclasses import dataclass, field
from math import inf
from time import monotonic

SEARCH_SHARE = 0.85  # of the time; the rest is for what is under way, and for opening held-out records


@dataclass
class Budget:
    """Minutes from now on.

    Args:
        minutes: How many; infinitely many where absent.
        not_tried: What was left out because they were spent, in the order in which it would have been tried.
    """

    minutes: float = inf
    not_tried: list[str] = field(default_factory=list)
    _begun: float = field(default_factory=monotonic)

    @property
    def spent(self) -> bool:
        """Whether the time for the search is over."""
        return monotonic() - self._begun > 60 * SEARCH_SHARE * self.minutes

    @property
    def sentence(self) -> str:
        """What there was no time for; empty where there was for everything."""
        missing = ", ".join(self.not_tried)
        said = f"The {self.minutes:g} minutes of the search were over before these were tried: {missing}."
        return said if missing else ""

    def refuses(self, what: str) -> bool:
        """Whether there is no time for it, which is then noted."""
        if self.spent and what not in self.not_tried:
            self.not_tried.append(what)
        return self.spent
