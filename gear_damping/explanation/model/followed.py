"""A nominal model from the records that it follows, where one of them is of another kind.

Where flanks part in one record of six, no parameters follow it, and those that come nearest follow none of the others.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace

from gear_damping.explanation.evidence.excess import ac_energy
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.parting_flanks import are_crossed
from gear_damping.identification.output_error.records import FitRecord

BEYOND_NOISE = 3.0  # times the noise: what is left at least of a record that a model has lost
HELPED = 0.1  # of the mean square that is left: what the other records leave at most once they are followed
MOST_LOST = 3  # of so many records one may be lost
REVERSED = (0.02, 0.98)  # of the samples of a torque: its ends without spikes
ZERO_ERROR = 0.05  # of the larger torque: a smaller one of the other sign may be an error of the zero


def followed_alone(
    nominal: Outcome, evidence: Evidence, calibrated: Callable[[Evidence], Iterator[Outcome]]
) -> tuple[Outcome, Evidence] | None:
    """The nominal model of the records that it follows without the others, and these; None where there are no such.

    The worst record is left out, one after another, as long as the rest is followed far better for it.

    Args:
        nominal: Fitted to all records.
        evidence: All records.
        calibrated: Fits the nominal model to records, to a part of long ones first: of what that leaves too much, all
            of them leave no less.
    """
    found, kept = nominal, evidence
    while any(losses := _losses(found, kept)):
        if MOST_LOST * (len(evidence.fit) - len(kept.fit) + 1) > len(evidence.fit):
            return None
        worst = max(range(len(losses)), key=losses.__getitem__)
        kept = replace(kept, fit=tuple(record for i, record in enumerate(kept.fit) if i != worst))
        least = HELPED * _mean_square(found)
        for again in calibrated(kept):
            if _mean_square(again) > least:
                return None
            found = again
    return None if kept is evidence else (found, kept)


def of_one_flank(evidence: Evidence) -> Evidence:
    """The evidence without fitted records whose torque changes its sign, or whose error shows that the flanks change.

    As it is where all or none of them do. There the teeth cross the gap between their flanks, whatever its size, and
    the softest of springs, or the stiffest of dampers, would come nearest to that.
    """
    pairs = zip(evidence.fit, are_crossed(evidence), strict=True)
    kept = tuple(record for record, is_crossed in pairs if not is_crossed and not _is_reversed(record))
    return replace(evidence, fit=kept) if 0 < len(kept) < len(evidence.fit) else evidence


def _is_reversed(record: FitRecord) -> bool:
    """Whether the torque drives one flank and then the other, by more than a torque meter's zero is off."""
    torque = record.inputs.get("pinion_torque")
    if torque is None:
        return False
    low, high = torque.quantile(torque.new_tensor(REVERSED)).tolist()
    return low < 0 < high and min(-low, high) > ZERO_ERROR * max(-low, high)


def _losses(found: Outcome, evidence: Evidence) -> list[float]:
    """What is left of every record that the model has lost; 0 of the others."""
    least = (BEYOND_NOISE * evidence.noise) ** 2
    left = [(float(r.square().sum()), float(r.square().mean())) for r in found.fit_residuals]
    shares = [evidence.settings.lost_share * ac_energy(record) for record in evidence.fitted]
    return [total if total > share and mean > least else 0.0 for (total, mean), share in zip(left, shares, strict=True)]


def _mean_square(found: Outcome) -> float:
    count = sum(len(residual) for residual in found.fit_residuals)
    return sum(float(residual.square().sum()) for residual in found.fit_residuals) / count
