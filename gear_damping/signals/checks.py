"""What every function of this package asks of the tensors it is given."""

import torch
from torch import Tensor


def require_records(signal: Tensor, name: str = "signal") -> None:
    """Check that `signal` is a batch of records, shape (batch, time), in float32 or float64.

    Raises:
        ValueError: the shape or the type is another one; the message says what to do.
    """
    if signal.ndim != 2:
        remedy = f"pass {name}[None] for one record" if signal.ndim == 1 else "select one channel"
        raise ValueError(f"{name} must have shape (batch, time), got {tuple(signal.shape)}: {remedy}")
    if signal.dtype not in (torch.float32, torch.float64):
        raise ValueError(f"{name} must be float32 or float64, got {signal.dtype}: convert it first")
    if signal.shape[1] < 2:
        raise ValueError(f"{name} must have at least 2 samples, got {signal.shape[1]}: use a longer record")


def require_positive(name: str, value: float) -> None:
    """Check that `value` is a positive number.

    Raises:
        ValueError: it is not.
    """
    if not value > 0:
        raise ValueError(f"{name} must be positive, got {value!r}")
