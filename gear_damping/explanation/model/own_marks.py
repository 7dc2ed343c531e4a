"""Held-out records whose angle counts from a mark of their own."""

from collections.abc import Sequence
from dataclasses import replace

from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.opened import ASTRAY, opened
from gear_damping.identification.observation import MESH_PHASE
from gear_damping.physics.systems.traits import Trait
from gear_damping.simulation.solver_settings import Solver

APART = 1.5  # times the cost of a phase for every record: one phase of all leaves that much where there is none; angles
# that begin anywhere agree that well once in a thousand times, for three records


def with_own_marks(evidence: Evidence, outcome: Outcome, solver: Solver | None = None) -> Evidence:
    """The evidence with a mesh phase of its own in held-out records that one phase of all records leads astray.

    Without an index nothing says that angles count from one mark. Those of a few fitted records may do so by chance: a
    toothed wheel of 32 pulses beside 16 teeth begins at one of two phases of the mesh only.

    Args:
        evidence: With its held-out records.
        outcome: The best model of the fitted ones, opened.
        solver: Settings of the solver.
    """
    begins_anywhere = evidence.has(Trait.TEETH) and evidence.has_index and not evidence.mesh_index
    if not begins_anywhere or any(MESH_PHASE in record.own for record in evidence.holdout):
        return evidence
    shared = _mean_squares(outcome.holdout)
    left = ASTRAY * max(evidence.noise**2, max(_mean_squares(outcome.fit_residuals)))
    if max(shared) <= left:
        return evidence
    free = tuple(replace(record, own=(MESH_PHASE, *record.own)) for record in evidence.holdout)
    own = _mean_squares(opened(outcome, replace(evidence, holdout=free), solver).holdout)
    needs = [one > left and one > APART * other for one, other in zip(shared, own, strict=True)]
    if not any(needs):
        return evidence
    chosen = (new if needed else old for new, old, needed in zip(free, evidence.holdout, needs, strict=True))
    return replace(evidence, holdout=tuple(chosen))


def _mean_squares(residuals: Sequence[Tensor]) -> list[float]:
    return [float(one.square().mean()) for one in residuals]
