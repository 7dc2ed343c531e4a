"""Step 10: one word for what was found, and a sentence that says it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf

from gear_damping.explanation.evidence.excess import WHOLE, Excess, is_all
from gear_damping.explanation.state import Accepted, State
from gear_damping.explanation.trials.assess import Assessment
from gear_damping.physics.catalogue import builtin_effects

CONSISTENT, EXPLAINED, AMBIGUOUS = "consistent", "explained", "ambiguous"
PARTLY, UNEXPLAINED, DATA_PROBLEM = "partly_explained", "unexplained", "data_problem"
LARGEST_SET = 4  # names that a sentence lists of causes that are not told apart
TOO_SHORT = "but the held-out records are too short to judge so small an effect."
TOO_STILL = "but something is left beside it, and the held-out records tell nothing of either."
UNTOLD = "but there was no time to see whether it stands in for something else."
WORSE = "but with it the held-out records are predicted worse than by their means."
NO_BETTER = "but with it the held-out records are predicted worse than without."
BETWEEN_SAMPLES = "but what the load does between its samples, which nobody has seen, may be as much."
NOT_LESS = "but what is visible and not random stays."
WITHIN_NOISE = "What is left is no more than the noise of the held-out records, and is not all random."
AT_BOUND = "but it has run into the end of what it can be, and leaves most: it stands in for something else."
AT_BOUND_ABOVE_NOISE = (
    "but it has run into the end of what it can be, and leaves more than the noise of the sensor: it stands in for "
    "something else."
)
OTHER_FIGURES = (
    "The simulation follows the records, but with figures far from those that are stated: one of these is wrong, or "
    "what measured the records has a wrong gain, which bends them."
)
TOO_MUCH = "but too much is left for it to be the cause."
NO_FIGURE = "but not one figure of `{}` is told by the records: it bends to what they show."
ANY_FIGURES = "but not one figure of `{}` is told by the records, and too much is left for it to be the cause."
OTHER_SIZES = (
    "but with another size in other records: its form is another one, or it stands in for something that has no name."
)


@dataclass(frozen=True)
class Verdict:
    """The word and its sentences.

    Args:
        word: One of `schema.VERDICTS`.
        sentences: For the reader, the most important first.
    """

    word: str
    sentences: tuple[str, ...]

    @property
    def leaves_unnamed(self) -> bool:
        """Whether something is missing that has no name."""
        return self.word in (PARTLY, UNEXPLAINED)

    def saying(self, *more: str) -> "Verdict":
        """The same with further sentences; empty ones are none."""
        return replace(self, sentences=(*self.sentences, *filter(None, more)))


@dataclass(frozen=True)
class Judged:
    """A search with what it leaves of held-out records, what it is called, what there was no time for, and how clearly
    held-out records validate it.
    """

    found: State
    before: Excess
    after: Excess
    verdict: Verdict
    not_tried: tuple[str, ...] = ()
    confirmed_t: float = 0.0


@dataclass(frozen=True)
class Known:
    """What is known of a search beside its excess.

    Args:
        converged: Whether the calibration converged.
        is_one: Whether every cause has one size over all records; False where one has not, None where too few records
            tell of one.
        whole: Share that causes take of everything beyond the sensor's noise, what looks random included.
        fitted: What the nominal model leaves of the fitted records beyond the noise, in % of their variance.
        fitted_beyond_sensor: The same beyond the noise of the sensor, which what looks random may exceed.
        untried: What there was no time for.
        of_fit: Share that causes take of the squared residuals of the fitted records.
        stands_in: Why one of the causes is none, in words; empty where all may be.
        is_untold: Whether there was no time to see what some cause stands in for.
        shape: What is visible and has no name, in words; empty where nothing of that kind is.
        not_random: What of the nominal model's residuals shows that it is not random, in % of the fitted records'
            variance.
        any_figures: A cause of which not one figure is known within itself; empty where none is such.
        scattered: The same, where how far records scatter counts too: beside a rest every record may bend it otherwise.
        is_stated_otherwise: Whether the nominal model has figures far from what is stated of them.
        is_short: Whether held-out records are too short to judge more than what is missing of the power in them.
        predicts_worse: Whether held-out records are predicted clearly worse with the causes than without them.
        between_samples: What a load may do between its samples, in % of the fitted records' variance.
    """

    converged: bool = True
    is_one: bool | None = None
    whole: float = 1.0
    fitted: float = 0.0
    fitted_beyond_sensor: float = 0.0
    untried: Sequence[str] = ()
    of_fit: float = 0.0
    stands_in: str = ""
    is_untold: bool = False
    shape: str = ""
    not_random: float = inf
    is_short: bool = False
    any_figures: str = ""
    scattered: str = ""
    is_stated_otherwise: bool = False
    predicts_worse: bool = False
    between_samples: float = 0.0

    @property
    def unsettled(self) -> tuple[str, ...]:
        """What is said where the calibration did not converge."""
        return () if self.converged else ("The last fit did not converge: take the figures with care.",)


def verdict(found: State, before: Excess, after: Excess, known: Known | None = None) -> Verdict:
    """What the search amounts to.

    Args:
        found: The search.
        before: Excess of the calibrated nominal model.
        after: Excess of the extended one.
        known: What else is known.
    """
    known = known or Known()
    if not found.accepted:
        return _without_name(found, before, known)
    settings, missing = found.bench.settings, _missing(before)
    taken, said = _taken(found, before, after), _named(found.accepted)
    confused = [cause for cause in found.accepted if cause.confusable]
    classes = [cause for cause in found.accepted if cause.effect.cause.one_class]
    explains_all = _is_all(found, before, after) or (
        not is_visible(found.left) and after.misfit <= settings.small_misfit
    )
    further = (taken.sentence, *_not_told_apart(confused), *known.unsettled)
    if why := _is_none(before, after, known):
        return _not_established(found, before, known, why)
    if taken.is_faint and taken.share < settings.least_share:
        return _not_established(found, before, known, NOT_LESS)
    if not explains_all and (why := _beside_a_rest(before, after, known)):
        return _not_established(found, before, known, why)
    if not explains_all and _is_part_named(found, taken.share, after, known):
        left = f"An unexplained residual of {after.percent:.3g} % has none." if after.percent > 0 else WITHIN_NOISE
        return Verdict(PARTLY, (f"{missing}. Part of it has a name: {said}. {left}", *further))
    if not explains_all:
        unknown = known.any_figures or known.scattered
        why = ANY_FIGURES.format(unknown) if unknown else TOO_MUCH
        return _not_established(found, before, known, OTHER_SIZES if known.is_one is False else why)
    if known.any_figures:
        return _not_established(found, before, known, NO_FIGURE.format(known.any_figures))
    is_at_end = any(found.is_at_bound(cause) for cause in found.accepted)
    if is_at_end and (why := _at_its_end(found, known)):
        return _not_established(found, before, known, why)
    is_part = known.whole < settings.taken_by_one
    is_unsteady = before.misfit < settings.random_misfit  # held-out: less noise
    if is_part and is_unsteady:
        text = f"{missing}. {said[0].upper()}{said[1:]} would take part of it; most of it looks random, and is not."
        return Verdict(UNEXPLAINED, (text, *known.unsettled))
    if (is_part or is_unsteady) and is_at_end:
        return _not_established(found, before, known, AT_BOUND)
    if is_part and before.significant and before.percent - after.percent < settings.least_excess:
        return _not_established(found, before, known, NOT_LESS)
    if is_part or is_unsteady:  # most of the gap is still there
        text = f"{missing}. Part of it has a name: {said}. What is left looks random, and is more than that."
        return Verdict(PARTLY, (text, *further))
    if known.is_one is False and found.left is not None and found.left.visible:
        if known.is_untold:
            return _not_established(found, before, known, UNTOLD)
        text = f"{missing}. Part of it has a name: {said}, though not of one size in all records, and what is left is "
        return Verdict(PARTLY, (f"{text}not all random.", *further))
    if classes or confused:
        is_one_sure = any(cause not in classes and not cause.confusable for cause in found.accepted)
        named = f"{missing}, and most of it has names: {said}." if is_one_sure else f"{missing}."
        return Verdict(AMBIGUOUS, (named, *_one_class(classes), *further, *_small_residual(found, after)))
    same = _same_record(found.accepted)
    return Verdict(EXPLAINED, (f"{missing}: {said}.", *further, *same, *_small_residual(found, after)))


def _is_none(before: Excess, after: Excess, known: Known) -> str:
    """Why causes are none, whatever they take; empty where they may be some."""
    if max(before.percent - after.percent, known.fitted) < known.between_samples:
        return BETWEEN_SAMPLES
    if known.stands_in or known.predicts_worse:
        return known.stands_in or NO_BETTER
    return TOO_SHORT if known.is_short and not before.significant else ""


def _at_its_end(found: State, known: Known) -> str:
    """Why a cause that has run into the end of what it can be is none; empty where it may be one."""
    if known.is_one is False:  # it bends to each record, as far as it can
        return OTHER_SIZES
    above_noise = found.beyond_sensor(found.outcome).misfit > found.bench.settings.small_misfit
    return AT_BOUND_ABOVE_NOISE if above_noise else ""


def _beside_a_rest(before: Excess, after: Excess, known: Known) -> str:
    """Why nothing is established beside something that is left, whatever it takes; empty where it may be."""
    if before.threshold >= WHOLE and not before.significant:
        return TOO_STILL
    if after.percent > WHOLE:
        return WORSE
    return UNTOLD if known.is_untold else ""


def _is_all(found: State, before: Excess, after: Excess) -> bool:
    """Whether causes explain all but noise or a small part.

    Where something is visible beside them, what looks random beyond the noise of the sensor is no noise.
    """
    settings = found.bench.settings
    if not is_all(after, before, settings):
        return False
    if not is_visible(found.left):
        return True
    first, beyond = (found.beyond_sensor(outcome) for outcome in (found.nominal, found.outcome))
    tells = after.threshold < WHOLE  # or the calibration is too uncertain for held-out records to refute anything
    if tells and beyond.misfit <= settings.small_misfit:
        return True
    return beyond.percent <= max(settings.least_excess, settings.named_share * first.of_signal)


def _not_established(found: State, before: Excess, known: Known, why: str) -> Verdict:
    """Causes that are none: something is missing, unless without them nothing would have been said to be."""
    without = _without_name(found, before, known)
    if without.word == CONSISTENT:
        return without
    said = _named(found.accepted)
    text = f"{_missing(before)}. {said[0].upper()}{said[1:]} would take part of it, {why}"
    return Verdict(UNEXPLAINED, (text, *known.unsettled))


def _is_part_named(found: State, share: float, after: Excess, known: Known) -> bool:
    """Whether causes that take a share of what was missing are established although a residual is left.

    What has another size in other records, or any size, or has run into the end of what it can be, stands in for
    something else, however much it takes.
    """
    is_of_any_size = known.is_one is False or known.any_figures or known.scattered
    if is_of_any_size or any(found.is_at_bound(cause) for cause in found.accepted):
        return False
    settings = found.bench.settings
    nobody_knows = known.is_one is None and known.of_fit >= settings.taken_by_all  # but nearly all of one record
    is_small = after.misfit <= settings.small_misfit
    is_alone = len(found.accepted) == 1 and (is_small or bool(known.is_one) or nobody_knows)
    in_fitted = sum(cause.share for cause in found.accepted)  # a held-out record or two may favour what stands in
    return min(share, in_fitted) >= (settings.taken_by_one if is_alone else settings.taken_by_all)


def _without_name(found: State, before: Excess, known: Known) -> Verdict:
    """Nothing is missing, or no name was found for it."""
    settings, visible = found.bench.settings, is_visible(found.seen)
    is_more = before.misfit > settings.small_misfit
    is_gross = visible and is_more and known.fitted > settings.gross_percent
    matters = visible and known.not_random > settings.least_excess  # a form of a law that is hardly another's shows too
    missing = (before.significant and (matters or is_more)) or is_gross
    waiting = [name for name in known.untried if found.seen is not None and found.seen.visible.shows(name)]
    if missing and waiting:
        text = f"{_missing(before)}, and the time was over before its likely cause was tried: {', '.join(waiting)}."
        return Verdict(UNEXPLAINED, (text, *known.unsettled))
    if missing:
        text = f"{_missing(before)}, and no effect of the catalogue is validated on held-out records."
        looks = (f"What is missing looks like {known.shape}.",) if known.shape else ()
        return Verdict(UNEXPLAINED, (text, *looks, *known.unsettled))
    if visible and waiting:
        text = "Something is visible that is not random, and there was no time to try what it could be."
        return Verdict(UNEXPLAINED, (text, *known.unsettled))
    if known.shape:
        text = f"Something is visible that is not random: {known.shape}. No effect of the catalogue is validated."
        return Verdict(UNEXPLAINED, (text, *known.unsettled))
    beyond = found.beyond_sensor(found.nominal)
    raised = beyond.misfit > settings.small_misfit and beyond.percent > settings.least_excess
    if before.threshold >= WHOLE and known.fitted_beyond_sensor > settings.gross_percent:
        text = (
            f"The simulation misses {known.fitted_beyond_sensor:.3g} % of the variance of the records that it was "
            "fitted to, and the others hold too little motion to tell what is missing."
        )
        return Verdict(UNEXPLAINED, (text, *known.unsettled))
    if matters and raised:  # more than a sensor makes, and not all of it can be random
        text = (
            f"{beyond.percent:.3g} % of the signal's variance looks nearly random, is more than the noise of the "
            "sensor, and something in it is visible that is not random; no effect of the catalogue is validated."
        )
        return Verdict(UNEXPLAINED, (text, *known.unsettled))
    if raised and before.threshold > settings.gross_percent:  # so large an effect could hide in what looks random
        much = f"{beyond.percent:.3g} % of the signal's variance" if beyond.percent <= WHOLE else "What is missed"
        text = (
            f"{much} is more than the noise of the sensor, and the records are too short to tell whether a random load "
            "makes it or something is missing."
        )
        return Verdict(UNEXPLAINED, (text, *known.unsettled))
    if known.is_stated_otherwise:
        return Verdict(UNEXPLAINED, (OTHER_FIGURES, *known.unsettled))
    if visible and (is_more or before.significant):
        text = (
            f"What the simulation misses is not random, and less than {max(before.percent, before.threshold):.2g} % of "
            "the signal's variance: no effect that takes more is missing."
        )
    elif before.threshold >= WHOLE:
        text = "No evidence of an effect; the fitted records are too few to say how large one could be unseen."
    else:
        text = f"No evidence of an effect that takes more than {before.threshold:.2g} % of the signal's variance."
    return Verdict(CONSISTENT, (text,))


def _missing(before: Excess) -> str:
    if before.percent > WHOLE:
        return "The simulation is farther from the held-out records than their means are"
    if before.percent > 0:
        return f"The simulation misses {before.percent:.3g} % of the signal's variance"
    if before.threshold >= WHOLE:
        return "The simulation misses something, and the held-out records hold too little motion to say how much"
    # what is missing shows in its form, not in its power
    return f"The simulation misses something, though less than {before.threshold:.2g} % of the signal's variance"


def _small_residual(found: State, after: Excess) -> tuple[str, ...]:
    """What is left and not random, where causes explain nearly all."""
    if not is_visible(found.left) or after.percent <= 0:
        return ()
    return (f"What is left, {after.percent:.2g} % of the signal's variance, is not all random.",)


def is_visible(seen: Assessment | None) -> bool:
    """Whether residuals hold something that is not random; where nobody looked, they may."""
    return seen is None or bool(seen.visible)


@dataclass(frozen=True)
class _Taken:
    """Share of what was missing that causes take, what it is a share of, and whether its power is too small to tell."""

    share: float
    of: str
    is_faint: bool = False

    @property
    def sentence(self) -> str:
        return f"With it {self.of} falls by {100 * self.share:.1f} %."


def _taken(found: State, before: Excess, after: Excess) -> _Taken:
    """Of held-out power, or of what is not random where that is small.

    Where what looks random is as large as what is missed, all of the held-out error may still fall by more.
    """
    seen, left = found.seen, found.left
    if not before.significant and seen is not None and left is not None and seen.taken:
        not_random = _Taken(1 - min(left.taken / seen.taken, 1.0), "what is not random in the fitted records", True)
        error = _Taken(1 - after.misfit / before.misfit, "the squared error of the held-out records", True)
        return max(not_random, error, key=lambda one: one.share)
    missing = before.of_signal
    share = (missing - after.percent) / missing if missing > 0 else 0.0
    return _Taken(min(share, 1.0), "the held-out excess")  # what is left may by chance be below noise


def statuses(word: str) -> str:
    """Whether the causes of a verdict are established or merely suggested."""
    return "established" if word in (EXPLAINED, AMBIGUOUS, PARTLY) else "suggested"


def _named(accepted: Sequence[Accepted]) -> str:
    *others, last = (f"{cause.effect.cause.sentence} (`{cause.name}`)" for cause in accepted)
    return f"{', '.join(others)} and {last}" if others else last


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
        for other in cause.looks_like
    )
