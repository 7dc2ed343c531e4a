"""Held-out residuals with as much of a wandering zero in them as the fitted ones have.

Where a sensor's zero is unknown every record has an offset of its own, which takes what changes slower than the record
is long: of a sensor whose noise grows towards low frequencies, the more the shorter it is. A held-out record that is
longer than all that were fitted would show the rest of it, and be held against a noise that it is no part of.
"""

from collections.abc import Sequence
from itertools import pairwise

import torch
from torch import Tensor

from gear_damping.identification.output_error.records import FitRecord


def as_fitted(residuals: Sequence[Tensor], held: Sequence[FitRecord], fitted: Sequence[FitRecord]) -> list[Tensor]:
    """Residuals of held-out records, (channels * time,) each, of which every stretch has an offset of its own.

    Stretches are as long as the longest fitted record; a channel whose zero is known keeps what its residual is.
    """
    longest = max(record.duration for record in fitted)
    return [_offset_apart(left, one, round(one.duration / longest)) for left, one in zip(residuals, held, strict=True)]


def _offset_apart(residual: Tensor, record: FitRecord, stretches: int) -> Tensor:
    if stretches < 2:
        return residual
    rows = residual.unflatten(0, (len(record.channels), -1)).clone()
    ends = torch.linspace(0, rows.shape[1], stretches + 1).round().long().tolist()
    for channel, row in zip(record.channels, rows, strict=True):
        for first, stop in pairwise(ends) if channel.offset else ():
            row[first:stop] -= row[first:stop].mean()
    return rows.flatten()
