"""The random part of residuals as an autoregression, and the filter that whitens it.

Burg would fit each record; the covariance method pools all rows, which short records need. The order is the one with
the least BIC (Schwarz 1978). Where all lags that are allowed are used up, as by a sensor whose noise goes with 1/f, the
past goes on in octaves, each as the mean of its samples (Corsi 2009, J. Financial Econometrics 7(2)): few numbers for
a long memory. Such noise wanders: every octave draws towards its mean. One that pushes away follows a slow swing, which
is not for the noise to take.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import inf, log

import torch
from scipy.signal import lfilter
from torch import Tensor

MOST_ORDER = 8  # coefficients: more would swallow a resonance as well as the effect that drives it
MOST_OCTAVES = 8  # of lags behind those: up to 2048 samples
SAMPLES_PER_ORDER = 8  # of the shortest row, for each coefficient and for each lag of an octave
NEAR = 32768  # numbers worked on at a time: a quarter of a megabyte, which stays in the cache of a core
LAGS = 4000  # over which autocorrelations are summed
SETTLED = 1e-9  # of an autocorrelation: what is left of it no longer counts


@dataclass(frozen=True)
class Autoregression:
    """x_t = sum_k a_k x_(t-k) + sum_j b_j mean(x_(t-k), p 2^j < k <= p 2^(j+1)) + e_t.

    Args:
        coefficients: a_1 to a_p, (p,).
        innovation: Variance of e.
        octaves: b_0 to b_(q-1), (q,).
    """

    coefficients: Tensor
    innovation: float
    octaves: Tensor = field(default_factory=lambda: torch.zeros(0, dtype=torch.float64))

    @property
    def order(self) -> int:
        """Number of coefficients."""
        return len(self.coefficients) + len(self.octaves)

    @property
    def memory(self) -> int:
        """Samples that it looks back."""
        return len(self.coefficients) * 2 ** len(self.octaves)

    @property
    def variance(self) -> float:
        """Variance of x."""
        return self.innovation * float(self._impulse.square().sum())

    @property
    def correlation(self) -> float:
        """Sum of the squared autocorrelations over all lags: so many samples count as one of a variance."""
        impulse = self._impulse
        spectrum = torch.fft.rfft(impulse, n=2 * len(impulse)).abs().square()
        covariance = torch.fft.irfft(spectrum)[: len(impulse)]
        squares = (covariance / covariance[0]).square()
        return float(2 * squares.sum() - 1)

    @property
    def _impulse(self) -> Tensor:
        """Response to one innovation, until nothing is left of it, (lags,)."""
        innovation = torch.zeros(LAGS, dtype=torch.float64)
        innovation[0] = 1.0
        found = torch.as_tensor(lfilter([1.0], [1.0, *(-self.lags).tolist()], innovation.numpy()))
        counts = (found.abs() > SETTLED).nonzero()
        return found[: int(counts[-1]) + 1]

    @property
    def lags(self) -> Tensor:
        """The coefficient of every lag, (memory,)."""
        own = [self.coefficients]
        for number, coefficient in enumerate(self.octaves.tolist()):
            width = len(self.coefficients) * 2**number
            own.append(torch.full((width,), coefficient / width, dtype=torch.float64))
        return torch.cat(own)

    def whitened(self, rows: Tensor) -> Tensor:
        """The innovations of rows (..., time); 0 for the first `memory` samples, which have no full past."""
        return self.whitened_columns(rows.unsqueeze(-1))[..., 0]

    def whitened_columns(self, signals: Tensor) -> Tensor:
        """The same of signals (..., time, n), as many of whose samples at a time as a processor keeps near."""
        found = signals.clone(memory_format=torch.contiguous_format)
        found[..., : self.memory, :] = 0.0
        shape = (-1, *signals.shape[-2:])
        for white, signal in zip(found.view(shape), signals.reshape(shape), strict=True):
            self._whiten(white, signal)
        return found

    def _whiten(self, found: Tensor, signal: Tensor) -> None:
        """Write the innovations of one signal (time, n) over its copy."""
        sums = torch.nn.functional.pad(signal, (0, 0, 1, 0)).cumsum(0) if len(self.octaves) else signal
        size, length = max(NEAR // max(signal.shape[1], 1), 1), len(signal)
        for begin in range(self.memory, length, size):
            stop = min(begin + size, length)
            kept = found[begin:stop]
            for lag, a in enumerate(self.coefficients.tolist(), 1):
                kept.sub_(signal[begin - lag : stop - lag], alpha=a)
            for lag, weight in self._ends.items():
                kept.sub_(sums[begin - lag : stop - lag], alpha=weight)

    @property
    def _ends(self) -> dict[int, float]:
        """By lag, what a sum of all samples before it counts: an octave's mean is the difference of two of them."""
        found: dict[int, float] = {}
        for number, b in enumerate(self.octaves.tolist()):
            width = len(self.coefficients) * 2**number
            for lag, sign in ((width, 1), (2 * width, -1)):
                found[lag] = found.get(lag, 0.0) + sign * b / width
        return found


