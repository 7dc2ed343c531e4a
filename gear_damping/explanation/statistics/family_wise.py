"""Is any of many effects visible in residuals? One test over all of them, calibrated by the data themselves.

The score of an effect is the residual on its columns. Under the null the sums over blocks of time have no sign, so
that flipping their signs draws from the null (flip scores: Hemerik, Goeman & Finos 2020; De Santis et al. 2022). Each
score is standardised by its own draws with the cube root of Wilson & Hilferty (1931), and the maximum over all effects
counts (Westfall & Young 1993). A score that lives in few blocks has too few signs to flip: there the chi-squared
distribution with the pooled variance takes their place.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

import torch
from torch import Tensor

DRAWS = 2000  # of signs: a p of .01 then has a standard error of .002
FEWEST_BLOCKS = 13.0  # effective ones, below which signs are too few: 2^13 of them give p down to 1e-4
MOST_CORRECTED = 250  # blocks: with more the leverage of the nuisance within one is negligible


@dataclass(frozen=True)
class Effect:
    """Columns of one effect.

    Args:
        name: What it is called.
        columns: Orthonormal, nuisance projected out, (samples, n).
        one_sided: Whether only a positive coefficient makes sense; n is then 1.
    """

    name: str
    columns: Tensor
    one_sided: bool = False


@dataclass(frozen=True)
class Residual:
    """What is looked at.

    Args:
        values: White, nuisance projected out, (samples,).
        blocks: Number of the block of every sample, (samples,).
        variance: Of one sample.
        nuisance: Orthonormal columns that were projected out, (samples, m); None: none.
    """

    values: Tensor
    blocks: Tensor
    variance: float
    nuisance: Tensor | None = None


@dataclass(frozen=True)
class Lines:
    """Independent squared sums that were not flipped, such as a spectrum's: each is chi-squared under the null.

    Args:
        name: What they are called.
        values: (lines,), in units of the variance of one degree of freedom.
        degrees: Of freedom of each.
    """

    name: str
    values: Tensor
    degrees: float


@dataclass(frozen=True)
class Visible:
    """Outcome of the test.

    Args:
        p: Family-wise probability of so large a maximum under the null.
        statistic: The maximum, in standard deviations of a normal variable.
        limit: Its quantile under the null, beyond which something is visible.
        draws: How many were drawn.
        effective_blocks: Blocks that count, of the effect with the most of them.
        by_name: The statistic of each effect, of its best form.
        level: The chance of that.
    """

    p: float
    statistic: float
    limit: float
    draws: int
    effective_blocks: float
    by_name: dict[str, float]
    level: float = 0.01

    @property
    def largest(self) -> str | None:
        """The effect with the maximum."""
        return max(self.by_name, key=self.by_name.get, default=None)

    def __bool__(self) -> bool:
        return self.p < self.level

    def shows(self, name: str) -> bool:
        """Whether one effect is visible by itself within the family."""
        return self.by_name.get(name, 0.0) > self.limit


def family_wise(
    residual: Residual, effects: Sequence[Effect], lines: Sequence[Lines] = (), draws: int = DRAWS, level: float = 0.01
) -> Visible:
    """Test all effects at once; of what gives no number, as in records of a few samples, nothing is said.

    Args:
        residual: What is looked at.
        effects: What may be in it.
        lines: Further statistics that stand in the same maximum.
        draws: Of signs.
        level: Chance at which anything at all would be called visible under the null.
    """
    blocks, variance, nuisance = residual.blocks, residual.variance, residual.nuisance
    generator = torch.Generator().manual_seed(0)
    count = int(blocks.max()) + 1
    # six digits are enough for what is drawn, and take half the time
    signs = torch.randint(0, 2, (draws, count), generator=generator).float() * 2 - 1
    found, drawn, names, most = [], [], [], 0.0
    for effect in effects:
        if not effect.columns.shape[1]:
            continue
        size, effective = _effective_blocks(effect.columns, blocks, count)
        most = max(most, effective)
        sums = _by_block(effect.columns * residual.values.unsqueeze(1), blocks, count)
        if effective < FEWEST_BLOCKS:
            value = _against_chi_squared(sums.sum(0), variance, effect.one_sided)
            under = torch.randn(draws, generator=generator, dtype=torch.float64)
        else:
            flipped = (signs @ sums.float()).double()
            if nuisance is not None and count <= MOST_CORRECTED:
                flipped = flipped / _leverage(effect.columns, nuisance, blocks, signs, size)
            value, under = _against_draws(sums.sum(0), flipped, effect.one_sided)
        found.append(value)
        drawn.append(under)
        names.append(effect.name)
    for family in lines:
        found.append(float(cube_root(family.values, family.degrees, family.degrees).max()))
        uniform = torch.rand(draws, generator=generator, dtype=torch.float64)
        drawn.append(torch.special.ndtri((uniform ** (1 / len(family.values))).clamp(max=1 - 1e-15)))
        names.append(family.name)
    told = [k for k, value in enumerate(found) if isfinite(value) and bool(drawn[k].isfinite().all())]
    found, drawn, names = ([of[k] for k in told] for of in (found, drawn, names))
    if not found:
        return Visible(1.0, 0.0, 0.0, draws, 0.0, {}, level)
    largest = torch.stack(drawn).amax(0)
    statistic = max(found)
    by_name: dict[str, float] = {}
    for name, value in zip(names, found, strict=True):
        by_name[name] = max(value, by_name.get(name, value))
    p = (1 + int((largest >= statistic).sum())) / (draws + 1)
    return Visible(p, statistic, float(largest.quantile(1 - level)), draws, most, by_name, level)


def block_numbers(rows: Sequence[int], block: Sequence[int]) -> Tensor:
    """Number of the block of every sample of rows one behind another, no block across two rows, (samples,).

    Args:
        rows: Samples of each row.
        block: Samples of a block of each row.
    """
    found, begun = [], 0
    for samples, length in zip(rows, block, strict=True):
        number = torch.arange(samples) // max(1, length)
        last = int(number[-1]) if samples else -1
        if samples and samples % length and samples % length < length / 2 and last:
            number = number.clamp(max=last - 1)  # a short end joins the block before it
        found.append(number + begun)
        begun += int(number[-1]) + 1 if samples else 0
    return torch.cat(found)


def cube_root(values: Tensor, mean: Tensor | float, degrees: Tensor | float) -> Tensor:
    """Wilson and Hilferty: a multiple of chi-squared with this mean and so many degrees as a standard normal."""
    share = 2 / (9 * torch.as_tensor(degrees, dtype=torch.float64))
    return ((values / mean).clamp(min=0) ** (1 / 3) - 1 + share) / share.sqrt()


def _by_block(products: Tensor, blocks: Tensor, count: int) -> Tensor:
    return products.new_zeros(count, products.shape[1]).index_add_(0, blocks, products)


def _effective_blocks(columns: Tensor, blocks: Tensor, count: int) -> tuple[int, float]:
    """Number of columns, and over how many blocks their energy is spread."""
    energy = _by_block(columns.square(), blocks, count).sum(1)
    share = energy / energy.sum().clamp(min=1e-300)
    return columns.shape[1], float(1 / share.square().sum().clamp(min=1e-300))


def _leverage(columns: Tensor, nuisance: Tensor, blocks: Tensor, signs: Tensor, size: int) -> Tensor:
    """What is left of a deviation with the nuisance projected out, (draws, 1): flipped, the two are not orthogonal."""
    count = signs.shape[1]
    taken = torch.zeros(len(signs), dtype=torch.float64)
    for column in columns.unbind(1):
        shares = _by_block(nuisance * column.unsqueeze(1), blocks, count)
        taken += (signs @ shares.float()).double().square().sum(1)
    return (1 - taken / size).clamp(min=0.1).sqrt().unsqueeze(1)


def _against_draws(total: Tensor, flipped: Tensor, one_sided: bool) -> tuple[float, Tensor]:
    if one_sided:
        deviation = flipped[:, 0].square().mean().sqrt().clamp(min=1e-300)
        return float(total[0] / deviation), flipped[:, 0] / deviation
    energy, squares = total.square().sum(), flipped.square().sum(1)
    mean, variance = squares.mean().clamp(min=1e-300), squares.var().clamp(min=1e-300)
    degrees = 2 * mean**2 / variance
    return float(cube_root(energy, mean, degrees)), cube_root(squares, mean, degrees)


def _against_chi_squared(total: Tensor, variance: float, one_sided: bool) -> float:
    if one_sided:
        return float(total[0]) / max(variance, 1e-300) ** 0.5
    degrees = float(len(total))
    return float(cube_root(total.square().sum(), degrees * max(variance, 1e-300), degrees))
