"""Records that were sampled far more often than they change, at a rate that still shows all of it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import torch
from torch import Tensor

from gear_damping.identification.output_error.records import FitRecord

CONTENT = 0.999  # share of the energy that counts as content
PER_PERIOD = 60  # samples of a period of the fastest content: a mean over them changes it by (pi / 60)^2 / 6 = 5e-4
PER_TIME = 100  # samples of a characteristic time: what is quick beside it, as a friction that turns, stays visible


def decimated(records: Sequence[FitRecord], characteristic_s: float) -> list[FitRecord]:
    """Records by the means of so many samples as change nothing that is fitted; they keep their number of channels.

    Args:
        records: The records; those with uneven stamps stay as they are.
        characteristic_s: Time scale of the motion in s.
    """
    return [_by_means(record, _factor(record, characteristic_s)) for record in records]


def _factor(record: FitRecord, characteristic_s: float) -> int:
    if record.stamps is not None:
        return 1
    rate = record.sampling_rate
    fastest = max(_fastest(values, rate) for values in (record.response, *(v for _, v in record.others)))
    return max(1, int(min(rate / (PER_PERIOD * fastest), rate * characteristic_s / PER_TIME)))


def _fastest(values: Tensor, rate: float) -> float:
    """Hz below which all but a thousandth of the energy about the mean lies."""
    shown = values.numpy()
    power = np.abs(np.fft.rfft((shown - shown.mean()) * np.hanning(len(shown)))) ** 2
    return float(np.searchsorted(np.cumsum(power), CONTENT * power.sum()) + 1) * rate / len(shown)


def _by_means(record: FitRecord, factor: int) -> FitRecord:
    if factor == 1:
        return record

    def means(series: Tensor) -> Tensor:
        return series[: len(series) // factor * factor].unflatten(0, (-1, factor)).mean(1)

    def driving(name: str, series: Tensor) -> Tensor:
        """Of what is held, the mean about each sample: half of what came before and half of what comes after it."""
        return (torch.cat([series[:1], series[:-1]]) + series) / 2 if name in record.held else series

    return replace(
        record,
        response=means(record.response),
        sampling_rate=record.sampling_rate / factor,
        inputs={name: means(driving(name, series)) for name, series in record.inputs.items()},
        held=(),
        others=tuple((channel, means(values)) for channel, values in record.others),
    )
