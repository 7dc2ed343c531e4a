"""Step 6b: causes that held-out power is too blunt for, but the score of the residuals shows.

Held-out residuals are compared by the whole of their power; what an effect would add to a prediction is compared with
the residual itself here (Clark & West 2007), which needs a tenth of that power.
"""

from collections.abc import Sequence

import torch
from torch import Tensor

from gear_damping.explanation.hypothesis import Outcome
from gear_damping.explanation.ranking import Score
from gear_damping.explanation.refit import FULL_FITS, Refit, block_samples
from gear_damping.explanation.trying import TWO, Bench, Search
from gear_damping.explanation.visible import Assessment

CONFIRMED_AT = 2.0  # t of what an effect adds to held-out predictions, one-sided
LEAST_SHARE = 0.25  # of what is left and not random that a cause must take, so that none is named before a larger rest


def faint_cause(
    found: Search, ranked: Sequence[Score], seen: Assessment, bench: Bench
) -> tuple[Refit | None, tuple[str, ...]]:
    """The next cause with its rivals, of those that are visible; None where none is confirmed."""
    best: dict[str, Score] = {}
    for score in ranked:
        best.setdefault(score.candidate.name, score)
    names = sorted((n for n in best if seen.visible.shows(n)), key=lambda n: -seen.visible.by_name[n])[:FULL_FITS]
    names = [name for name in names if best[name].gain > 0 and not bench.budget.refuses(name)]
    fits = [bench.full_fit(best[name], found.outcome) for name in names]
    worth = [fit for fit in fits if fit is not None and _is_worth(fit, found.outcome, seen, bench)]
    found.rejected = [fit for fit in fits if fit is not None]
    if not found.first_fits:
        found.first_fits = found.rejected
    if len(found.accepted) >= TWO:
        worth = [fit for fit in worth if bench.is_determined(fit)]
    if not worth:
        return None, ()
    first = max(worth, key=lambda fit: fit.fit_gain)
    rivals = [fit for fit in worth if fit is not first and not _encompasses(first, fit, bench)]
    simpler = [fit for fit in rivals if fit.name == _simpler(first, bench)]
    if simpler:
        rivals = [fit for fit in (first, *rivals) if fit is not simpler[0]]
        first = simpler[0]
    return first, tuple(fit.name for fit in rivals)


def confirmation(before: Outcome, after: Outcome, bench: Bench) -> float:
    """The t statistic of what a cause adds to the prediction of held-out records, on what they leave without it."""
    sums: list[Tensor] = []
    for old, new, block in zip(before.holdout, after.holdout, block_samples(before, bench.evidence), strict=True):
        products = (old - new) * old
        count = max(1, len(products) // block)
        sums += [part.sum() for part in products[: count * block].chunk(count)]
    total = torch.stack(sums)
    return float(total.sum() / total.square().sum().sqrt().clamp(min=1e-300))


def _is_worth(fit: Refit, before: Outcome, seen: Assessment, bench: Bench) -> bool:
    """Whether held-out records confirm a cause that takes its part of what is not random, and lose nothing by it."""
    if fit.gain <= 0:
        return False
    taken = 1 - fit.outcome.fitted.cost / max(before.fitted.cost, 1e-300)
    return taken >= LEAST_SHARE * seen.taken and confirmation(before, fit.outcome, bench) >= CONFIRMED_AT


def _encompasses(first: Refit, other: Refit, bench: Bench) -> bool:
    """Whether one is still visible beside the other: what the other says is then not enough."""
    scores = bench.ranked(other.outcome, {first.name})
    seen = bench.assessed(other.outcome, scores, families=False) if scores else None
    return seen is not None and seen.visible.shows(first.name)


def _simpler(fit: Refit, bench: Bench) -> str | None:
    """The effect that this one contains as a special case."""
    return bench.evidence.library[fit.name].cause.simpler
