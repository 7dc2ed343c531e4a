"""Two effects at once, where no single one is accepted or one that was accepted leaves a residual."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf

from gear_damping.explanation.evidence.excess import Excess, is_settled
from gear_damping.explanation.model.candidates import Candidate
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.state import Accepted, State
from gear_damping.explanation.trials.refit import Refit
from gear_damping.explanation.trials.score import best_by_effect
from gear_damping.explanation.trials.told_size import is_told

PAIRS, PAIR = "pairs of effects", 2  # what a budget refuses; effects in a pair


@dataclass(frozen=True)
class Pair:
    """Two effects that are accepted together.

    Args:
        first: The full fit with the first of them.
        second: The full fit with both.
        replaces: Whether they take the place of what was accepted so far.
    """

    first: Refit
    second: Refit
    replaces: bool

    @property
    def is_inside(self) -> bool:
        """Whether no parameter of the two effects is at a bound, none of a part included, but where it may rest."""
        outcome, own = self.second.outcome, (f"{self.first.name}.", f"{self.second.name}.")
        ends = outcome.problem.unknowns.at_bound(outcome.fitted.shared)
        resting = {end for fit in (self.first, self.second) for end in fit.score.candidate.resting}
        named = zip((parameter.name for parameter in outcome.problem.free), ends.tolist(), strict=False)
        return not any(end and name.startswith(own) and (name, end) not in resting for name, end in named)


def with_pair(state: State) -> State | None:
    """The state with the pair that leaves least beside what was accepted, or in its place, if any."""
    bench = state.bench
    if state.is_unpredictable or bench.budget.refuses(PAIRS):
        return None
    bases = _bases([fit for fit in state.rejected if fit.is_seen_in_fit], state)
    pairs = [pair for fit in bases for pair in _pairs(fit, False, state)]
    pairs += _instead(state) if len(state.accepted) == 1 else []
    pair = _accepted(pairs, state.current, state)
    if pair is None:
        return None
    count = PAIR if pair.replaces else len(state.accepted) + PAIR
    return None if count > bench.settings.most_causes else _with(pair, state)


def with_pair_of_a_nearer(state: State) -> State | None:
    """The state with a pair in the place of the one cause, whose first effect fits the fitted records better; if any.

    While something large is missing, what predicts left-out records best need not be there. A ripple of the torque did
    where a stiffness that turns with the pinion left a third less of the fitted records and a contact stiffness was
    missing too, and was followed by two more that were not. Beside the nearer one the next effect must promise to leave
    less than any beside the cause that was accepted.
    """
    if len(state.accepted) != 1 or not state.ranked:
        return None
    bench, most = state.bench, len(state.outcome.hypothesis.free)
    fits = [fit for fit in _first_fits(state) if len(fit.outcome.hypothesis.free) <= most]
    nearer = [fit for fit in _bases(fits, state) if fit.outcome.fitted.cost < state.outcome.fitted.cost]
    if not nearer or bench.budget.refuses(PAIRS):
        return None
    promised = (1 - state.ranked[0].gain) * state.outcome.fitted.cost
    pairs = [Pair(nearer[0], second, True) for second in _seconds(nearer[0], state, promised)]
    pair = _accepted(pairs, state.current, state)
    return None if pair is None else _with(pair, state)


def with_pair_instead(state: State) -> State:
    """The state with the pair that leaves less than the two causes that were accepted, if any.

    A first cause that only resembles what is there leads the second astray, and both stand in for two others.
    """
    is_all = is_settled(state.current, state.first, state.bench.settings)
    if len(state.accepted) != PAIR or is_all or state.bench.budget.refuses(PAIRS):
        return state
    pair = _accepted(_instead(state), state.current, state)
    return state if pair is None else _with(pair, state)


def with_pair_of_as_many(state: State) -> State | None:
    """The state with a pair in the place of one law of as many parameters, where that leaves more than noise; if any.

    A law with a shape of its own (a hysteresis) bends to what two plain ones do together.
    """
    bench, own = state.bench, len(state.outcome.hypothesis.free) - len(state.nominal.hypothesis.free)
    leaves_more = state.left is not None and state.left.visible and state.current.misfit > bench.settings.small_misfit
    if len(state.accepted) != 1 or own < PAIR or not leaves_more or bench.budget.refuses(PAIRS):
        return None
    most = len(state.outcome.hypothesis.free)
    pairs = [pair for pair in _instead(state) if len(pair.second.outcome.hypothesis.free) <= most]
    pair = _accepted(pairs, state.current, state)
    return None if pair is None else _with(pair, state)


def _with(pair: Pair, state: State) -> State:
    """Two causes that only together are accepted; each has half of what they take, until one is taken out."""
    bench = state.bench
    if pair.replaces:
        former = " and ".join(cause.name for cause in state.accepted)
        bench.log(f"{pair.first.name} and {pair.second.name} take the place of {former}")
        state = replace(state, accepted=(), outcome=state.nominal)
    outcome = bench.until_converged(pair.second.outcome)
    share = state.share_taken(outcome)
    causes = [Accepted(fit.name, pair.second, share / PAIR, (), fit.score) for fit in (pair.first, pair.second)]
    bench.log(f"{pair.first.name} and {pair.second.name} take {100 * share:.1f} % of the excess on left-out records")
    return replace(state, outcome=outcome, accepted=(*state.accepted, *causes))


def _instead(state: State) -> list[Pair]:
    """Pairs whose first effect took at least half of what the first cause did when both were tried by themselves."""
    shares = {fit.name: _taken(fit, state) for fit in _first_fits(state)}
    least = state.bench.settings.pair_share * shares.get(state.accepted[0].name, 1.0)
    rivals = [fit for fit in _first_fits(state) if shares[fit.name] >= least]
    return [pair for fit in _bases(rivals, state) for pair in _pairs(fit, True, state)]


def _first_fits(state: State) -> list[Refit]:
    """The fits of the first round that show, of effects that are candidates still: no size of the others was told."""
    known = state.bench.evidence.library
    return [fit for fit in state.first_fits if fit.is_seen_in_fit and fit.name in known]


def _taken(fit: Refit, state: State) -> float:
    return 1 - fit.outcome.left_out_cost / max(state.nominal.left_out_cost, 1e-300)


def _accepted(pairs: Sequence[Pair], current: Excess, state: State) -> Pair | None:
    """The best pair that is validated, or of those that do as well the smallest; None without one.

    A law of which a part has run into a bound bends to what it is not: a pair with such a one is the last choice, and
    takes no other's place. Nor is one the choice of which the records do not tell the size, where others are told: it
    would be dropped, and the other effect of the pair stay alone. A pair in the place of one of no fewer parameters
    need not take a good part of what that leaves, as a further cause must: it has to predict better.
    """
    bench, settings = state.bench, state.bench.settings

    def takes(pair: Pair) -> float:
        return (current.percent - bench.excess(pair.second.outcome).percent) / current.percent

    def is_enough(pair: Pair) -> bool:
        is_exchange = pair.replaces and len(state.accepted) == PAIR and not _is_richer(pair, state)
        return takes(pair) >= (0.0 if is_exchange else settings.least_share)

    worth = [pair for pair in pairs if pair.second.t > settings.accepted_t and is_enough(pair)]
    worth = [pair for pair in worth if pair.is_inside] or [pair for pair in worth if not pair.replaces]
    worth = sorted(worth, key=lambda pair: pair.second.outcome.left_out_cost)
    worth = [pair for pair in worth if _is_told(pair, state)] or worth
    if not worth:
        return None
    best = worth[0]
    alike = [pair for pair in worth if bench.is_as_good(pair.second.outcome, best.second.outcome)]
    return min([best, *alike], key=lambda pair: len(pair.second.outcome.hypothesis.free))


def _is_richer(pair: Pair, state: State) -> bool:
    """Whether a pair has more parameters than the present model."""
    return len(pair.second.outcome.hypothesis.free) > len(state.outcome.hypothesis.free)


def _is_told(pair: Pair, state: State) -> bool:
    """Whether the records tell the sizes of both effects from none."""
    outcome = pair.second.outcome
    return outcome.is_finite and all(is_told(outcome, fit, state.bench.evidence) for fit in (pair.first, pair.second))


def _bases(fits: Sequence[Refit], state: State) -> list[Refit]:
    """The fits that take most of the fitted records, one an effect."""
    best: dict[str, Refit] = {}
    for fit in sorted(fits, key=lambda fit: -fit.fit_gain):
        if fit.name not in state.names and not fit.differs:
            best.setdefault(fit.name, fit)
    return list(best.values())[: state.bench.settings.pair_bases]


def _pairs(base: Refit, replaces: bool, state: State) -> list[Pair]:
    """Pairs of a base, and of the same with what bent it to a bound held until the second effect is there too."""
    pairs = [Pair(base, second, replaces) for second in _seconds(base, state)]
    for held, candidate in _held(base, replaces, state):
        joined = (state.bench.joined(second, candidate, state.outcome) for second in _seconds(held, state))
        pairs += [Pair(base, second, replaces) for second in joined if second.outcome.is_finite]
    return pairs


def _held(base: Refit, replaces: bool, state: State) -> list[tuple[Refit, Candidate]]:
    """Fits of a law without what joins later, where that has run into a bound, and the candidates with it.

    Where two laws act, the power of one of them alone runs away, and from there no second effect leads back.
    """
    tried = base.score.candidate
    if not (base.is_at_bound and tried.is_law and tried.later):
        return []
    beside, scores = (state.nominal, state.first_scores) if replaces else (state.outcome, state.ranked)
    alike = [one for one in scores if (one.candidate.name, one.candidate.form) == (tried.name, tried.form)]
    found = []
    for score in (one for one in alike if one.gain > 0):
        held = state.bench.full_fit(replace(score, candidate=replace(score.candidate, later=())), beside)
        found += [] if held is None else [(held, score.candidate)]
    return found


def _needed(base: Outcome, state: State) -> float:
    """Share of what a base leaves that a second effect must take, over what a further cause must.

    Where nothing is accepted yet, a pair that leaves more than half names nothing.
    """
    bench, settings = state.bench, state.bench.settings
    if state.accepted:
        return 1.0
    left = bench.beyond_noise(base) / max(bench.beyond_noise(state.nominal), 1e-300)
    return max(1 - (1 - settings.taken_by_one) / max(left, 1e-300), 0.0) / settings.least_share


def _seconds(base: Refit, state: State, promised: float = inf) -> list[Refit]:
    """Full fits of the most promising effects beside a base, held against what was accepted so far.

    Args:
        base: The fit with the first effect.
        state: Where the search stands.
        promised: The cost that the most promising ones, and those that promise about as much, must promise to leave.
    """
    bench = state.bench
    if bench.budget.refuses(f"a second effect beside {base.name}"):
        return []
    worth = bench.worth(bench.ranked(base.outcome), base.outcome, _needed(base.outcome, state))
    best = best_by_effect(score for score in worth if score.gain > 0 and not score.candidate.own_levels)
    most = max((score.gain for score in best.values()), default=0.0)
    least = max(1 - promised / base.outcome.fitted.cost, bench.settings.rival_share * most) if promised < inf else 0.0
    names = [name for name in best if best[name].gain >= least][: bench.settings.pair_seconds]
    simpler = (bench.evidence.library[name].cause.simpler for name in names)
    names += [name for name in simpler if name in best and name not in names]
    goal, kept = bench.goal(state.outcome), []
    for name in names:
        if bench.budget.refuses(f"{base.name} with {name}"):
            continue
        fit = bench.full_fit(best[name], base.outcome, state.outcome, goal)
        kept += [fit] if fit is not None and fit.outcome.fitted.cost < base.outcome.fitted.cost else []
    return [bench.converged(fit, state.outcome) for fit in kept]
