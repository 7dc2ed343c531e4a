"""Samples that a search needs: no more often than the motion changes, and no longer than tells its effects."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, pi

import torch

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.slow_rotation import gear_ratio
from gear_damping.identification.decimation import decimated
from gear_damping.identification.oscillator.linear_model import linear_model
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.segments import stretch
from gear_damping.physics.systems.traits import Trait

TURNS = 2.0  # of the slower shaft that a stretch holds: less does not tell a line of it from what changes slowly
MOST_SHARES = 2.0  # of a record's share of the samples, that these turns may take
STARTS = 16  # places in a record at which a stretch may begin
AS_LOUD = 0.5  # of the energy of the loudest stretch: the first one with as much is taken


def at_useful_rate(evidence: Evidence) -> Evidence:
    """Records of a free or forced swing at a rate that shows all of its motion, and no more."""
    if not evidence.has(Trait.REST):
        return evidence
    scale = linear_model(evidence.fit, evidence.known)[2]
    return replace(
        evidence, fit=tuple(decimated(evidence.fit, scale)), holdout=tuple(decimated(evidence.holdout, scale))
    )


@dataclass(frozen=True)
class Stretches:
    """Evidence of no more than so many samples.

    Args:
        evidence: With one stretch of every record that was too long.
        said: How much of the records that is; empty where they are whole.
    """

    evidence: Evidence
    said: str = ""


def of_useful_length(evidence: Evidence) -> Stretches:
    """One stretch of each record of which there is too much to be searched in the time of a search.

    Short records stay whole, and the long ones share what is left of `most_samples`. So it is done with the held-out
    records, which have as many. Of ten thousand samples an effect of a twentieth of the noise is seen; the time grows
    with them.
    """
    most = evidence.settings.most_samples
    fit, holdout = (_stretches(records, most, evidence) for records in (evidence.fit, evidence.holdout))
    pairs = list(zip(evidence.records, (*fit, *holdout), strict=True))
    long = [(whole, kept) for whole, kept in pairs if len(kept.response) < len(whole.response)]
    if not long:
        return Stretches(evidence)
    total, searched = (sum(record.duration for record in records) for records in zip(*long, strict=True))
    said = (
        f"{len(long)} of {len(pairs)} records are long, and {searched:.3g} of their {total:.3g} s were searched, "
        f"a stretch of each: explain.most_samples={2 * most} takes twice as much, and twice the explain.minutes."
    )
    return Stretches(replace(evidence, fit=fit, holdout=holdout), said)


def _stretches(records: Sequence[FitRecord], most: int, evidence: Evidence) -> tuple[FitRecord, ...]:
    share = fair_share([_size(record) for record in records], most)
    return tuple(_stretch(record, share, evidence) for record in records)


def _size(record: FitRecord) -> int:
    return len(record.response) * len(record.channels)


def fair_share(sizes: Sequence[int], most: int) -> float:
    """The largest size of a record with which all together hold no more than `most` samples; short ones stay whole."""
    left = float(most)
    for place, size in enumerate(sorted(sizes)):
        share = left / (len(sizes) - place)
        if size > share:
            return share
        left -= size
    return float("inf")


def _stretch(record: FitRecord, share: float, evidence: Evidence) -> FitRecord:
    """As much of a record as its share, or as a few turns of its slower shaft need, from where it is loud."""
    if _size(record) <= share:
        return record
    fewest = min(_turns(record, evidence) * len(record.channels), MOST_SHARES * share)
    length = ceil(max(share, fewest) / len(record.channels))
    if length >= len(record.response):
        return record
    first = _first_loud(record, length)
    return stretch(record, slice(first, first + length))


def _turns(record: FitRecord, evidence: Evidence) -> float:
    """Samples of so many turns of the slower shaft; none of a rig without shafts, or whose shafts stand."""
    speed = abs(record.conditions.get("pinion_speed", 0.0)) if evidence.has(Trait.SHAFTS) else 0.0
    slower = speed * min(gear_ratio(evidence.parameters), 1.0) if speed else 0.0
    return TURNS * 2 * pi / slower * record.sampling_rate if slower else 0.0


def _first_loud(record: FitRecord, length: int) -> int:
    """First sample of the first stretch that holds nearly as much energy as the loudest one."""
    energy = torch.nn.functional.pad((record.response - record.response.mean()).square().cumsum(0), (1, 0))
    starts = torch.linspace(0, len(record.response) - length, STARTS).round().long()
    held = energy[starts + length] - energy[starts]
    return int(starts[(held >= AS_LOUD * held.max()).nonzero()[0, 0]])
