"""Step 9c: does a cause keep its size beside something that has no name, or does it stand in for that?

The parameter-encompassing test (Mizon & Richard 1986, Econometrica 54): beside a family of forces or lines that by
itself takes more of what the model without the cause leaves, what really is there keeps its size. Where the family
can do most of what the cause does, a law in another form may lose its size too, and the test says nothing. One-sided:
what grows beside the family is no less there.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import hypot

import torch
from scipy.stats import norm
from torch import Tensor

from gear_damping.explanation.answer.homogeneity import block_of, error_of
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.state import Accepted, State
from gear_damping.explanation.statistics.projector import Projector
from gear_damping.explanation.trials.line import strongest_line
from gear_damping.explanation.trials.score import projected
from gear_damping.explanation.trials.unnamed import unnamed_columns

INDEPENDENT = 1e-6  # of the largest singular value: a direction of a family that counts


@dataclass(frozen=True)
class StandIn:
    """A cause in the place of something that has no name.

    Args:
        cause: The cause.
        family: What takes more than it.
        takes: Share that this takes of what the model without the cause leaves.
        cause_takes: Share that the cause takes of it.
        size: Of the cause beside it, relative to that which was found.
    """

    cause: str
    family: str
    takes: float
    cause_takes: float
    size: float

    @property
    def sentence(self) -> str:
        """What is said of it."""
        return (
            f"but {self.family} takes more ({100 * self.takes:.3g} % of the residuals, `{self.cause}` "
            f"{100 * self.cause_takes:.3g} %), and beside it `{self.cause}` has {self.size:.2g} times the size: it "
            "stands in for something that has no name here."
        )


def stand_ins(state: State) -> list[StandIn]:
    """The causes that stand in for something else; none where nothing is visible beside all of them."""
    if state.left is None or not state.left.visible or not state.outcome.is_finite:
        return []
    found = (_stand_in(cause, state) for cause in state.accepted)
    return [one for one in found if one is not None]


def _stand_in(cause: Accepted, state: State) -> StandIn | None:
    """What a cause stands in for; of several families the one that takes most."""
    alone, bench = len(state.accepted) == 1, state.bench
    if not alone and bench.budget.refuses(f"whether {cause.name} stands in for something else"):
        return None
    without = state.nominal if alone else bench.without(state.outcome, cause.name)
    if not without.is_finite:
        return None
    project, left = projected(without)
    added = (without.fitted.prediction.residual - state.outcome.fitted.prediction.residual)[0].reshape(-1, 1)
    residual, change = project(left), project(torch.nn.functional.pad(added, (0, 0, 0, len(project.expected))))
    energy, total = float(change.square().sum()), float(residual.square().sum())
    if energy <= 0:
        return None
    cause_takes = float((change * residual).sum()) ** 2 / energy / total
    settings, found = bench.settings, []
    for name, beside in _families(without, project, state):
        one, other = beside(residual), beside(change)
        takes, share = 1 - float(one.square().sum()) / total, float(other.square().sum()) / energy
        if takes <= cause_takes or share <= INDEPENDENT:
            continue
        size = float((other * one).sum() / other.square().sum())
        column, rest = (signal[: len(added), 0] for signal in (other, one - size * other))
        error = float(error_of(column, rest, block_of(without, bench.evidence)))
        tolerance = settings.homogeneity_tolerance / share**0.5
        if norm.sf((1 - size) / hypot(error, tolerance)) < settings.homogeneity_level:
            found.append(StandIn(cause.name, name, takes, cause_takes, size))
    return max(found, key=lambda one: one.takes, default=None)


def _families(without: Outcome, project: Projector, state: State) -> Iterator[tuple[str, Callable[[Tensor], Tensor]]]:
    """Families without a name, with what each leaves of a signal that is beside the model's parameters already."""
    evidence = state.bench.evidence
    for name, columns in unnamed_columns(without, evidence).items():
        basis = _basis(project(torch.nn.functional.pad(columns, (0, 0, 0, len(project.expected)))))
        yield f"some {name}", lambda signal, basis=basis: signal - basis @ (basis.T @ signal)
    line = strongest_line(without, evidence)
    if line is not None:
        yield line.name, project.beside_own(line.columns)


def _basis(columns: Tensor) -> Tensor:
    """Orthonormal columns that span the same."""
    columns = columns[:, columns.norm(dim=0) > 0]
    basis, sizes, _ = torch.linalg.svd(columns / columns.norm(dim=0), full_matrices=False)
    return basis[:, sizes > INDEPENDENT * sizes.amax()] if len(sizes) else basis
