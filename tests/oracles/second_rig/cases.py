"""The two sets of made-up measurements, by the names of their cases."""

from __future__ import annotations

from .case import Case
from .first_set import FIRST
from .second_set import SECOND


def _named(makers) -> dict[str, Case]:
    return {make.__name__.removeprefix("_"): make() for make in makers}


SETS = {"first": _named(FIRST), "second": _named(SECOND)}
CASES = SETS["first"] | SETS["second"]
