"""The time that a search may take, and what it then has not tried."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import inf
from time import monotonic

SEARCH_SHARE = 0.85  # of the time; the rest is for what is under way, for opening held-out records,
LATE = 0.5  # of the time: from there on what promises little waits for what another leaves of it
LAST_SHARE = 0.97  # and for seeing whether what was found is what it seems
SCORED_SHARE = 0.92  # of it: no effect is scored later, as what scores are for took 5 to 8 % of five slow minutes
MORE = 4  # times the minutes that were too few: the next try should not be too short too
MOST_KEPT = 0.5  # of the time, for the last looks, however long they take: the other half is for trying causes
LOOKS_LEFT = 2.5  # after the search: beside the last cause, once more where one is dropped, and half a one to spare
FIRST_LOOK = 1.0  # while nothing is found: beside what the next trial may find


@dataclass
class Budget:
    """Minutes from now on.

    Args:
        minutes: How many; infinitely many where absent.
        clock: Tells the time in s. That of the process, where a crowded machine shall find what an idle one finds.
        not_tried: What was left out because they were spent, in the order in which it would have been tried.
    """

    minutes: float = inf
    clock: Callable[[], float] = monotonic
    not_tried: list[str] = field(default_factory=list)
    _begun: float = field(init=False)
    _look: float = field(default=0.0, init=False)
    _looks: float = field(default=LOOKS_LEFT, init=False)
    _waiting: set[str] = field(default_factory=set, init=False)

    def __post_init__(self) -> None:
        """Begin."""
        self._begun = self.clock()

    @property
    def spent(self) -> bool:
        """Whether the time for the search is over."""
        kept = min(self._looks * self._look, MOST_KEPT * 60 * self.minutes)
        return self._is_over(SEARCH_SHARE) or self.clock() - self._begun + kept > 60 * self.minutes

    def _is_over(self, share: float) -> bool:
        return self.clock() - self._begun > 60 * share * self.minutes

    @property
    def all_spent(self) -> bool:
        """Whether that which is kept for what comes last is over too."""
        return self._is_over(LAST_SHARE)

    def refuses_score(self, name: str) -> bool:
        """Whether there is no time to score an effect beside the present model, which is then noted."""
        return self._noted(name, self._is_over(SCORED_SHARE))

    @contextmanager
    def looking(self) -> Iterator[None]:
        """Around a look at what is left, of which the longest says how much time is kept for the last ones."""
        begun = self.clock()
        yield
        self._look = max(self._look, self.clock() - begun)

    @contextmanager
    def trying(self, is_first: bool, is_any: bool = True) -> Iterator[None]:
        """Around the trial of a cause: the first has the kept time too, as without it there is nothing to test.

        Args:
            is_first: Whether none was tried before.
            is_any: Whether one is found: until then time is kept for no more than a look at what the next one leaves.
        """
        self._looks = 0.0 if is_first else LOOKS_LEFT if is_any else FIRST_LOOK
        try:
            yield
        finally:
            self._looks = LOOKS_LEFT

    @property
    def sentence(self) -> str:
        """What there was no time for; empty where there was for everything."""
        missing = ", ".join(self.not_tried)
        said = (
            f"Of the {self.minutes:g} minutes of the search a part is kept to test what it finds, and there was no "
            f"time for these: {missing}. "
            f"explain.minutes={MORE * self.minutes:g} gives it more."
        )
        return said if missing else ""

    def refuses(self, what: str, is_last: bool = False) -> bool:
        """Whether there is no time for it, which is then noted; for what comes last there is more."""
        refused = self._noted(what, self.all_spent if is_last else self.spent)
        self._waiting -= {what} if refused else set()
        return refused

    def postpones(self, what: str, at_once: bool = False) -> bool:
        """Whether it is late, so that what promises little waits; it is noted until it is asked for again.

        Args:
            what: An effect.
            at_once: Whether it waits however late it is.
        """
        waits = at_once or self._is_over(LATE)
        if waits and what not in self.not_tried:
            self._waiting.add(what)
        return self._noted(what, waits)

    def asks_again(self, names: Iterable[str]) -> None:
        """What had waited has a new score; what there was no time for at all stays noted."""
        again = self._waiting.intersection(names)
        self._waiting -= again
        self.not_tried[:] = [what for what in self.not_tried if what not in again]

    def _noted(self, what: str, refused: bool) -> bool:
        if refused and what not in self.not_tried:
            self.not_tried.append(what)
        return refused
