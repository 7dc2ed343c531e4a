"""A channel that counts the other way round than what is declared beside it is found before any physics is sought.

A transmission error may be taken as the lag of the gear or as its lead, an accelerometer may be mounted head down. The
nominal simulation then leaves most of the records, and with the opposite sign of that channel it follows them.
"""

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace

from gear_damping.errors import InputError
from gear_damping.explanation.evidence.excess import ac_energy
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.followed import of_one_flank
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.measurement.record import Finding
from gear_damping.physics.systems.traits import Trait

Fit = Callable[[Evidence], Outcome]
FEW = 2  # records on which the opposite sign is tried before all: each fit of a pair of gears takes long
LEAVES_LESS = 0.1  # of what the declared sign leaves: no parameter of the nominal model was ever worth so much


def polarity_fault(evidence: Evidence, nominal: Outcome | None, fitted: Fit) -> Finding | None:
    """The finding where the records are followed with the opposite sign of one channel, and else are not.

    Args:
        evidence: The records.
        nominal: The nominal model fitted to them; None where it does not stay finite.
        fitted: Fits it to others.
    """
    if nominal is not None and _follows_one(nominal, evidence):
        return None
    left = 1.0 if nominal is None else _share_left(nominal, evidence)
    for turned, name in _turned(evidence):
        if _loses_few(turned, fitted):
            continue
        try:
            again = fitted(turned)
        except InputError:  # neither sign can be simulated
            continue
        share = _share_left(again, turned)
        if share < min(LEAVES_LESS * left, evidence.settings.lost_share):
            return _finding(name, left if nominal else None, share)
    return None


def _follows_one(nominal: Outcome, evidence: Evidence) -> bool:
    """Whether one record is followed with the signs as they are declared, which are those of all of them."""
    pairs = zip(nominal.fit_residuals, evidence.fitted, strict=True)
    return any(float(left.square().sum()) < LEAVES_LESS * ac_energy(record) for left, record in pairs)


def _turned(evidence: Evidence) -> Iterator[tuple[Evidence, str]]:
    """The evidence with the opposite sign of each channel that all records have, where their loads have one."""
    if not any(record.inputs or record.conditions for record in evidence.fit):
        return
    names = [channel.name for channel in evidence.fit[0].channels]
    for place, name in enumerate(names):
        if all([channel.name for channel in record.channels] == names for record in evidence.fit):
            yield replace(evidence, fit=tuple(_with_sign(r, place) for r in evidence.fit), holdout=()), name


def _loses_few(evidence: Evidence, fitted: Fit) -> bool:
    """Whether the records that move most are not followed by themselves; False where there are no others."""
    few = _few(evidence)
    with suppress(InputError):  # those alone cannot be simulated: all may tell
        return few is not evidence and _share_left(fitted(few), few) > evidence.settings.lost_share
    return False


def _few(evidence: Evidence) -> Evidence:
    """The evidence with those records alone that move most; as it is where there are no more.

    Of a pair of gears those on one flank: no nominal model follows one in which flanks change, with either sign, and
    to find that out takes minutes.
    """
    told = of_one_flank(evidence) if evidence.has(Trait.TEETH) else evidence
    if len(told.fit) <= FEW:
        return told
    return replace(told, fit=tuple(sorted(told.fit, key=ac_energy, reverse=True)[:FEW]))


def _with_sign(record: FitRecord, place: int) -> FitRecord:
    """The record with the opposite sign of its channel at a place."""
    if place == 0:
        return replace(record, response=-record.response)
    others = [(seen, -values if at == place else values) for at, (seen, values) in enumerate(record.others, 1)]
    return replace(record, others=tuple(others))


def _share_left(nominal: Outcome, evidence: Evidence) -> float:
    """What a fit leaves of the fitted records, as a share of their variance."""
    left = sum(float(residual.square().sum()) for residual in nominal.fit_residuals)
    return left / sum(ac_energy(record) for record in evidence.fitted)


def _finding(name: str, left: float | None, share: float) -> Finding:
    before = "cannot be simulated" if left is None else f"leaves {100 * left:.3g} %"
    message = (
        f"it counts the other way round than its load does: with the opposite sign the nominal simulation leaves "
        f"{100 * share:.2g} % of the signal's variance, and as declared it {before}; give the channel `polarity: -1`, "
        "or turn the sign of the load"
    )
    return Finding("reversed", message, channel=name)
