"""What is too short to judge is said, with the length that would do."""

from collections.abc import Sequence
from math import ceil, inf

from scipy.stats import norm
from scipy.stats import t as student

from gear_damping.explanation.evidence.records import SPLIT, Evidence
from gear_damping.explanation.model.hypothesis import Outcome, natural_frequency_hz
from gear_damping.explanation.model.stated import stated_frequency
from gear_damping.explanation.trials.refit import FEWEST_BLOCKS
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.time_scale import decorrelation_time

FEWEST_PERIODS = 3.0  # held out, whatever the time over which the motion forgets itself


def too_short(evidence: Evidence, nominal: Outcome) -> str:
    """A sentence where no test over the held-out records can decide, else nothing.

    A test compares residuals over blocks that are independent of each other: a block lasts at least a characteristic
    time, and the variance of fewer than eight blocks is anybody's guess.

    Args:
        evidence: The records.
        nominal: The nominal model fitted to them, whose frequency is theirs.
    """
    period, name = _characteristic(evidence, nominal)
    held = _times(evidence.holdout, period)
    needed = max(FEWEST_BLOCKS, FEWEST_PERIODS)
    if held >= needed:
        return ""
    if evidence.one_record:
        whole, share = _times(evidence.records, period), 1 - SPLIT
        which = f"the last {held:.2g}" if len(evidence.fit) == 1 else f"{held:.2g} in two parts"
        return (
            f"This record holds {whole:.3g} {name}, of which {which} are held out; at least "
            f"{ceil(needed / share)} are needed to judge more than large effects: record at least "
            f"{needed / share * period:.3g} s."
        )
    return (
        f"The held-out records hold {held:.3g} {name}; at least {needed:g} are needed to judge more than large "
        f"effects: hold out records of at least {needed * period:.3g} s."
    )


def least_t(evidence: Evidence, nominal: Outcome) -> float:
    """The t over held-out records that confirms a cause, where these are too short for one of every size; else 0.

    It has the chance that `confirmed_t` has of many, by as many independent blocks as there are characteristic times
    (Student 1908): 2.5 of seven, 4.5 of three. One time tells nothing.
    """
    held = _times(evidence.holdout, _characteristic(evidence, nominal)[0])
    if held >= max(FEWEST_BLOCKS, FEWEST_PERIODS):
        return 0.0
    return float(student.isf(norm.sf(evidence.settings.confirmed_t), held - 1)) if held > 1 else inf


def left_out_ends(evidence: Evidence) -> str:
    """Sentences where ends of records were left out, or what came before their motion was free."""
    before = (
        f"{evidence.waited_s:.3g} s at the beginning, before the motion is free, are left out: no channel holds what "
        "moves the rig until then."
    )
    behind = (
        f"The last {evidence.silent_s:.3g} s hold only noise and are left out: a third of what moves is held out "
        "(records with `role: holdout` are taken whole)."
    )
    return " ".join([*[before] * (evidence.waited_s > 0), *[behind] * (evidence.silent_s > 0)])


def _characteristic(evidence: Evidence, nominal: Outcome) -> tuple[float, str]:
    """Seconds over which the motion forgets itself, and what so many of them are called."""
    frequency = 0.0
    if evidence.has_spring:
        fitted = natural_frequency_hz(nominal.hypothesis.model, nominal.flat_given())
        swings = fitted * evidence.duration >= 1.0  # in a period longer than every record there is no spring to see
        frequency = stated_frequency(evidence) or fitted * swings
    if not frequency:
        time = max(decorrelation_time(record) for record in evidence.fit)
        return time, f"times of {time:.3g} s, over which the motion forgets itself"
    return 1 / frequency, f"natural periods of {frequency:.3g} Hz"


def _times(records: Sequence[FitRecord], period: float) -> float:
    """How many periods records last together."""
    return sum(len(record.response) / record.sampling_rate for record in records) / period
