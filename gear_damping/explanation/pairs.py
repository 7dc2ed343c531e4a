"""Step 7b: two effects at once, where no single one is accepted or one that was accepted leaves a rest."""

from collections.abc import Sequence
from dataclasses import dataclass

from gear_damping.explanation.ranking import Score
from gear_damping.explanation.refit import Refit
from gear_damping.explanation.significance import Excess
from gear_damping.explanation.trying import ACCEPTED_AT, Bench, Search

PAIRS = "pairs of effects"
BASES = 3  # effects from which a second one is sought
SECONDS = 4  # that are fitted in full beside each
HALF = 0.5  # of what the first cause took by itself, for a rival to be a base
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
    if bench.budget.refuses(PAIRS):
        return None
    beside = _bases([fit for fit in found.rejected if fit.is_seen_in_fit], found)
    pairs = [Pair(fit, second, False) for fit in beside for second in _seconds(fit, found, bench)]
    pairs += _instead(found, bench) if len(found.accepted) == 1 else []
    return _accepted(pairs, current, bench)


def pair_instead(found: Search, bench: Bench) -> Pair | None:
    """The pair that held-out records like better than the two causes that were accepted; None without one.

    A first cause that only resembles what is there leads the second astray, and both stand in for two others.
    """
    if bench.budget.refuses(PAIRS):
        return None
    return _accepted(_instead(found, bench), bench.excess(found.outcome), bench)


def _instead(found: Search, bench: Bench) -> list[Pair]:
    """Pairs whose first effect took at least half of what the first cause did when both were tried by themselves."""
    shares = {fit.name: _taken(fit, found) for fit in found.first_fits if fit.is_seen_in_fit}
    least = HALF * shares.get(found.accepted[0].name, 1.0)
    rivals = [fit for fit in found.first_fits if fit.is_seen_in_fit and shares[fit.name] >= least]
    return [Pair(fit, second, True) for fit in _bases(rivals, found) for second in _seconds(fit, found, bench)]


def _taken(fit: Refit, found: Search) -> float:
    return 1 - fit.outcome.holdout_cost / max(found.nominal.holdout_cost, 1e-300)


def _accepted(pairs: Sequence[Pair], current: Excess, bench: Bench) -> Pair | None:
    """The best pair that held-out records accept, or of those that do as well the smallest; None without one."""

    def takes(pair: Pair) -> float:
        return (current.percent - bench.excess(pair.second.outcome).percent) / current.percent

    worth = [pair for pair in pairs if pair.second.t > ACCEPTED_AT and takes(pair) >= LEAST_SHARE]
    best = min(worth, key=lambda pair: pair.second.outcome.holdout_cost, default=None)
    if best is None:
        return None
    alike = [pair for pair in worth if bench.is_as_good(pair.second.outcome, best.second.outcome)]
    return min([best, *alike], key=lambda pair: len(pair.second.outcome.hypothesis.free))


def _bases(fits: Sequence[Refit], found: Search) -> list[Refit]:
    """The fits that take most of the fitted records, one an effect."""
    best: dict[str, Refit] = {}
    names = {cause.name for cause in found.accepted}
    for fit in sorted(fits, key=lambda fit: -fit.fit_gain):
        if fit.name not in names:
            best.setdefault(fit.name, fit)
    return list(best.values())[:BASES]


def _seconds(base: Refit, found: Search, bench: Bench) -> list[Refit]:
    """Full fits of the most promising effects beside a base, held against what was accepted so far."""
    best: dict[str, Score] = {}
    for score in bench.ranked(base.outcome):
        if score.gain > 0:
            best.setdefault(score.candidate.name, score)
    names = list(best)[:SECONDS]
    simpler = (bench.evidence.library[name].cause.simpler for name in names)
    names += [name for name in simpler if name in best and name not in names]
    names = [name for name in names if not bench.budget.refuses(f"{base.name} with {name}")]
    fits = (bench.full_fit(best[name], base.outcome, found.outcome) for name in names)
    kept = [fit for fit in fits if fit is not None and fit.outcome.fitted.cost < base.outcome.fitted.cost]
    return [bench.converged(fit, found.outcome) for fit in kept]