def octave(rows: Tensor, lag: int) -> Tensor:
    """Means of the samples lag+1 to 2 lag before each sample that has them, (..., time - 2 lag)."""
    sums = torch.nn.functional.pad(rows, (1, 0)).cumsum(-1)
    return (sums[..., lag : rows.shape[-1] - lag] - sums[..., : rows.shape[-1] - 2 * lag]) / lag


def autoregression(rows: Sequence[Tensor], taken: float = 0.0) -> Autoregression:
    """The autoregression of several rows (time,) that share one law.

    Args:
        rows: Residuals without mean, each of one record.
        taken: Degrees of freedom that a regression took out of them before.

    Raises:
        ValueError: there is no sample.
    """
    samples = sum(len(row) for row in rows)
    if not samples:
        raise ValueError("an autoregression needs samples")
    shortest = min(len(row) for row in rows)
    most = min(MOST_ORDER, shortest // SAMPLES_PER_ORDER)
    best = _likeliest([_of_order(rows, order, most) for order in range(most + 1)], rows, most)
    if best.order == MOST_ORDER:
        count = sum(MOST_ORDER * 2**j <= shortest // SAMPLES_PER_ORDER for j in range(1, MOST_OCTAVES + 1))
        longest = MOST_ORDER * 2**count
        longer = [_of_order(rows, MOST_ORDER, longest, octaves) for octaves in range(count + 1)]
        best = _likeliest(longer, rows, longest)
    left = samples / max(samples - taken, 1.0)
    return replace(best, innovation=best.innovation * left)


def _likeliest(fits: Sequence[Autoregression], rows: Sequence[Tensor], most: int) -> Autoregression:
    """The fit with the least BIC, each over the samples that have `most` before them."""
    used = sum(len(row) - most for row in rows)
    return min(fits, key=lambda fit: used * log(max(fit.innovation, 1e-300)) + fit.order * log(max(used, 2)))


def _of_order(rows: Sequence[Tensor], order: int, most: int, octaves: int = 0) -> Autoregression:
    """The fit of one order over the samples that have `most` before them; stable."""
    target = torch.cat([row[most:] for row in rows])
    if not order:
        return Autoregression(torch.zeros(0, dtype=torch.float64), float(target.square().mean()))
    past = torch.cat([_past(row, order, most, octaves) for row in rows])
    found = torch.linalg.lstsq(past, target.unsqueeze(1), rcond=1e-12, driver="gelsd").solution[:, 0]
    if not octaves:
        found = _stable(found)
    law = Autoregression(found[:order], float((target - past @ found).square().mean()), found[order:])
    wanders = bool((law.octaves > 0).all()) and (not octaves or _is_stable(law.lags))
    return law if wanders else replace(law, innovation=inf)


def _past(row: Tensor, order: int, most: int, octaves: int) -> Tensor:
    """What each sample that has `most` before it is regressed on, (samples, order + octaves)."""
    near = [row[most - k : len(row) - k] for k in range(1, order + 1)]
    means = [octave(row, order * 2**number) for number in range(octaves)]
    return torch.stack([*near, *(mean[-len(row) + most :] for mean in means)], 1)


def _stable(coefficients: Tensor) -> Tensor:
    """Coefficients whose poles lie inside the unit circle; poles outside are drawn in."""
    companion = torch.zeros(len(coefficients), len(coefficients), dtype=torch.float64)
    companion[0] = coefficients
    companion[1:, :-1] += torch.eye(len(coefficients) - 1, dtype=torch.float64)
    radius = float(torch.linalg.eigvals(companion).abs().max())
    if radius < 1:
        return coefficients
    shrink = (1 - 1e-3) / radius
    return coefficients * shrink ** torch.arange(1, len(coefficients) + 1, dtype=torch.float64)


def _is_stable(lags: Tensor) -> bool:
    """Whether all poles of a long memory lie inside the unit circle: its reflections are below 1 (Levinson 1947)."""
    left = lags
    while len(left):
        reflection = float(left[-1])
        if abs(reflection) >= 1:
            return False
        left = (left[:-1] + reflection * left[:-1].flip(0)) / (1 - reflection**2)
    return True
