"""Which candidates are fitted in full, which fits count, and which are rivals."""

from types import SimpleNamespace
from unittest.mock import patch

import torch

from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.trials import bench as benches
from gear_damping.explanation.trials import comparison
from gear_damping.explanation.trials.refit import Refit, chosen, compared
from gear_damping.identification.output_error.uncertainty import QUANTILE
from tests.explanation.decisions.declared import decides
from tests.explanation.decisions.made_up import NAMES, bench, fit, left, outcome, scored

BLOCKS, BLOCK = 16, 10
HELD = SimpleNamespace(duration=BLOCKS * BLOCK / 100.0, sampling_rate=100.0)


@decides("full_fits", 4)
def fitted_in_full(settings: SearchSettings):
    """Of as many effects as there are, each unlike the others and of half the predicted gain of the one before."""
    return len(chosen([scored(place, 0.5**place) for place in range(len(NAMES))], settings))


@decides("most_full_fits", 9)
def fitted_in_full_of_those_that_look_alike(settings: SearchSettings):
    return len(chosen([scored(place, 1 - 0.01 * place, direction=0) for place in range(len(NAMES))], settings))


@decides("exchange_share", [NAMES[0], NAMES[1]])
def tried_in_the_place_of_a_cause(settings: SearchSettings):
    """Of predicted gains of 1, .8 and .3."""
    ranked = [scored(place, gain) for place, gain in enumerate((1.0, 0.8, 0.3))]
    return [score.candidate.name for score in chosen(ranked, settings, settings.exchange_share)]


@decides("least_promise", [NAMES[0], NAMES[1]])
def worth_a_full_fit_beside_causes(settings: SearchSettings):
    """Of predicted gains of 80, 15 and 5 % of what a model leaves, none of it noise."""
    ranked = [scored(place, gain) for place, gain in enumerate((0.8, 0.15, 0.05))]
    return [score.candidate.name for score in bench(settings).worth(ranked, outcome(cost=1.0))]


@decides("seen_in_fit", (True, False))
def seen_in_fit(settings: SearchSettings):
    """Falls of the fitted cost by 60 and by 10 noise variances."""
    evidence = SimpleNamespace(settings=settings, noise=0.1, judged=[])
    with (
        patch("gear_damping.explanation.trials.refit.paired_gain", lambda *_: (1.0, 50.0)),
        patch("gear_damping.explanation.trials.refit.block_samples", lambda *_: [BLOCK]),
    ):
        before = outcome(cost=1.0, left_out=[])
        fits = (compared(None, outcome(cost=1 - fall / 100, left_out=[]), before, evidence) for fall in (60, 10))
        return tuple(one.is_seen_in_fit for one in fits)


def of_conditions_left_out(gains: torch.Tensor) -> list[SimpleNamespace]:
    """Two models by their residuals: of a size of 3 in every block, and of so much more power."""
    best = torch.full((BLOCKS * BLOCK,), 3.0, dtype=torch.float64)
    other = (best.square() + gains.repeat_interleave(BLOCK)).sqrt()
    return [SimpleNamespace(left_out=[residual]) for residual in (other, best)]


def as_good(gains: torch.Tensor, settings: SearchSettings) -> bool:
    with patch.object(comparison, "block_samples", lambda *_: [BLOCK]):
        return bench(settings, judged=[HELD]).is_as_good(*of_conditions_left_out(gains))


@decides("rival_t", (True, False))
def told_apart_by_the_paired_test(settings: SearchSettings):
    """Gains with a t of about 1.3 and 4, of many noise variances in all."""
    turns = torch.tensor([1.0, -1.0] * (BLOCKS // 2), dtype=torch.float64)
    return tuple(as_good(1.0 + 4 / t * turns, settings) for t in (1.3, 4.0))


@decides("rival_evidence", (True, False))
def told_apart_by_odds(settings: SearchSettings):
    """A difference of 4 and of 40 noise variances in all, of one sign in every block."""
    return tuple(as_good(torch.full((BLOCKS,), size / (BLOCKS * BLOCK)).double(), settings) for size in (4.0, 40.0))


@decides("rival_share", (True, False))
def rival_that_fits_better(settings: SearchSettings):
    best = fit(gain=1.0, fit_gain=100.0)
    with patch.object(benches.Bench, "is_as_good", lambda *_: False):
        return tuple(bench(settings)._is_rival(fit(gain=gain, fit_gain=400.0), best) for gain in (0.95, 0.5))


@decides("determined", (True, False))
def determined(settings: SearchSettings):
    """Half intervals of .3 and of 2, where more than noise is left and little of it is taken."""
    found, beside = fit("a"), outcome()
    tried = bench(settings, [(found.outcome, left(50.0, 100.0)), (beside, left(60.0, 120.0))])
    return tuple(is_determined_within(half, tried, found, beside) for half in (0.3, 2.0))


def is_determined_within(half: float, tried: benches.Bench, found: Refit, beside: SimpleNamespace) -> bool:
    """Whether a law is of known size whose one strength has such a half interval, as a logarithm."""
    parameter = SimpleNamespace(name="a.strength", logarithmic=True)
    unknowns = SimpleNamespace(at_bound=lambda shared: torch.tensor([False]))
    found.outcome.problem = SimpleNamespace(free=[parameter], unknowns=unknowns)
    found.outcome.fitted.shared = None
    covariances = torch.full((1, 1), (half / QUANTILE) ** 2, dtype=torch.float64)
    with patch.object(benches, "covariance_of", lambda *_: covariances):
        return tried.is_determined(found, beside)
