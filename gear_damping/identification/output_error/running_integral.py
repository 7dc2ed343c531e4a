"""What a rate or an acceleration shows of a displacement: its running integral, without what no record tells."""

import torch
from torch import Tensor

SLOWEST, PERIODS = 0.01, 3  # share of the energy that is no slow motion; periods of one that its mean is taken over


def integrated(values: Tensor, rate: float, times: int) -> Tensor:
    """(n,) values at so many Hz, integrated so many times."""
    slow = _slow(values) if times else 0
    for _ in range(times):
        values = _once(values - values.mean(), 1 / rate, slow)
    return values


def _once(values: Tensor, step: float, slow: int) -> Tensor:
    """Running integral without its straight line, and without its mean over so many samples about each.

    An integral adds up what a record does not tell, its mean first of all: what is slower than anything that was
    recorded is no motion.
    """
    total = torch.cat([values.new_zeros(1), ((values[1:] + values[:-1]) / 2 * step).cumsum(0)])
    total = about_its_line(total)
    if slow >= len(total):
        return total
    sums = torch.cat([total.new_zeros(1), total.cumsum(0)])
    places = torch.arange(len(total))
    first, last = (places - slow // 2).clamp(min=0), (places + slow // 2 + 1).clamp(max=len(total))
    return total - (sums[last] - sums[first]) / (last - first)


def about_its_line(values: Tensor) -> Tensor:
    """(n,) values about the straight line through them."""
    time = torch.linspace(-1, 1, len(values), dtype=values.dtype)
    return values - values.mean() - time * (time @ values) / (time @ time)


def _slow(values: Tensor) -> int:
    """Samples of some periods of the slowest motion that a record shows."""
    power = torch.fft.rfft((values - values.mean()) * torch.hann_window(len(values), dtype=values.dtype)).abs().square()
    energy = power.cumsum(0) / power.sum().clamp(min=1e-300)
    slowest = int((energy < SLOWEST).sum())
    return round(PERIODS * len(values) / max(slowest, 1))
