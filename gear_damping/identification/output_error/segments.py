"""Records in segments, each with an initial state of its own (multiple shooting).

Where flanks part, a small error of the initial state grows until nothing of a long record can be predicted from
its start; a segment of a few natural periods can. A fit over segments has fewer local minima, too.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import torch
from torch import Tensor

from gear_damping.identification.output_error.records import FitRecord

FEWEST_SAMPLES = 24  # of a segment: its initial state takes a few of them


@dataclass(frozen=True)
class Segments:
    """How records are cut.

    Args:
        seconds: Length of a segment; 0 leaves records whole.
        exact: Whether it is exactly that, a shorter end being left out; else the nearest that leaves nothing out.
    """

    seconds: float = 0.0
    exact: bool = False

    def __bool__(self) -> bool:
        return self.seconds > 0

    def ends(self, record: FitRecord) -> list[tuple[int, int]]:
        """First sample of each segment of a record, and the one behind its last."""
        total = len(record.response)
        wanted = max(FEWEST_SAMPLES, round(self.seconds * record.sampling_rate))
        if not self or wanted >= total:
            return [(0, total)]
        if self.exact:
            return [(first, first + wanted) for first in range(0, total - wanted + 1, wanted)]
        count = max(1, total // wanted)
        return list(pairwise(round(i * total / count) for i in range(count + 1)))


WHOLE = Segments()


def part(record: FitRecord, samples: slice, suffix: str = "") -> FitRecord:
    """The samples of a slice of a record, as a record of its own or, without a suffix, a segment of it.

    Inputs are known at even instants. Of samples with uneven stamps the part begins at the last one of these before its
    first sample.
    """
    first = samples.start or 0
    stamps, begins = record.stamps, first
    if stamps is not None:
        begins = int(stamps[first])
        stamps = stamps[samples] - begins
    response = record.response[samples]
    cut = replace(
        record,
        response=response,
        inputs={name: _from(series, begins, len(response)) for name, series in record.inputs.items()},
        others=tuple((channel, values[samples]) for channel, values in record.others),
        stamps=stamps,
        begins=record.begins + begins / record.sampling_rate,
    )
    return replace(cut, name=record.name + suffix) if suffix else replace(cut, group=record.record)


def _from(series: Tensor, begins: int, count: int) -> Tensor:
    """So many values of a series (time,) from one on; the last one stays where there are fewer."""
    found = series[begins : begins + count]
    return torch.cat([found, series[-1:].expand(count - len(found))])


def in_segments(records: Sequence[FitRecord], segments: Segments) -> list[FitRecord]:
    """Every record cut into segments."""
    return [part(record, slice(*ends)) if segments else record for record in records for ends in segments.ends(record)]


def covered(records: Sequence[FitRecord], segments: Segments) -> list[FitRecord]:
    """The records with the segments that they are predicted in, without the ends that these leave out."""
    if not segments:
        return list(records)
    pieces = [tuple(segments.ends(record)) for record in records]
    return [replace(shortened(r, own[-1][1]), pieces=own) for r, own in zip(records, pieces, strict=True)]


def stretch(record: FitRecord, samples: slice) -> FitRecord:
    """The samples of a slice of a record, under its name."""
    return replace(part(record, samples), group=record.group)


def shortened(record: FitRecord, samples: int) -> FitRecord:
    """The first samples of a record, under its name."""
    return stretch(record, slice(0, samples))


def joined(
    series: Sequence[Tensor], records: Sequence[FitRecord], segments: Segments, channels: Sequence[str] | None = None
) -> list[Tensor]:
    """What stands in the order of the segments put together again by record.

    Args:
        series: By segment, its channels one after another at one length, (channels * time,).
        records: The whole records.
        segments: How they were cut.
        channels: Of each, by name, of which a record may have some; where absent there is one.

    Returns:
        By record, the channels that it has one after another, (its channels * samples,).
    """
    left, whole = iter(series), []
    for record in records:
        rows = [0] if channels is None else [channels.index(channel.name) for channel in record.channels]
        count = 1 if channels is None else len(channels)
        parts = [next(left).unflatten(-1, (count, -1))[rows, : b - a] for a, b in segments.ends(record)]
        whole.append(torch.cat(parts, -1).flatten())
    return whole
