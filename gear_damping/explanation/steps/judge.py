"""Step 10: one word for what was found, and a sentence that says it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from gear_damping.explanation.evidence.excess import Excess, is_all
from gear_damping.explanation.state import Accepted, State
from gear_damping.explanation.trials.assess import Assessment
from gear_damping.physics.catalogue import builtin_effects

CONSISTENT, EXPLAINED, AMBIGUOUS = "consistent", "explained", "ambiguous"
PARTLY, UNEXPLAINED, DATA_PROBLEM = "partly_explained", "unexplained", "data_problem"
VERDICTS = (CONSISTENT, EXPLAINED, AMBIGUOUS, PARTLY, UNEXPLAINED, DATA_PROBLEM)
LARGEST_SET = 4  # names in a set


@dataclass(frozen=True)
class Verdict:
    """The word and its sentences.

    Args:
        word: One of `VERDICTS`.
        sentences: For the reader, the most important first.
    """

    word: str
    sentences: tuple[str, ...]

    def saying(self, *more: str) -> "Verdict":
        """The same with further sentences; empty ones are none."""
        return replace(self, sentences=(*self.sentences, *filter(None, more)))


@dataclass(frozen=True)
class Judged:
    """A search with what it leaves, what it is called, and what there was no time for."""

    found: State
    before: Excess
    after: Excess
    verdict: Verdict
    not_tried: tuple[str, ...] = ()


def verdict(
    found: State,
    before: Excess,
    after: Excess,
    converged: bool = True,
    is_one: bool | None = None,
    whole: float = 1.0,
    fitted: float = 0.0,
) -> Verdict:
    """What the search amounts to.

    Args:
        found: The search.
        before: Excess of the calibrated nominal model.
        after: Excess of the extended one.
        converged: Whether the calibration converged.
        is_one: Whether every cause has one size over all records; None where too few records tell of one.
        whole: Share that causes take of everything beyond the sensor's noise, what looks random included.
        fitted: What the nominal model leaves of the fitted records beyond the noise, in % of their variance.
    """
    settings = found.bench.settings
    shown = before.significant and (is_visible(found.seen) or before.misfit > settings.small_misfit)
    unfitted = is_visible(found.seen) and fitted > settings.gross_percent and before.misfit > settings.small_misfit
    if not found.accepted and not shown and not unfitted:
        text = f"No evidence of an effect that takes more than {before.threshold:.2g} % of the signal's variance."
        return Verdict(CONSISTENT, (text,))
    taken = _taken(found, before, after)
    rest = is_all(after, before, settings) or (not is_visible(found.left) and after.misfit <= settings.small_misfit)
    missing = f"The simulation misses {before.percent:.3g} % of the signal's variance"
    if before.percent <= 0:  # what is missing shows in its form, not in its power
        missing = f"The simulation misses something, though less than {before.threshold:.2g} % of the signal's variance"
    unsettled = () if converged else ("The calibration did not converge: take the figures with care.",)
    if not found.accepted:
        text = f"{missing}, and no effect of the catalogue is borne out by held-out records."
        return Verdict(UNEXPLAINED, (text, *unsettled))
    confused = [cause for cause in found.accepted if cause.confusable]
    said = _named(found.accepted)
    classes = [cause for cause in found.accepted if cause.effect.cause.one_class]
    looks_random = whole < settings.taken_by_one or before.misfit < settings.random_misfit
    if rest and looks_random:  # most of the gap is still there
        text = f"{missing}. Part of it has a name: {said}. What is left looks random, and is more than that."
        return Verdict(PARTLY, (text, _left(taken), *_not_told_apart(confused), *unsettled))
    if rest and classes:
        return Verdict(AMBIGUOUS, (f"{missing}.", *_one_class(classes), *_not_told_apart(confused), _left(taken)))
    if rest and not confused:
        return Verdict(EXPLAINED, (f"{missing}: {said}.", _left(taken), *_same_record(found.accepted), *unsettled))
    if rest:
        return Verdict(AMBIGUOUS, (f"{missing}.", *_not_told_apart(confused), _left(taken), *unsettled))
    is_alone = len(found.accepted) == 1 and (after.misfit <= settings.small_misfit or bool(is_one))
    one_takes_half = is_alone and taken >= settings.taken_by_one
    if taken >= settings.taken_by_all or one_takes_half:
        text = f"{missing}. Part of it has a name: {said}. A rest of {after.percent:.3g} % has none."
        return Verdict(PARTLY, (text, _left(taken), *_not_told_apart(confused), *unsettled))
    text = f"{missing}. {said[0].upper()}{said[1:]} would take part of it, but too much is left to name a cause."
    return Verdict(UNEXPLAINED, (text, *unsettled))


def is_visible(seen: Assessment | None) -> bool:
    """Whether residuals hold something that is not random; where nobody looked, they may."""
    return seen is None or bool(seen.visible)


def _taken(found: State, before: Excess, after: Excess) -> float:
    """Share of what was missing that causes take: of held-out power, or of what is not random where that is small."""
    if before.significant or found.seen is None or found.left is None or not found.seen.taken:
        return min((before.percent - after.percent) / before.percent, 1.0)  # what is left may by chance be below noise
    return 1 - min(found.left.taken / found.seen.taken, 1.0)


def statuses(word: str) -> str:
    """Whether the causes of a verdict are established or merely suggested."""
    return "established" if word in (EXPLAINED, AMBIGUOUS, PARTLY) else "suggested"


def _named(accepted: Sequence[Accepted]) -> str:
    return " and ".join(f"{cause.effect.cause.sentence} (`{cause.name}`)" for cause in accepted)


def _not_told_apart(confused: Sequence[Accepted]) -> tuple[str, ...]:
    sets = (" or ".join(f"`{name}`" for name in (c.name, *c.confusable[: LARGEST_SET - 1])) for c in confused)
    return (f"These data do not tell apart: {'; '.join(sets)}.",) if confused else ()


def _one_class(causes: Sequence[Accepted]) -> tuple[str, ...]:
    """Names that are one answer in this channel."""
    return tuple(
        f"{cause.effect.cause.sentence[0].upper()}{cause.effect.cause.sentence[1:]} (`{cause.name}`), "
        f"{', '.join(cause.effect.cause.one_class[:-1])} and {cause.effect.cause.one_class[-1]} look the same in this "
        "channel: a calibrated torque and a calibrated sensor would tell which it is."
        for cause in causes
    )


def _same_record(accepted: Sequence[Accepted]) -> tuple[str, ...]:
    return tuple(
        f"In this channel {builtin_effects()[other].cause.sentence} (`{other}`) would look the same as `{cause.name}`."
        for cause in accepted
        for other in cause.effect.cause.looks_like
    )


def _left(taken: float) -> str:
    return f"With it the held-out excess falls by {100 * taken:.1f} %."
