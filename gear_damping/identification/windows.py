"""Windows of runs, read by index a whole batch at a time and never materialised as a set."""

import torch
from torch import Tensor


def gather_windows(values: Tensor, index: Tensor, window: int) -> Tensor:
    """The windows that begin at `index`, copied in one indexing operation on the device of `values`.

    Args:
        values: Signals (runs, time), or columns of whole runs (runs, time, feature).
        index: Run and first sample of each window, (batch, 2), on the device of `values`.
        window: Samples of a window.

    Returns:
        (batch, window), or (batch, window, feature).
    """
    # unfold is a view, (runs, starts, window) or (runs, starts, feature, window): nothing is copied.
    found = values.unfold(1, window, 1)[index[:, 0], index[:, 1]]
    return found if values.ndim == 2 else found.transpose(1, 2)


def window_starts(first: int, end: int, window: int, stride: int) -> Tensor:
    """First samples, `stride` apart, of the windows that lie inside the samples first <= t < end."""
    return torch.arange(first, end - window + 1, stride)


def windows_of_runs(runs: Tensor, starts: Tensor) -> Tensor:
    """Every start in every run: (runs * starts, 2), the layout of an index."""
    return torch.cartesian_prod(runs, starts).reshape(-1, 2)
