"""Longer segments, or whole records, once what was found in short ones follows them."""

from collections.abc import Callable
from math import ceil

from gear_damping.explanation.evidence.excess import is_mostly_left
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.search import search
from gear_damping.explanation.state import State
from gear_damping.explanation.trials.bench import Bench
from gear_damping.explanation.trials.refit import again
from gear_damping.identification.output_error.segments import WHOLE, Segments
from gear_damping.physics.systems.traits import Trait

Begun = Callable[[Segments], tuple[Bench, Outcome]]

LONGER = 2.0  # times the segments of before, for another search: with less than twice as much time little more shows


def over_longer(cut: State, begun: Begun) -> State:
    """The search in segments, or that over as long ones as its first cause can be predicted over.

    A segment of a few swings hardly shows that the frequency depends on the amplitude, for which the nominal model may
    have lost a record. What is found there may follow all of it. Shafts keep a motion in step.

    Args:
        cut: Where the search in short segments ended.
        begun: The bench and the nominal model with records cut otherwise.
    """
    bench = cut.bench
    if not cut.accepted or bench.evidence.has(Trait.SHAFTS) or bench.evidence.stated_segments:
        return cut
    if bench.budget.refuses("longer segments"):
        return cut
    first = cut.accepted[0].refit
    longer, nominal = begun(WHOLE)
    followed = again(first, nominal, longer.evidence, bench.solver).outcome
    growth = followed.error_amplification / bench.settings.most_growth
    if growth > 1:  # in proportion to the time, where a frequency goes with the amplitude
        seconds = max(record.duration for record in longer.evidence.fit) / ceil(growth)
        if seconds < LONGER * bench.evidence.segments.seconds:
            return cut
        longer, nominal = begun(Segments(seconds))
        followed = again(first, nominal, longer.evidence, bench.solver).outcome
    if _loses_any(followed, longer):
        return cut
    bench.log(f"{first.name} follows records over longer segments, which are searched")
    found = search(nominal, longer, [first])
    return found if _taken(found) > _taken(cut) else cut


def _taken(state: State) -> float:
    """Share of what the nominal model misses that the causes take."""
    return sum(cause.share for cause in state.accepted)


def _loses_any(followed: Outcome, bench: Bench) -> bool:
    """Whether a model leaves more than half of a record: one that follows all has found where small errors lead."""
    share, noise = bench.settings.lost_share, bench.evidence.noise
    pairs = zip(followed.fit_residuals, bench.evidence.fitted, strict=True)
    return any(is_mostly_left(residual, record, noise, share) for residual, record in pairs)
