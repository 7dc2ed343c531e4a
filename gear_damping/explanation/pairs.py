"""Step 7b: two effects at once, where no single one is accepted or one that was accepted leaves a rest."""

from collections.abc import Sequence
from dataclasses import dataclass

from gear_damping.explanation.refit import Refit
from gear_damping.explanation.significance import Excess
from gear_damping.explanation.trying import ACCEPTED_AT, Bench, Search

BASES = 3  # effects from which a second one is sought
SECONDS = 2  # that are fitted in full beside each
LEAST_SHARE = 0.25  # of the remaining excess that a pair must take


@dataclass(frozen=True)
class Pair:
    """Two effects that held-out records accept together.

    Args:
        first: The full fit with the first of them.
        second: The full fit with both.
        replaces: Whether they take the place of what was accepted so far.
    """

    first: Refit
    second: Refit
    replaces: bool


def best_pair(found: Search, current: Excess, bench: Bench) -> Pair | None:
    """The pair that held-out records like best beside what was accepted, or in its place; None without one."""
    beside = [fit for fit in found.rejected if fit.is_seen_in_fit]
    instead = [fit for fit in found.first_fits if fit.is_seen_in_fit] if len(found.accepted) == 1 else []
    names = {cause.name for cause in found.accepted}
    pairs = [Pair(fit, second, False) for fit in _bases(beside, names) for second in _seconds(fit, found, bench)]
    pairs += [Pair(fit, second, True) for fit in _bases(instead, names) for second in _seconds(fit, found, bench)]
    best = min(pairs, key=lambda pair: pair.second.outcome.holdout_cost, default=None)
    if best is None:
        return None
    alike = [pair for pair in pairs if bench.is_as_good(pair.second.outcome, best.second.outcome)]
    best = min([best, *alike], key=lambda pair: len(pair.second.outcome.hypothesis.free))
    takes = (current.percent - bench.excess(best.second.outcome).percent) / current.percent
    return best if best.second.t > ACCEPTED_AT and takes >= LEAST_SHARE else None


def _bases(fits: Sequence[Refit], names: set[str]) -> list[Refit]:
    """The fits that take most of the fitted records, one an effect."""
    best: dict[str, Refit] = {}
    for fit in sorted(fits, key=lambda fit: -fit.fit_gain):
        if fit.name not in names:
            best.setdefault(fit.name, fit)
    return list(best.values())[:BASES]


def _seconds(base: Refit, found: Search, bench: Bench) -> list[Refit]:
    """Full fits of the most promising effects beside a base, held against what was accepted so far."""
    names: list[str] = []
    fits = []
    for score in bench.ranked(base.outcome):
        name = score.candidate.name
        if name in names or score.gain <= 0:
            continue
        names.append(name)
        fit = bench.full_fit(score, base.outcome, found.outcome)
        fits += [fit] if fit is not None and fit.fit_gain > base.fit_gain else []
        if len(names) == SECONDS:
            break
    return fits
