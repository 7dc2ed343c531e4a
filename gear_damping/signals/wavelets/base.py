"""What every continuous wavelet transform has in common: arguments, routes, memory."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from math import exp, log, pi, sqrt
from typing import ClassVar

import torch
from torch import Tensor, nn

from gear_damping.setting import Setting
from gear_damping.signals.checks import require_positive, require_records
from gear_damping.signals.operators import dense_matrix, spectrum

MOST_SCALES = 4096  # of one transform: each is a series as long as the record, and a spectrum twice as long
_OPERATORS_KEPT = 4  # lengths of records whose operators stay in memory


class ContinuousWavelet(nn.Module, ABC):
    """Transform (batch, time) -> (batch, scale, time) by the wavelet of a subclass.

    Give either `frequencies_hz`, or `frequency_min_hz`, `frequency_max_hz` and `n_scales` for
    log-spaced frequencies, ascending. All arguments are plain numbers: `type(w)(**w.settings)` is an
    equal transform. The result has the precision and the device of the signal.

    Records of up to `dense_limit` samples are one matrix product, longer ones are filtered by FFT;
    both give the defining sum to rounding, at every scale. The wavelet itself is sampled well from a
    scale of about 1 sample (Ricker, up to 0.25 of the sampling rate) or (omega0 + 4) / pi samples
    (Morlet); below that the sum sees folded frequencies: a Ricker at 0.5 samples answers to a constant.

    The transform has no state: operators are computed from the arguments for the length, precision and
    device of the signal, and the last few are kept. They are no buffers, because `.float()` on a model
    would round them, and a checkpoint should not hold what its arguments say.

    Args:
        sampling_rate: Samples per second (Hz).
        frequencies_hz: Frequency of each scale (Hz), 0 < f <= sampling_rate / 2.
        frequency_min_hz: Lowest of the log-spaced frequencies (Hz).
        frequency_max_hz: Highest of the log-spaced frequencies (Hz).
        n_scales: Number of log-spaced frequencies.

    Raises:
        ValueError: an argument is out of range, or the frequencies are given both ways or neither.
    """

    name: ClassVar[str]  # its key in `wavelet.kind`
    own_settings: ClassVar[tuple[Setting, ...]] = ()  # arguments beside these, keys under `wavelet`
    complex_mother = False
    # records filtered at a time by FFT: bounds the memory to chunk * scale * padded time; 16 measured fastest for 2000
    # samples and 32 scales
    chunk = 16
    # longest record (samples) that is transformed by matrix, of scale * time^2 elements: about where both cost the same
    dense_limit = 64

    def __init__(
        self,
        sampling_rate: float,
        *,
        frequencies_hz: Sequence[float] | None = None,
        frequency_min_hz: float | None = None,
        frequency_max_hz: float | None = None,
        n_scales: int | None = None,
    ) -> None:
        super().__init__()
        require_positive("sampling_rate", sampling_rate)
        spacing = (frequency_min_hz, frequency_max_hz, n_scales)
        if (frequencies_hz is None) == all(value is None for value in spacing):
            raise ValueError("give either frequencies_hz, or frequency_min_hz, frequency_max_hz and n_scales")
        if frequencies_hz is None:
            frequencies_hz = log_spaced_frequencies(*spacing)
        self.sampling_rate = float(sampling_rate)
        self.frequencies_hz = _checked_frequencies(frequencies_hz, self.sampling_rate)
        self._operators: dict[tuple, tuple[Tensor, int]] = {}

    @abstractmethod
    def mother(self, t: Tensor) -> Tensor:
        """The mother wavelet psi at times t (in scales), with unit energy and psi(-t) = conj(psi(t))."""

    @property
    @abstractmethod
    def ridge_number(self) -> float:
        """2 pi f s / sampling_rate at the ridge of a tone over the scales (L2): the rule used here."""

    @property
    @abstractmethod
    def peak_number(self) -> float:
        """2 pi f s / sampling_rate at the peak of the spectrum of one wavelet (the rule under L1)."""

    @property
    def scales(self) -> tuple[float, ...]:
        """Scale of each row (samples)."""
        return tuple(self.ridge_number * self.sampling_rate / (2 * pi * f) for f in self.frequencies_hz)

    @property
    def settings(self) -> dict[str, object]:
        """The constructor arguments as plain numbers, for a checkpoint or a file."""
        return {"sampling_rate": self.sampling_rate, "frequencies_hz": list(self.frequencies_hz)}

    def output_dtype(self, dtype: torch.dtype) -> torch.dtype:
        """The type of the coefficients of a signal of type `dtype`."""
        return dtype

    def forward(self, signal: Tensor) -> Tensor:
        """Coefficients of shape (batch, scale, time), in the unit of the signal.

        Raises:
            ValueError: the signal is not (batch, time) in float32 or float64.
        """
        require_records(signal)
        return self._by_matrix(signal) if signal.shape[1] <= self.dense_limit else self._by_fft(signal)

    def cone_of_influence(self, n_samples: int, device: torch.device | str | None = None) -> Tensor:
        """Boolean mask (scale, time), True where the ends of the record are felt: within sqrt(2) s of one."""
        sample = torch.arange(n_samples, device=device)
        distance = torch.minimum(sample, n_samples - 1 - sample)
        reach = sqrt(2) * torch.tensor(self.scales, device=device)
        return distance < reach[:, None]

    def extra_repr(self) -> str:
        """What `print` shows of the transform."""
        low, high = min(self.frequencies_hz), max(self.frequencies_hz)
        rate = self.sampling_rate
        return f"{len(self.frequencies_hz)} scales, {low:g} to {high:g} Hz, sampling_rate={rate:g} Hz"

    def _by_matrix(self, signal: Tensor) -> Tensor:
        matrix, _ = self._operator(signal, self._matrix)
        shape = (len(signal), len(self.frequencies_hz), signal.shape[1])
        product = signal @ matrix
        if not self.complex_mother:
            return product.reshape(shape)
        return self._result(torch.view_as_complex(product.reshape(*shape, 2)))

    def _by_fft(self, signal: Tensor) -> Tensor:
        response, n_fft = self._operator(signal, self._spectrum)
        shape = (len(signal), len(self.frequencies_hz), signal.shape[1])
        coefficients = signal.new_empty(shape, dtype=self.output_dtype(signal.dtype))
        for first in range(0, len(signal), self.chunk):
            rows = slice(first, first + self.chunk)
            coefficients[rows] = self._result(self._filtered(signal[rows], response, n_fft)[..., : shape[2]])
        return coefficients

    def _filtered(self, signal: Tensor, response: Tensor, n_fft: int) -> Tensor:
        if self.complex_mother:
            return torch.fft.ifft(torch.fft.fft(signal, n=n_fft)[:, None] * response)
        return torch.fft.irfft(torch.fft.rfft(signal, n=n_fft)[:, None] * response, n=n_fft)

    def _result(self, coefficients: Tensor) -> Tensor:
        """What is kept of one chunk of coefficients."""
        return coefficients

    def _matrix(self, n_samples: int, dtype: torch.dtype) -> tuple[Tensor, int]:
        return dense_matrix(self.mother, self.scales, n_samples), n_samples

    def _spectrum(self, n_samples: int, dtype: torch.dtype) -> tuple[Tensor, int]:
        return spectrum(self.mother, self.scales, n_samples, dtype)

    def _operator(self, signal: Tensor, build: Callable[..., tuple[Tensor, int]]) -> tuple[Tensor, int]:
        """The operator for this length, type and device, and the length that its FFT works on."""
        key = (signal.shape[1], signal.dtype, signal.device)
        if key not in self._operators:
            # Built in ordinary mode: a tensor made in inference mode could not serve in training later.
            with torch.inference_mode(False), torch.no_grad():
                operator, n_fft = build(signal.shape[1], signal.dtype)
                self._operators[key] = (operator.to(signal.device, signal.dtype), n_fft)
            if len(self._operators) > _OPERATORS_KEPT:
                del self._operators[next(iter(self._operators))]
        return self._operators[key]


def log_spaced_frequencies(minimum_hz: float, maximum_hz: float, n_scales: int) -> tuple[float, ...]:
    """`n_scales` frequencies (Hz) in equal ratios from minimum to maximum, both included.

    Raises:
        ValueError: a value is missing or not positive, n_scales is below 2 or above 4096, or the limits are swapped.
    """
    if minimum_hz is None or maximum_hz is None or n_scales is None:
        raise ValueError("frequency_min_hz, frequency_max_hz and n_scales belong together: give all three")
    require_positive("frequency_min_hz", minimum_hz)
    if not minimum_hz < maximum_hz:
        raise ValueError(f"frequency_max_hz must exceed frequency_min_hz {minimum_hz!r}, got {maximum_hz!r}")
    if n_scales > MOST_SCALES:
        raise ValueError(_too_many(f"n_scales {n_scales!r}"))
    if n_scales < 2:
        raise ValueError(f"n_scales must be at least 2, got {n_scales!r}: give one as frequencies_hz")
    ratio = log(maximum_hz / minimum_hz) / (n_scales - 1)
    return (*(minimum_hz * exp(ratio * i) for i in range(n_scales - 1)), maximum_hz)


def _too_many(what: str) -> str:
    return f"{what} exceeds {MOST_SCALES}: every scale is a series as long as the record in memory, so take fewer"


def _checked_frequencies(frequencies_hz: Sequence[float], sampling_rate: float) -> tuple[float, ...]:
    if len(frequencies_hz) > MOST_SCALES:
        raise ValueError(_too_many(f"frequencies_hz of {len(frequencies_hz)} scales"))
    frequencies = tuple(float(f) for f in frequencies_hz)
    wrong = [f for f in frequencies if not 0 < f <= sampling_rate / 2]
    if wrong or not frequencies:
        rule = f"frequencies_hz must be above 0 and at most sampling_rate / 2 = {sampling_rate / 2:g} Hz"
        raise ValueError(f"{rule}, got {wrong or 'none'}: leave those out")
    return frequencies
