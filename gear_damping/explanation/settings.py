"""Every threshold by which a search decides, in one place.

`conf/explain/default.yaml` mirrors them. What only steers numerics (iterations, steps of differences) stands beside
its code.
"""

from dataclasses import dataclass, field


def within(value: float, lower: float, upper: float, unit: str = "") -> float:
    """A field with its default, the range that it may be set to, and its unit."""
    return field(default=value, metadata={"lower": lower, "upper": upper, "unit": unit})


@dataclass(frozen=True)
class SearchSettings:
    """Thresholds of a search.

    Sizes are shares of what stands behind them; a misfit is a mean squared residual in noise variances, an excess what
    residuals of left-out records hold beyond the noise, in % of the channel's variance.

    Args:
        level: Chance at which anything at all would be called visible in noise (evidence: family-wise test).
        least_excess: Excess below which nothing is called significant, %.
        standard_errors: Of the excess, beyond which it is significant: 3 for one test in 700.
        settled_share: Of the first excess; less, with `settled_misfit`, is the form of an effect that is right.
        settled_misfit: What may then be left at most.
        named_share: Of the first excess; more, if noise alone would not leave it, is a part without a name.
        small_misfit: What may be left without a name where nothing in it is visible.
        accepted_t: t of the gain on left-out records that a cause needs (paired test over blocks).
        confirmed_t: t of what a cause adds to held-out predictions, one-sided (Clark & West 2007).
        rival_t: t below which two explanations are not told apart.
        rival_evidence: Twice the logarithm of the odds below which they are not told apart either: 100 to 1.
        rival_share: Of the best one's gain that a rival needs which fits the other records better.
        least_share: Of what is left that a cause must take, so that none is named before a larger one.
        least_promise: Of what is left, a further effect's predicted gain for a full fit: full fits beside
            accepted causes took 2.6 times as much at most (60 of them, in hidden cases of seeds 15300 to 15403).
        seen_in_fit: Fall of the fitted cost in noise variances by which a cause is seen: five deviations.
        most_causes: In one answer.
        most_calibrations: Times that the nominal model is calibrated anew.
        full_fits: Of the most promising effects beside a model.
        most_full_fits: With those that resemble the first.
        pair_bases: Effects beside which a second one is sought.
        pair_seconds: Effects that are fitted in full beside each.
        pair_share: Of what the first cause took by itself, for a rival to be such a base.
        exchange_share: Of the best predicted gain, for an effect to be tried in the place of a cause.
        bent_misfit: Left by a nominal model whose free shape is no good place to begin.
        most_growth: Of an error of the initial state over a record that is predicted from its start.
        determined: Of a parameter, the half of its 95 % interval, for it to be known.
        random_share: Of the residual that is not random; with less of it the rest is the noise.
        told_level: Chance at which strengths that are none would count as told.
        told_alone_level: The same for one of them alone.
        lost_share: Of the variance of a record or of a stretch of it; a model that leaves more has lost it.
        taken_by_all: Of the excess that causes must take to be established although a residual is left.
        taken_by_one: The same for a cause that stands alone and has one size in all records, or leaves little.
        random_misfit: A nominal model cannot leave less than noise: below it what looks random is more than that.
        gross_percent: % of the fitted records' variance; so much missing is something, whatever held-out records tell.
        homogeneity_tolerance: Of a strength, that a real cause may differ by between records.
        homogeneity_level: Chance at which a cause of one size would be called one of several.
        most_samples: Of the fitted records together that are searched, and of the held-out ones: of longer records a
            stretch. A look at 40 000 took 40 s of a core, and a search of five minutes takes a dozen.
    """

    level: float = within(0.01, 0.0001, 0.5)
    least_excess: float = within(0.03, 0, 100, "%")
    standard_errors: float = within(3.0, 0, 100)
    settled_share: float = within(0.02, 0, 1)
    settled_misfit: float = within(1.2, 1, 1000000.0)
    named_share: float = within(0.05, 0, 1)
    small_misfit: float = within(3.0, 1, 1000000.0)
    accepted_t: float = within(3.0, 0, 100)
    confirmed_t: float = within(2.0, 0, 100)
    rival_t: float = within(2.0, 0, 100)
    rival_evidence: float = within(9.2, 0, 1e6)
    rival_share: float = within(0.9, 0, 1)
    least_share: float = within(0.25, 0, 1)
    least_promise: float = within(0.1, 0, 1)
    seen_in_fit: float = within(25.0, 0, 1000000000.0)
    most_causes: int = within(4, 1, 20)
    most_calibrations: int = within(3, 0, 100)
    full_fits: int = within(4, 1, 1000)
    most_full_fits: int = within(9, 1, 1000)
    pair_bases: int = within(3, 0, 100)
    pair_seconds: int = within(4, 0, 1000)
    pair_share: float = within(0.5, 0, 1)
    exchange_share: float = within(0.6, 0, 1)
    bent_misfit: float = within(4.0, 0, 1000000000.0)
    most_growth: float = within(2.0, 0, 1000000000.0)
    determined: float = within(0.5, 0, 1000)
    random_share: float = within(0.25, 0, 1)
    told_level: float = within(0.01, 1e-06, 1)
    told_alone_level: float = within(0.05, 1e-06, 1)
    lost_share: float = within(0.5, 0, 1000)
    taken_by_all: float = within(0.9, 0, 1)
    taken_by_one: float = within(0.5, 0, 1)
    random_misfit: float = within(0.8, 0, 1000)
    gross_percent: float = within(5.0, 0, 1000000.0, "%")
    homogeneity_tolerance: float = within(0.15, 0, 10)
    homogeneity_level: float = within(0.05, 1e-06, 1)
    most_samples: int = within(20000, 1000, 1000000000)
