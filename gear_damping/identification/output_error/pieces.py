"""Records in pieces, each with an initial state of its own.

Where flanks part, a small error of the initial state grows until nothing of a long record can be predicted from
its start; a piece of a few natural periods can. A fit over pieces (multiple shooting) has fewer local minima, too.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import torch
from torch import Tensor

from gear_damping.identification.output_error.problem import FitRecord


def part(record: FitRecord, piece: slice, suffix: str = "") -> FitRecord:
    """The samples of a slice; a shaft whose angle was not measured has turned on by its beginning."""
    inputs = {name: series[piece] for name, series in record.inputs.items()}
    conditions = dict(record.conditions)
    if piece.start and "pinion_angle" not in record.inputs and "pinion_speed" in conditions:
        turned = conditions["pinion_speed"] * piece.start / record.sampling_rate
        conditions["pinion_angle"] = conditions.get("pinion_angle", 0.0) + turned
    return replace(
        record, name=record.name + suffix, response=record.response[piece], inputs=inputs, conditions=conditions
    )


def in_pieces(records: Sequence[FitRecord], samples: int) -> list[FitRecord]:
    """Every record cut into pieces of nearly equal length, of at least so many samples; 0 leaves them whole."""
    return [part(record, slice(*ends)) for record in records for ends in _ends(record, samples)]


def joined(series: Sequence[Tensor], records: Sequence[FitRecord], samples: int) -> list[Tensor]:
    """What stands in the order of the pieces, (time,) each, put together again by record."""
    left, whole = iter(series), []
    for record in records:
        whole.append(torch.cat([next(left)[: stop - start] for start, stop in _ends(record, samples)]))
    return whole


def _ends(record: FitRecord, samples: int) -> list[tuple[int, int]]:
    total = len(record.response)
    count = max(1, total // samples) if samples else 1
    at = [round(i * total / count) for i in range(count + 1)]
    return list(pairwise(at))
