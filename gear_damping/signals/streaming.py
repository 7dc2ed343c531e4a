"""Wavelet transforms of whole data sets with bounded memory."""

from collections.abc import Iterator

import torch
from torch import Tensor

from gear_damping.signals.checks import require_positive, require_records
from gear_damping.signals.wavelets import ContinuousWavelet


@torch.no_grad()
def iterate_coefficients(
    wavelet: ContinuousWavelet,
    signals: Tensor,
    records: int = 32,
    device: torch.device | str | None = None,
) -> Iterator[tuple[slice, Tensor]]:
    """Yield (rows, coefficients) of `signals`, shape (run, time), `records` runs at a time.

    Args:
        wavelet: The transform.
        signals: Records of shape (run, time); may lie in a memory-mapped file.
        records: Runs in one step; memory is a few times records * scale * time. Some C libraries keep freed
            blocks for a while, which counts as memory too.
        device: Where to compute; by default where the signals are. The coefficients stay there.
    """
    require_records(signals, "signals")
    require_positive("records", records)
    for first in range(0, len(signals), records):
        rows = slice(first, min(first + records, len(signals)))
        yield rows, wavelet(signals[rows].to(device or signals.device))


def transform_in_chunks(
    wavelet: ContinuousWavelet,
    signals: Tensor,
    out: Tensor | None = None,
    records: int = 32,
    device: torch.device | str | None = None,
) -> Tensor:
    """Coefficients of all `signals`, shape (run, scale, time), without a graph.

    Args:
        wavelet: The transform.
        signals: Records of shape (run, time).
        out: Where to write, of shape (run, scale, time); a memory-mapped tensor keeps the result out of
            memory. By default a new tensor where the signals are.
        records: Runs in one step.
        device: Where to compute; by default where the signals are.

    Returns:
        `out`.

    Raises:
        ValueError: `out` has another shape, or is real while the coefficients are complex.
    """
    require_records(signals, "signals")
    shape = (len(signals), len(wavelet.frequencies_hz), signals.shape[1])
    dtype = wavelet.output_dtype(signals.dtype)
    if out is None:
        out = torch.empty(shape, dtype=dtype, device=signals.device)
    if out.shape != shape or (dtype.is_complex and not out.is_complex()):
        raise ValueError(f"out must have shape {shape} and hold {dtype}, got {tuple(out.shape)}, {out.dtype}")
    for rows, coefficients in iterate_coefficients(wavelet, signals, records, device):
        out[rows] = coefficients.to(out.device)
    return out
