"""Step 7: add what the held-out records bear out, one cause after another, then drop what is not needed."""

from collections.abc import Sequence
from dataclasses import dataclass

from gear_damping.explanation.budget import Budget
from gear_damping.explanation.calibrate import restarted
from gear_damping.explanation.evidence import Evidence
from gear_damping.explanation.faint import faint_cause
from gear_damping.explanation.hypothesis import MOST_GROWTH, Outcome
from gear_damping.explanation.noise import NoiseLevel
from gear_damping.explanation.pairs import Pair, best_pair, pair_instead
from gear_damping.explanation.ranking import Score
from gear_damping.explanation.refit import Refit, again
from gear_damping.explanation.revise import beside_the_others, exchanged, pruned, simplified, told
from gear_damping.explanation.significance import Excess, is_settled
from gear_damping.explanation.trying import ACCEPTED_AT, SMALL_REST, TWO, Accepted, Bench, Say, Search
from gear_damping.explanation.visible import Assessment
from gear_damping.simulation.solver_settings import Solver

LEAST_SHARE = 0.25  # of the remaining excess that a cause must take
MOST_CAUSES = 4
MOST_ANEW = 3  # times that a search begins anew from a better calibration
BENT = 4.0  # noise variances left by a nominal model whose free shape is no good place to begin


def search(
    nominal: Outcome,
    evidence: Evidence,
    noise: NoiseLevel,
    say: Say,
    solver: Solver | None = None,
    begun: Sequence[Refit] = (),
    budget: Budget | None = None,
) -> Search:
    """Extend the nominal model until nothing significant is missing or nothing more is borne out.

    Args:
        nominal: The calibrated model.
        evidence: The records.
        noise: Their noise.
        say: Told what is found on the way.
        solver: Settings of the solver.
        begun: Full fits to other evidence that are carried on.
        budget: The time that it may take.
    """
    bench = Bench(evidence, noise, say, solver, noise, budget=budget or Budget())
    found = Search(nominal, nominal, first_scores=bench.ranked(nominal), failed=bench.failed)
    state = _State(bench, found.first_scores, bench.excess(nominal))
    found.seen = _look(found, state)
    while len(found.accepted) < MOST_CAUSES and _goes_on(found, state, begun):
        _look_again(found, state)
    bench = state.bench
    found.accepted = [simplified(cause, found, bench) for cause in found.accepted]
    told(found, bench)
    if len(found.accepted) > 1:
        pruned(found, state.first, bench)
        found.accepted = [beside_the_others(cause, found, bench) for cause in found.accepted]
    found.noise = bench.noise
    return found


@dataclass
class _State:
    """Where a search stands: its bench, scores beside the present model, what the nominal one left, fresh starts."""

    bench: Bench
    ranked: Sequence[Score]
    first: Excess
    anew: int = 0


def _goes_on(found: Search, state: _State, begun: Sequence[Refit]) -> bool:
    """One round: a further cause or two of them, or a better calibration; whether there was any."""
    bench, current = state.bench, state.bench.excess(found.outcome)
    if found.accepted and bench.budget.refuses("further causes"):
        return False
    if found.left is not None and not found.left.visible and current.misfit <= SMALL_REST:
        return False
    if is_settled(current, state.first):
        return found.left is not None and _add_faint(found, found.left, current, state)
    best, rivals = _next(found, state.ranked, current, bench, begun)
    if best is None:
        return _add_pair(found, current, state)
    if _calibrate_anew(found, best, state):
        return True
    _accept(found, best, rivals, current, state.first, bench)
    exchanged(found, state.first, bench)
    pair = pair_instead(found, bench) if len(found.accepted) == TWO else None
    if pair is not None:
        _accept_pair(found, pair, state.first, state.first, bench)
    return True


def _add_faint(found: Search, seen: Assessment, current: Excess, state: _State) -> bool:
    """A cause that only the score shows."""
    best, rivals = faint_cause(found, state.ranked, seen, state.bench)
    if best is not None:
        _accept(found, best, rivals, current, state.first, state.bench)
    return best is not None


def _add_pair(found: Search, current: Excess, state: _State) -> bool:
    """Two causes at once, where no single one is borne out."""
    pair = None if _is_unpredictable(found, state.bench) else best_pair(found, current, state.bench)
    if pair is None or len(found.accepted) + 2 - pair.replaces > MOST_CAUSES:
        return False
    _accept_pair(found, pair, current, state.first, state.bench)
    return True


def _calibrate_anew(found: Search, best: Refit, state: _State) -> bool:
    """Whether what an effect seemed to take is taken without it: it only led the fit out of a local minimum."""
    if state.anew >= MOST_ANEW:
        return False
    settled = state.bench.without(best.outcome, best.name)
    if not state.bench.is_as_good(settled, best.outcome):
        return False
    state.bench.say(f"what {best.name} seemed to take is taken without it: the fit had not come to rest")
    found.outcome, state.anew = settled, state.anew + 1
    if not found.accepted:
        found.nominal = settled
    return True


