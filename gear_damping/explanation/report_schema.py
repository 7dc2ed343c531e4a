"""The content of explanation.json: every key with what it means, its unit, and when it is null.

What writes the file follows it, tests hold every answer against it, and docs/explanation.md is written from it.
"""

from typing import Literal, get_args

from pydantic import BaseModel, ConfigDict, Field

SCHEMA_VERSION = 1  # of explanation.json; raised when a key changes its meaning
Word = Literal["consistent", "explained", "ambiguous", "partly_explained", "unexplained", "data_problem"]
VERDICTS: tuple[str, ...] = get_args(Word)
Interval95 = tuple[float, float]


def said(meaning: str, unit: str = "", default: object = ...) -> object:
    """A key with its meaning and unit; with a default where it may be left out."""
    return Field(default, description=meaning, json_schema_extra={"unit": unit})


def may_be_left_out(meaning: str, unit: str = "") -> object:
    """A key that some answers do not have."""
    return said(meaning, unit, None)


class Part(BaseModel):
    """A mapping with these keys and no others."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=True)


class BeforeAfter(Part):
    """A figure of the calibrated nominal simulation and of the extended one."""

    before: float = said("of the calibrated nominal simulation")
    after: float = said("with the causes")


class Residual(BeforeAfter):
    """Root mean square residual."""

    unit: str = said("the unit that was declared")


class Parameter(Part):
    """A fitted parameter."""

    value: float = said("where the fit converged", "`unit`")
    unit: str = said("its unit")
    interval95: Interval95 = said("95 % interval; the whole range where the records say nothing", "`unit`")
    at_bound: bool | None = may_be_left_out(
        "whether it ran into the end of its range: then it stands for something else"
    )
    told: bool | None = may_be_left_out("false where the records say nothing of it: the interval is all it may be")


class PerRecord(Part):
    """The first strength of a cause by one record."""

    record: str = said("the record, or a segment of it")
    value: float = said("the strength", "that of the parameter")
    interval95: Interval95 = said("95 % interval", "that of the parameter")


class Homogeneous(Part):
    """Whether a cause has one size in all records."""

    parameter: str = said("the strength that was compared")
    tau_percent: float | None = said(
        "standard deviation between records beyond their errors; null: not testable", "% of the value"
    )
    interval95: Interval95 | None = said("of that deviation (Q profile)", "% of the value")
    p: float | None = said("of one size within the tolerance (Cochran's Q); null: not testable")
    tolerance: float = said("what a real cause may differ by between records", "1")
    level: float = said("below it the sizes differ")
    testable: bool = said("whether at least three records tell of it")


class Cause(Part):
    """An effect that the simulation lacks."""

    name: str = said("the effect, see docs/effects.md")
    parameters: dict[str, Parameter] = said("its fitted parameters by own name")
    excess_explained: float = said("share of the excess that it takes on records left out of the fit", "1")
    confusable_with: list[str] = said("effects that these data do not tell from it")
    status: Literal["established", "suggested"] = said("established: held-out records validate it")
    fixed: dict[str, float] | None = may_be_left_out(
        "parameters that were tried and not fitted, as the order of a ripple"
    )
    options: dict[str, str | int | bool] | None = may_be_left_out(
        "the form of it that was found, as the `shaft` whose tooth is cracked"
    )
    per_record: list[PerRecord] = said("its first strength record by record")
    homogeneous: Homogeneous = said("whether these are one size")


class ExcessPercent(BeforeAfter):
    """Held-out mean squared residual beyond the noise."""

    threshold: float = said(
        "above it something is missing; 100 where held-out records tell nothing", "% of the channel's variance"
    )


class Misfit(BeforeAfter):
    """Mean squared residual of held-out records over the noise variance."""

    floor: float = said("what noise alone leaves")
    excess_percent: ExcessPercent = said("the same beyond the noise", "% of the channel's variance")
    records: dict[str, BeforeAfter] = said("by held-out record")


class Largest(Part):
    """What stands out most."""

    before: str | None = said("beside the nominal simulation")
    after: str | None = said("beside the extended one")


class Law(Part):
    """An autoregression that whitens a channel."""

    order: int = said("0 for white noise")
    coefficients: list[float] = said("of the samples before")


class Visible(Part):
    """One test over every effect and over families without a name: is anything there that is not random?"""

    p: BeforeAfter = said("family-wise p value")
    statistic: BeforeAfter = said("the maximum over all of them", "standard deviations")
    limit: float = said("beyond it something is visible", "standard deviations")
    level: float = said("chance of that in noise")
    largest: Largest = said("the effect or family with the maximum")
    not_random: BeforeAfter = said("share of the whitened residual that effects and families take beyond chance", "1")
    draws: int = said("sign flips by which it is calibrated")
    effective_blocks: float = said("stretches of time that count")
    whitening: list[Law] = said("of each channel and rate")
    by_name: dict[str, float] = said("the statistic of every effect and family", "standard deviations")


class Random(Part):
    """The random part of the fitted records."""

    percent: float = said("of the channel's variance", "%")
    looks_like: str = said("white or coloured noise, or what a random load makes of the motion")
    snr_db: float = said("the same as a signal-to-noise ratio", "dB")
    correlation: float = said("sum of its squared autocorrelations; 1 for white noise")


class Residuals(Part):
    """Root mean square residuals."""

    fit: Residual = said("of the records to which the models were fitted")
    holdout: Residual = said("of those held out")
    segment_s: float | None = said("length of the segments that records were predicted in; null: whole records", "s")


class DampingRatio(Part):
    """The equivalent damping ratio of all damping, dry friction and hysteresis among it; none without a spring."""

    value: float = said("of critical", "%")
    unit: Literal["%"] = said("its unit")
    interval95: Interval95 = said("95 % interval, of the noise; by what records differ too where more is missed", "%")
    reference_velocity: float = said("velocity amplitude at which it is taken", "`velocity_unit`")
    velocity_unit: str = said("the unit of that")
    by_law: dict[str, float] = said("what each law of damping adds to it, where there are several; else empty", "%")


class DampingRatios(Part):
    """The damping ratio by either simulation."""

    before: DampingRatio = said("by the nominal simulation")
    after: DampingRatio = said("with the causes")
    by_record: list[PerRecord] = said("of each fitted record, where it differs between them; else empty", "%")
    bias_of_the_nominal: float = said("what the missing causes did to it", "%")
    conditional: bool = said(
        "true where something is left that has no name or is not random, or the last fit did not converge: the "
        "interval is that of the noise, or of the jackknife over records where that is wider, and the damping may "
        "lie outside all the same"
    )


class Confirmed(Part):
    """What the causes together are worth on held-out records."""

    t: float = said("t of what they add to the prediction, on what is left without them (Clark & West 2007)")
    percent: float = said("share of the squared residuals that they take", "%")
    interval95: Interval95 = said("of that share, over blocks of time", "%")


class Nrmse(BeforeAfter):
    """Normalised root mean square residual."""

    floor: float = said("what noise alone leaves", "1")


class Gain(Part):
    """What the causes are worth."""

    nrmse: Nrmse = said("root mean square residual over the standard deviation of the channel, held out", "1")
    damping_ratio_percent: DampingRatios | None = said("null where nothing is critical, or no damping was fitted")
    confirmed: Confirmed | None = said("null without a cause")


class Noise(Part):
    """The noise of the channel that is explained."""

    channel: str = said("its name")
    value: float = said("standard deviation", "`unit`")
    unit: str = said("the unit that was declared")
    by_record: dict[str, float] = said("by record", "`unit`")
    method: str = said("how it was found")
    estimates_agree: bool = said("whether two bands above the signal agree within 20 %")


class Candidate(Part):
    """An effect that was tried."""

    name: str = said("the effect")
    promised: float = said("share of the fitted residual that it would take, linearised", "1")
    share: float | None = said("of the squared residual of left-out records that its full fit takes; null: none", "1")
    status: Literal["established", "suggested", "confusable", "rejected", "not_tried"] = said("what became of it")
    at_bound: bool = said("whether its full fit ran into a bound")
    failed: str | None = said("why it could not be fitted")


class NotObservable(Part):
    """An effect that was not found."""

    name: str = said("the effect")
    parameter: str = said("its first strength")
    smallest: float = said("the smallest size that these data would have shown; infinite: none", "`unit`")
    unit: str = said("the unit of that")


class NextExperiment(Part):
    """What to measure next."""

    what: str = said("a sentence")
    separates: list[str] = said("the effects that it would part or confirm")
    kind: str | None = may_be_left_out("its kind in a word")
    conditions_so_far: int | None = may_be_left_out("operating conditions that were measured")
    predicted_separation: float | None = may_be_left_out("how far it would part them", "standard deviations")


class StrongestLine(Part):
    """The force at one order or frequency that would take most of the residual; its phase is free in every record."""

    place: float = said("its order, cycles per turn of the pinion, or its frequency", "1 or Hz")
    unit: Literal["order", "Hz"] = said("which of the two it keeps in all records: order of the pinion, or Hz")
    hertz: float = said("its frequency in the first fitted record", "Hz")
    is_force: bool = said("whether it changes a gear pair's deflection in proportion, as a slow force does")
    share: float = said("of the residuals of the fitted records, that it would take", "1")


class UnexplainedResidual(Part):
    """Where what nobody named lies."""

    shares: dict[str, float] = said("of the held-out residual that a family of features would take", "1")
    kurtosis: float = said("3 for normal residuals")
    bursts: bool = said("whether it comes in bursts")
    orders: dict[str, float] | None = may_be_left_out(
        "shares of its energy by order of pinion s1, gear s2, mesh M", "1"
    )
    line: StrongestLine | None = may_be_left_out("the strongest line; null: records in many segments")
    contact_phase: list[float] | None = may_be_left_out("mean square over the phase of the mesh, over its mean", "1")


class Record(Part):
    """A record."""

    role: str | None = said("fit, holdout or reference; null: not declared, and nothing was fitted")
    samples: int | None = may_be_left_out("those that were used")
    rmse: Residual | None = may_be_left_out("root mean square residual")


class Calibration(Part):
    """The calibration of the nominal simulation, before anything was sought."""

    converged: bool = said("whether it converged")
    parameters: dict[str, float] = said("where it converged", "SI, or the rig's own units")
    steps: list[str] = said("sentences")


class Finding(Part):
    """What was found in the data."""

    kind: str = said("its kind in a word")
    message: str = said("a sentence")
    record: str | None = said("the record")
    channel: str | None = said("the channel")
    sample: int | None = said("the first sample")
    severity: str = said("what follows from it")


class Explanation(Part):
    """The file."""

    schema_version: int = said("of this list; it grows when a key changes its meaning")
    system: str = said("what was measured: `gear_pair`, `oscillator`, or the name of a system of one's own")
    verdict: Word = said("one word for what was found")
    sentences: list[str] = said("what was found, the most important first; `words` in backticks are names")
    causes: list[Cause] = said("the strongest first; empty: none")
    misfit: Misfit | None = said("how far predictions of held-out records are from noise")
    visible: Visible | None = said("whether anything is there that is not random")
    random: Random | None = said("what is random")
    residual: Residuals | None = said("residuals in the unit of the channel")
    parameters: dict[str, Parameter] | None = said("every fitted parameter of the extended simulation")
    gain: Gain | None = said("what naming the causes is worth")
    noise: Noise | None = said("the noise of the sensor, and of what looks random")
    candidates: list[Candidate] = said("every effect that was tried")
    not_tried: list[str] | None = said("what there was no time for")
    not_observable: list[NotObservable] = said("what could not have been seen")
    next_experiment: NextExperiment | None = said("what would tell more")
    unexplained: UnexplainedResidual | None = said("where lies what has no name; null where nothing is missing")
    records: dict[str, Record] = said("by record")
    calibration: Calibration | None = said("of the nominal simulation")
    findings: list[Finding] = said("what was found in the data before anything was fitted")
    casing: dict | None = said("findings by angle and order, of an accelerometer on a casing (`families`, `findings`, "
                               "`what_changed`, `records`)")  # fmt: skip


KEYS = tuple(Explanation.model_fields)
