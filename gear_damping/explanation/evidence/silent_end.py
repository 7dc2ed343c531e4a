"""Where the motion of a record has died away: what lies behind tells of the noise alone."""

from dataclasses import replace
from math import ceil

import torch
from scipy.stats import chi2
from torch import Tensor

from gear_damping.explanation.evidence.noise import floor_variance
from gear_damping.identification.oscillator.first_frequency import first_frequency
from gear_damping.identification.output_error.records import FitRecord

PERIODS, FEWEST_SAMPLES = 2.0, 64  # of a block: the longer of the two
CHANCE = 0.01  # that noise alone is taken for motion anywhere in a record
STILL = 1e-3  # of the largest movement of an input in a block: with less, or no more than its noise, it rests
FEWEST_BLOCKS = 3  # that are left: fewer tell nothing of a decay


def audible_samples(record: FitRecord) -> int:
    """Samples up to the last block in which the response moves by more than the noise, or an input moves.

    The noise is the floor of the spectrum above the signal. All samples where nothing dies away.
    """
    total = len(record.response)
    frequency = first_frequency(record, driven=False)
    period = record.sampling_rate / frequency if frequency > 0 else total
    block = max(FEWEST_SAMPLES, ceil(PERIODS * period))
    count, noise = ceil(total / block), floor_variance(record)
    if count <= FEWEST_BLOCKS or noise <= 0:
        return total
    limit = largest_of_noise(count, block)
    moves = _power(record.response, block) > noise * limit
    for series in record.inputs.values():
        power, own = _power(series, block), floor_variance(replace(record, response=series))
        moves = moves | (power > torch.clamp(STILL**2 * power.max(), min=own * limit))
    last = int(moves.nonzero().max()) if bool(moves.any()) else count
    return min(total, max(last + 1, FEWEST_BLOCKS) * block)


def largest_of_noise(count: int, block: int) -> float:
    """The largest variance that noise has in any of so many blocks of samples, over its own."""
    return float(chi2.ppf(1 - CHANCE / count, block - 1)) / (block - 1)


def _power(series: Tensor, block: int) -> Tensor:
    """Variance within each block; the last one reaches back, so that it is as long as the others."""
    count = ceil(len(series) / block)
    return torch.stack([series[min(i * block, len(series) - block) :][:block].var() for i in range(count)])
