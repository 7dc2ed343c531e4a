"""Which tooth is in mesh at the start of each record, where no index says so: found with the score of an effect."""

from dataclasses import dataclass

import torch
from torch import Tensor

PASSES = 3  # over all records: a tooth is chosen anew beside those of the others
RIDGE = 1e-9  # of the largest: directions in which errors of single teeth do nothing


@dataclass(frozen=True)
class Teeth:
    """What an effect of single teeth would be.

    Args:
        numbers: By how many teeth the count of each record is turned, (records,).
        strengths: Of the effect's own parameters, (1,) or (teeth,).
        columns: What each of them changes in all records, (samples, 1) or (samples, teeth).
    """

    numbers: list[int]
    strengths: Tensor
    columns: Tensor


def one_tooth(columns: Tensor, residual: Tensor, records: int) -> Teeth:
    """One tooth that differs, with one strength for all records that is not negative.

    Args:
        columns: What the tooth would change if it were number k of record r, (samples, teeth * records).
        residual: What is to be explained, (samples,).
        records: How many.
    """
    parts, pull = _apart(columns, residual, records)
    gram = (columns.T @ columns).unflatten(1, (-1, records)).unflatten(0, (-1, records))
    each = torch.arange(records)
    sizes = gram.diagonal(dim1=0, dim2=2).diagonal(dim1=0, dim2=1)  # (teeth, records)
    found = _taken(pull, sizes).argmax(0)
    for _ in range(PASSES):
        for record in range(records):
            others = each[each != record]
            among = gram[found[others], others][:, found[others], others]
            own_pull = pull[:, record] + pull[found[others], others].sum()
            of_others = gram[:, record][:, found[others], others].sum(1)
            found[record] = _taken(own_pull, sizes[:, record] + 2 * of_others + among.sum()).argmax()
    column = parts[:, found, each].sum(1, keepdim=True)
    strength = (column[:, 0] @ residual / column.square().sum().clamp(min=1e-300)).clamp(min=0)
    return Teeth(found.tolist(), strength.reshape(1), column)


def every_tooth(columns: Tensor, residual: Tensor, records: int) -> Teeth:
    """An error of every tooth, the same in all records but for the number of the tooth at which each begins.

    Arguments as in `one_tooth`. Records are joined one after another, the one that says most first.
    """
    parts, pull = _apart(columns, residual, records)
    own = torch.stack([parts[:, :, r].T @ parts[:, :, r] for r in range(records)])
    order = own.diagonal(dim1=1, dim2=2).sum(1).argsort(descending=True).tolist()
    turns = {order[0]: 0}
    for record in [*order[1:], *(PASSES * order[1:])]:
        total, wanted = _joined(own, pull, {r: turn for r, turn in turns.items() if r != record})
        tried = [_explained(total, wanted, own[record], pull[:, record], turn) for turn in range(len(pull))]
        turns[record] = max(range(len(tried)), key=tried.__getitem__)
    turned = [parts[:, :, r].roll(turns[r], 1) for r in range(records)]
    column = torch.stack(turned).sum(0)
    return Teeth([turns[r] for r in range(records)], _solved(column.T @ column, column.T @ residual), column)


def _apart(columns: Tensor, residual: Tensor, records: int) -> tuple[Tensor, Tensor]:
    """The columns by record, (samples, teeth, records), and what each has in common with the residual."""
    return columns.unflatten(1, (-1, records)), (columns.T @ residual).unflatten(0, (-1, records))


def _taken(pull: Tensor, size: Tensor) -> Tensor:
    """What a column with a strength that is not negative takes."""
    return pull.clamp(min=0).square() / size.clamp(min=1e-300)


def _joined(own: Tensor, pull: Tensor, turns: dict[int, int]) -> tuple[Tensor, Tensor]:
    total = sum(own[r].roll((turn, turn), (0, 1)) for r, turn in turns.items())
    return total, sum(pull[:, r].roll(turn) for r, turn in turns.items())


def _explained(total: Tensor, wanted: Tensor, own: Tensor, pull: Tensor, turn: int) -> float:
    wanted = wanted + pull.roll(turn)
    return float(wanted @ _solved(total + own.roll((turn, turn), (0, 1)), wanted))


def _solved(gram: Tensor, pull: Tensor) -> Tensor:
    ridge = RIDGE * gram.diagonal().max().clamp(min=1e-300)
    return torch.linalg.solve(gram + ridge * torch.eye(len(pull), dtype=gram.dtype), pull)
