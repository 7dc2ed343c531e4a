"""Step 9b: is it one constant for all? The strength of a cause, record by record.

What really is there has the same size in every record; what stands in for something else changes with the operating
condition. Cochran (1954), Biometrics 10: the statistic Q, with a tolerance for what a law in another form may differ.
"""

from dataclasses import dataclass
from typing import Any

import torch
from scipy.stats import chi2
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.covariance import FEWEST, SILENT, groups_of
from gear_damping.explanation.model.hypothesis import Outcome, time_scale
from gear_damping.explanation.model.own_phases import own_levels
from gear_damping.explanation.statistics.random_effects import between_deviation, statistic
from gear_damping.identification.output_error.normal_equations import nuisance_basis, project_out
from gear_damping.identification.output_error.uncertainty import QUANTILE

SHARE = 0.1  # of what they would have in equal parts
BLOCK_TIMES = 2.0  # characteristic times of a block, over which residuals may be correlated
FEWEST_BLOCKS = 4  # of a record, however long that is: the scores of a single one cancel, as its strength is fitted


@dataclass(frozen=True)
class Homogeneity:
    """Whether a cause has one size.

    Args:
        names: Records (segments where there are few records) that tell of it.
        estimates: Its first strength by each of them, relative to that of all.
        errors: Their standard errors.
        p: Of the test that they are one within the tolerance; None where too few tell of it.
        level: Below which they are not.
    """

    names: tuple[str, ...]
    estimates: tuple[float, ...]
    errors: tuple[float, ...]
    p: float | None
    level: float

    @property
    def testable(self) -> bool:
        """Whether enough records tell of it."""
        return self.p is not None

    @property
    def holds(self) -> bool:
        """Whether it is not refuted."""
        return self.p is None or self.p >= self.level


def homogeneity(outcome: Outcome, cause: str, evidence: Evidence) -> Homogeneity:
    """Estimates of the first strength of a cause by record, every other parameter projected out.

    What says of itself that it differs between records is not one for all.
    """
    if cause in own_levels(outcome):
        return Homogeneity((), (), (), None, evidence.settings.homogeneity_level)
    place = next(i for i, p in enumerate(outcome.problem.free) if p.name.startswith(cause + "."))
    prediction, problem = outcome.linearisation, outcome.problem
    groups, names = groups_of(outcome)
    columns, residual = _orthogonal_columns(
        prediction.sensitivity[0], prediction.residual[0], place, problem.n_shared, torch.tensor(groups)
    )
    energy = columns.square().sum(0)
    kept = (energy > SHARE * energy.sum() / len(names)).nonzero().flatten().tolist()
    strength = _size(outcome, place)
    moves = float(prediction.sensitivity[0, ..., place].norm()) >= SILENT * evidence.noise  # or it is any size
    if len(kept) < FEWEST or not strength or not moves:
        return Homogeneity((), (), (), None, evidence.settings.homogeneity_level)
    shift = torch.linalg.lstsq(columns[:, kept], residual.unsqueeze(1), driver="gelsd").solution[:, 0]
    block = block_of(outcome, evidence)
    left = residual - columns[:, kept] @ shift  # a size that differs between records is no noise
    errors = torch.stack([error_of(columns[:, k], left, block) for k in kept])
    estimates, errors = 1 + shift / strength, errors / abs(strength)
    found = tuple(estimates.tolist()), tuple(errors.tolist())
    p = float(chi2.sf(statistic(*found, evidence.settings.homogeneity_tolerance), len(kept) - 1))
    return Homogeneity(tuple(names[k] for k in kept), *found, p, evidence.settings.homogeneity_level)


def by_record(outcome: Outcome, cause: str, evidence: Evidence) -> dict[str, Any]:
    """The same as plain values: the first strength by record with 95 % intervals, and how much it differs."""
    test = homogeneity(outcome, cause, evidence)
    parameter = next(p for p in outcome.problem.free if p.name.startswith(cause + "."))
    name, ends = parameter.name, (-QUANTILE, QUANTILE)
    size, known = outcome.values[name], outcome.hypothesis.model.parameters()[parameter.declared_name]

    def within(value: float) -> float:
        return min(max(value, known.lower), known.upper)

    rows = [
        {"record": r, "value": within(size * one), "interval95": sorted(within(size * (one + e * error)) for e in ends)}
        for r, one, error in zip(test.names, test.estimates, test.errors, strict=True)
    ]
    deviation = between_deviation(test.estimates, test.errors) if test.testable else None
    return {
        "per_record": rows,
        "homogeneous": {
            "parameter": name,
            "tau_percent": deviation and 100 * deviation.value,
            "interval95": deviation and [100 * end for end in deviation.interval95],
            "p": test.p,
            "tolerance": evidence.settings.homogeneity_tolerance,
            "level": test.level,
            "testable": test.testable,
        },
    }


def _orthogonal_columns(
    sensitivity: Tensor, residual: Tensor, place: int, n_shared: int, groups: Tensor
) -> tuple[Tensor, Tensor]:
    """Columns of the strength by group (samples, groups) and the residual, every other parameter projected out."""
    count = int(groups.max()) + 1
    own = nuisance_basis(sensitivity, n_shared)
    split = torch.zeros(*sensitivity.shape[:2], count, dtype=torch.float64)
    split[torch.arange(len(groups)), :, groups] = sensitivity[..., place]
    others = [i for i in range(n_shared) if i != place]
    nuisance = project_out(sensitivity[..., others], own).flatten(0, 1)
    basis = torch.linalg.qr(nuisance / nuisance.norm(dim=0).clamp(min=1e-300)).Q
    columns, left = (project_out(s, own).flatten(0, 1) for s in (split, residual.unsqueeze(-1)))
    return columns - basis @ (basis.T @ columns), (left - basis @ (basis.T @ left))[:, 0]


def block_of(outcome: Outcome, evidence: Evidence) -> int:
    """Samples of a block, over which residuals may be correlated."""
    samples = BLOCK_TIMES * time_scale(outcome.hypothesis, evidence) * evidence.sampling_rate
    return max(4, round(min(samples, outcome.problem.response.length / FEWEST_BLOCKS)))


def error_of(column: Tensor, residual: Tensor, block: int) -> Tensor:
    """Standard error of a coefficient whose residuals are correlated within blocks."""
    scores = (column * residual)[: len(column) // block * block].reshape(-1, block).sum(1)
    return scores.square().sum().sqrt() / column.square().sum()


def _size(outcome: Outcome, place: int) -> float:
    """The strength in the coordinate of its parameter, counted from where the effect does nothing."""
    parameter = outcome.problem.free[place]
    if parameter.logarithmic:
        return 1.0
    return outcome.values[parameter.name] / parameter.scale
