"""Which of two models predicts records better that no fit has seen, and how much either leaves of them."""

from collections.abc import Sequence
from dataclasses import dataclass

from torch import Tensor

from gear_damping.explanation.evidence.excess import Excess, excess
from gear_damping.explanation.evidence.noise import NoiseLevel
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.statistics.paired import confirmation, paired_gain
from gear_damping.explanation.trials.refit import Refit, block_samples

SAME = 1e-3  # of the noise variance: a mean difference below it is none


@dataclass(frozen=True)
class Comparison:
    """Models on records that are left out of their fits.

    Args:
        evidence: The records, with their noise.
        noise: The same in full.
    """

    evidence: Evidence
    noise: NoiseLevel

    @property
    def settings(self) -> SearchSettings:
        """Thresholds."""
        return self.evidence.settings

    def excess(self, outcome: Outcome) -> Excess:
        """What a model leaves of operating conditions that are left out of its fit."""
        return excess(outcome.left_out, self.evidence.judged, self.noise, self.settings)

    def is_as_good(self, outcome: Outcome, best: Outcome) -> bool:
        """Whether a model is not worse than another by the paired test, or by too little for anybody to bet on it.

        What two predictions differ by may be small and yet have one sign in all blocks. The difference of their sums
        of squares in noise variances is twice the logarithm of the odds between them.
        """
        return self.no_worse(outcome.left_out, best.left_out, self._blocks(best))

    def no_worse(self, other: Sequence[Tensor], best: Sequence[Tensor], blocks: Sequence[int]) -> bool:
        """The same of residuals, over blocks of so many samples by record.

        What errors of a nominal model that is far off add to the noise is not in what the best leaves.
        """
        gain, t = paired_gain(other, best, blocks)
        count = sum(len(residual) for residual in best)
        left = sum(float(residual.square().sum()) for residual in best) / count
        variance = min(self.noise.value**2, left)
        if gain * count / self.noise.correlation < self.settings.rival_evidence * variance:
            return True
        return t < self.settings.rival_t or gain < SAME * variance

    def paired_gain(self, before: Outcome, after: Outcome) -> tuple[float, float]:
        """Gain of the second over the first on left-out records, with its t."""
        return paired_gain(before.left_out, after.left_out, self._blocks(after))

    def confirmation(self, before: Outcome, after: Outcome) -> float:
        """The t statistic of what the second adds to the prediction of conditions left out."""
        return confirmation(before.left_out, after.left_out, self._blocks(after))

    def _blocks(self, outcome: Outcome) -> list[int]:
        return block_samples(outcome, self.evidence, self.evidence.judged)

    def is_further(self, richer: Outcome, simpler: Outcome) -> bool:
        """Whether a richer law takes as much of what the one that it contains leaves as a further cause must.

        One that takes less bends to something else that is missing.
        """
        left, most = self.excess(richer).percent, self.excess(simpler).percent
        return most - left >= self.settings.least_share * most

    def takes_most(self, fit: Refit, beside: Outcome) -> bool:
        """Whether an effect takes most of what a model without it leaves of operating conditions that are left out."""
        left, most = self.excess(fit.outcome).percent, self.excess(beside).percent
        return most - left >= self.settings.taken_by_one * most