def _look_again(found: Search, state: _State) -> None:
    """Scores beside the present model, and what they say."""
    state.ranked = state.bench.ranked(found.outcome)
    seen = _look(found, state)
    if found.outcome is found.nominal:  # calibrated anew
        found.first_scores, found.seen = list(state.ranked), seen


def _look(found: Search, state: _State) -> Assessment | None:
    """What is random beside the present model and what is not; the noise follows."""
    found.left = state.bench.assessed(found.outcome, state.ranked)
    state.bench = state.bench.knowing(found.left)
    state.first = state.bench.excess(found.nominal)
    return found.left


def _next(
    found: Search, ranked: Sequence, current: Excess, bench: Bench, begun: Sequence[Refit]
) -> tuple[Refit | None, tuple[str, ...]]:
    """The next cause with its rivals; None where nothing more is borne out."""
    if found.accepted:
        fits = bench.full_fits(ranked, found.outcome, found.outcome)
    else:
        fits = found.first_fits = _first_fits(found, current, bench, begun)
    found.rejected = fits
    if _is_unpredictable(found, bench):
        return None, ()
    fits = found.rejected = _rivals_at_rest(fits, found, current, bench)
    best = _best(fits, current, bench)
    if best is None or (len(found.accepted) >= TWO and not bench.is_determined(best)):
        return None, ()
    return bench.simplest(best, fits)


def _rivals_at_rest(fits: Sequence[Refit], found: Search, current: Excess, bench: Bench) -> list[Refit]:
    """The fits, the best ones carried to their ends: what has not converged is no rival yet, and no winner."""
    best = _best(fits, current, bench)
    if best is None:
        return list(fits)
    against = found.outcome if found.accepted else found.nominal
    alike = [fit for fit in fits if fit is best or bench.is_as_good(fit.outcome, best.outcome)]
    ends = [bench.converged(fit, against) if any(fit is one for one in alike) else fit for fit in fits]
    return sorted(ends, key=lambda fit: fit.outcome.holdout_cost)


def _is_unpredictable(found: Search, bench: Bench) -> bool:
    """Whether records were predicted over more than they can be: nothing of that counts."""
    return found.growth > MOST_GROWTH and not bench.evidence.segments


def _accept(found: Search, best: Refit, rivals: tuple[str, ...], current: Excess, first: Excess, bench: Bench) -> None:
    found.outcome = bench.at_rest(best.outcome)
    share = min((current.percent - bench.excess(found.outcome).percent) / max(first.percent, 1e-300), 1.0)
    found.accepted.append(Accepted(best.name, best, share, rivals))
    bench.say(f"{best.name} takes {100 * share:.1f} % of the excess on held-out records")


def _accept_pair(found: Search, pair: Pair, current: Excess, first: Excess, bench: Bench) -> None:
    """Two causes that only together are accepted; each has half of what they take, until one is taken out."""
    if pair.replaces:
        former = " and ".join(cause.name for cause in found.accepted)
        bench.say(f"{pair.first.name} and {pair.second.name} take the place of {former}")
        found.accepted, current = [], first
    found.outcome = bench.at_rest(pair.second.outcome)
    share = (current.percent - bench.excess(found.outcome).percent) / max(first.percent, 1e-300) / 2
    found.accepted += [Accepted(fit.name, pair.second, share, ()) for fit in (pair.first, pair.second)]
    bench.say(f"{pair.first.name} and {pair.second.name} take {200 * share:.1f} % of the excess on held-out records")


def _first_fits(found: Search, current: Excess, bench: Bench, begun: Sequence[Refit]) -> list[Refit]:
    """Full fits of the first round: from the nominal model, and from before its free shape was fitted.

    Where much is missing that shape has bent to what it is not made for, so the other place comes first;
    the second one is tried only where nothing is borne out from the first.
    """
    fits = [again(refit, found.nominal, bench.evidence, bench.solver) for refit in begun]
    for place in ("shaped", "unshaped") if current.misfit < BENT else ("unshaped", "shaped"):
        begin, ranked = found.nominal, found.first_scores
        if place == "unshaped" and bench.budget.refuses("effects from before the shape of the stiffness was fitted"):
            continue
        if place == "unshaped":
            begin = restarted(bench.evidence, bench.solver)
            if begin is None:
                continue
            ranked = bench.ranked(begin)
        fits += bench.full_fits(ranked, begin, found.nominal)
        fits.sort(key=lambda fit: fit.outcome.holdout_cost)
        if _best(fits, current, bench):
            break
    return fits


def _best(fits: Sequence[Refit], current: Excess, bench: Bench) -> Refit | None:
    """The best full fit, where held-out records bear it out."""
    best = next((fit for fit in fits if fit.is_seen_in_fit), None)
    if best is None:
        return None
    takes = (current.percent - bench.excess(best.outcome).percent) / current.percent
    return best if best.t > ACCEPTED_AT and takes >= LEAST_SHARE else None
