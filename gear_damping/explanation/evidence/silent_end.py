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
END = 1 / 3  # of a record, which tells its noise of all colours where no motion is left in it
NEAR = 0.3  # of the natural frequency to both sides: a motion that is left has most of its power there


def audible_samples(record: FitRecord) -> int:
    """Samples up to the last block in which the response moves by more than the noise, or an input moves.

    The noise is the floor of the spectrum above the signal, or what its last third holds where that is no motion: a
    noise of another colour than white is more than that floor. All samples where nothing dies away.
    """
    total = len(record.response)
    frequency = first_frequency(record, driven=False)
    period = record.sampling_rate / frequency if frequency > 0 else total
    block = max(FEWEST_SAMPLES, ceil(PERIODS * period))
    count, noise = ceil(total / block), floor_variance(record)
    if count <= FEWEST_BLOCKS or noise <= 0:
        return total
    limit = largest_of_noise(count, block)
    moves = _power(record.response, block) > max(noise * limit, _of_still_end(record, frequency, count, block))
    for series in record.inputs.values():
        power, own = _power(series, block), floor_variance(replace(record, response=series))
        moves = moves | (power > torch.clamp(STILL**2 * power.max(), min=own * limit))
    last = int(moves.nonzero().max()) if bool(moves.any()) else count
    return min(total, max(last + 1, FEWEST_BLOCKS) * block)


def _of_still_end(record: FitRecord, frequency: float, count: int, block: int) -> float:
    """The largest variance of a block by the noise that the end of a record holds; 0 where motion is left in it."""
    end = record.response[-round(END * len(record.response)) :]
    end = end - end.mean()
    power = torch.fft.rfft(end * torch.hann_window(len(end), dtype=end.dtype)).abs().square()
    lines = torch.fft.rfftfreq(len(end), 1 / record.sampling_rate)
    near = float(power[(lines - frequency).abs() <= NEAR * frequency].sum())
    if len(end) < 2 * block or near >= float(power.sum()) / 2:
        return 0.0
    spectrum = torch.fft.rfft(end, n=2 * len(end)).abs().square()
    shares = torch.fft.irfft(spectrum)[: block // 2]
    shares = shares / shares[0]
    correlated = float(1 + 2 * shares[1:].square().sum())  # samples for one that is independent
    return float(end.square().mean()) * largest_of_noise(count, max(round(block / correlated), 2))


def largest_of_noise(count: int, block: int) -> float:
    """The largest variance that noise has in any of so many blocks of samples, over its own."""
    return float(chi2.ppf(1 - CHANCE / count, block - 1)) / (block - 1)


def _power(series: Tensor, block: int) -> Tensor:
    """Variance within each block; the last one reaches back, so that it is as long as the others."""
    count = ceil(len(series) / block)
    return torch.stack([series[min(i * block, len(series) - block) :][:block].var() for i in range(count)])
