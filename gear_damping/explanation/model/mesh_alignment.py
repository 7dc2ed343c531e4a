"""How the meshes of records stand to each other, where nothing that was measured says it.

About a constant stiffness the response is linear in the harmonics of the mesh, whatever the sensor shows of it, and a
mesh that stands elsewhere turns each of them by its order. So stiffness and damping are tried on a grid, the harmonics
are a linear regression, and the angles are tried all around, record by record. What the varying stiffness does to its
own response is left out: of the second order.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi

import torch
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.fitting import InitialValues, fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis, Outcome
from gear_damping.explanation.model.nominal_gear_pair import (
    MESH,
    SHAPE,
    first_gear_pair,
    free_harmonics,
    passed_harmonics,
    with_edge,
    with_stiffness,
)
from gear_damping.identification.oscillator.linear_model import DAMPING
from gear_damping.identification.output_error.angles import MESH_PHASE, STARTS
from gear_damping.identification.output_error.least_squares import NONE
from gear_damping.identification.output_error.normal_equations import nuisance_basis, project_out
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import SEPARATOR, FreeParameter
from gear_damping.identification.output_error.segments import in_segments
from gear_damping.physics.effects.mesh_stiffness_shape import MeshStiffnessShape
from gear_damping.simulation.solver_settings import Solver

STIFFNESSES = tuple(1.06**k for k in range(-9, 8))  # of the stated one: 0.6 to 1.5, in steps of 3 % of the frequency
DAMPINGS = (0.5, 1.0, 2.0)  # of the stated one
PER_HARMONIC = 8  # angles for each harmonic: an eighth of its cycle hides none
SWEEPS = 6  # in which angles and harmonics are fitted by turns; they stay after four
KEPT = 3  # sets of angles that are handed on
APART = 0.5  # rad of the mesh by which two sets of angles differ
SOFT = 0.4  # of a mesh period over which a pair takes up its load: no corner then hides where the mesh stands


@dataclass(frozen=True, eq=False)
class Aligned:
    """Where a fit of the whole model may begin.

    Args:
        cost: Sum of squares of what the linear model leaves.
        stiffness: Of the mesh, over the stated one.
        damping: Over the stated one.
        angles: By record, in rad of the mesh; that of one record is 0.
    """

    cost: float
    stiffness: float
    damping: float
    angles: dict[str, float]

    def differs(self, other: "Aligned") -> bool:
        """Whether a mesh stands elsewhere beside the others, however all of them are counted."""
        turned = torch.tensor([self.angles[record] - other.angles[record] for record in self.angles])
        common = torch.angle(torch.exp(1j * turned).sum())
        return bool(torch.angle(torch.exp(1j * (turned - common))).abs().max() > APART)


@dataclass(frozen=True, eq=False)
class Regression:
    """What harmonics x (2 H,) of the mesh leave of a record: c + 2 b x + x A x.

    Args:
        quadratic: A, (records, 2 H, 2 H).
        linear: b, (records, 2 H).
        constant: c, (records,).
        ridge: (2 H,) what is known of the harmonics before, on the diagonal.
    """

    quadratic: Tensor
    linear: Tensor
    constant: Tensor
    ridge: Tensor

    def left_by(self, harmonics: Tensor, record: int) -> Tensor:
        """(n,) what (n, 2 H) harmonics leave of a record."""
        squares = torch.einsum("ni,ij,nj->n", harmonics, self.quadratic[record], harmonics)
        return squares + 2 * harmonics @ self.linear[record] + self.constant[record]

    def solved(self, turns: Sequence[Tensor | None]) -> Tensor:
        """(2 H,) the harmonics that leave least of the records whose mesh is turned by (2 H, 2 H); None has no part."""
        matrix, pull = torch.diag(self.ridge), torch.zeros_like(self.ridge)
        for turn, quadratic, linear in zip(turns, self.quadratic, self.linear, strict=True):
            if turn is not None:
                matrix, pull = matrix + turn.T @ quadratic @ turn, pull + turn.T @ linear
        return -torch.linalg.solve(matrix, pull)


def begun_aligned(evidence: Evidence, cost: float, solver: Solver | None = None) -> list[Outcome]:
    """The ideal wave where it stands best to the records, not fitted, of each likely set of angles.

    Args:
        evidence: Records with angles of their own.
        cost: What a fit of the whole model leaves: where the linear one leaves more, nothing says that it has failed.
        solver: Settings of the solver.
    """
    first = first_gear_pair(evidence)
    return [_placed(first, one, evidence, solver) for one in alignments(first, evidence, solver) if one.cost < cost]


def alignments(first: Hypothesis, evidence: Evidence, solver: Solver | None = None) -> list[Aligned]:
    """The best of each set of angles, the likeliest first; at most `KEPT`."""
    harmonics = free_harmonics(passed_harmonics(first.model, first.given, evidence))
    turns = all_around(len(harmonics) // 2)
    found = []
    for stiffness in STIFFNESSES:
        for damping in DAMPINGS:
            names, told = _regression(_flat(first, stiffness, damping, harmonics), evidence, solver)
            cost, angles = aligned(told, turns)
            found.append(Aligned(cost, stiffness, damping, dict(zip(names, angles, strict=True))))
    kept: list[Aligned] = []
    for one in sorted(found, key=lambda one: one.cost):
        if all(one.differs(other) for other in kept):
            kept.append(one)
    return kept[:KEPT]


def all_around(count: int) -> tuple[Tensor, Tensor]:
    """Angles (n,) of the mesh at which none of its harmonics is missed, and what turns those by each (n, 2 H, 2 H)."""
    angles = torch.linspace(0, 2 * pi, PER_HARMONIC * count + 1, dtype=torch.float64)[:-1]
    return angles, torch.stack([turned(float(angle), count) for angle in angles])


def aligned(told: Regression, around: tuple[Tensor, Tensor]) -> tuple[float, list[float]]:
    """Sum of squares that one set of harmonics leaves of all records, and how far the mesh is turned in each, in rad.

    Begun from the harmonics that each record has for itself. `around` are the angles that are tried.
    """
    angles, turns = around
    records = range(len(told.constant))
    best: tuple[float, list[float]] | None = None
    for lead in records:
        alone: list[Tensor | None] = [turns[0] if record == lead else None for record in records]
        harmonics = told.solved(alone)
        for _ in range(SWEEPS):
            places = [int(told.left_by(turns @ harmonics, record).argmin()) for record in records]
            harmonics = told.solved([turns[place] for place in places])
        left = sum(
            float(told.left_by((turns[place] @ harmonics).unsqueeze(0), record))
            for record, place in zip(records, places, strict=True)
        )
        cost = left + float(told.ridge @ harmonics.square())
        if best is None or cost < best[0]:
            best = cost, [float(angles[place]) for place in places]
    assert best is not None
    return best


def turned(angle: float, count: int) -> Tensor:
    """(2 H, 2 H) what makes a_h cos(h psi) + b_h sin(h psi) of an angle psi the harmonics of psi without `angle`."""
    orders = torch.arange(1, count + 1, dtype=torch.float64) * angle
    cosine, sine = torch.diag(torch.cos(orders)), torch.diag(torch.sin(orders))
    return torch.cat([torch.cat([cosine, sine], 1), torch.cat([-sine, cosine], 1)])


def _flat(first: Hypothesis, stiffness: float, damping: float, harmonics: Sequence[FreeParameter]) -> Hypothesis:
    """A gear pair of constant stiffness, with nothing free but harmonics about it."""
    derived = first.model.prepare(first.model.values(1, **first.given)).derived
    mean = stiffness * float(derived["mean_stiffness"][0])
    zeros = (0.0,) * (len(harmonics) // 2)
    given = first.given | {f"{MESH}.maximum": mean, f"{MESH}.minimum": mean, f"{MESH}.contact_ratio": 2.0}
    given |= {f"{SHAPE}.in_phase": zeros, f"{SHAPE}.quadrature": zeros, DAMPING: damping * first.given[DAMPING]}
    return Hypothesis(first.system, (*first.effects, MeshStiffnessShape()), given, tuple(harmonics))


def _regression(flat: Hypothesis, evidence: Evidence, solver: Solver | None) -> tuple[list[str], Regression]:
    """The names of the records, and what harmonics leave of them beside their beginning and their offsets."""
    records = in_segments(evidence.fit, evidence.segments)
    problem = OutputErrorProblem(flat.model, flat.given, flat.free, records, solver, evidence.noise)
    start = torch.zeros(1, problem.n_shared, dtype=torch.float64)
    prediction = problem.linearise(start, problem.first_states().unsqueeze(0))
    residual, sensitivity = prediction.residual[0], prediction.sensitivity[0]
    offsets = [i for i, parameter in enumerate(problem.free) if parameter.name.startswith("offset")]
    beside = torch.cat([sensitivity[..., offsets], sensitivity[..., problem.n_shared :]], -1)
    basis = nuisance_basis(beside, 0)
    left = project_out(residual.unsqueeze(-1), basis).squeeze(-1)
    columns = project_out(sensitivity[..., : len(flat.free)], basis)
    names = list(dict.fromkeys(record.record for record in problem.records))
    quadratic, linear, constant = (
        torch.stack([part[[r.record == name for r in problem.records]].sum(0) for name in names])
        for part in (
            torch.einsum("rti,rtj->rij", columns, columns),
            torch.einsum("rti,rt->ri", columns, left),
            left.square().sum(-1),
        )
    )
    ridge = torch.tensor([(evidence.noise * p.scale / p.deviation) ** 2 for p in flat.free], dtype=torch.float64)
    return names, Regression(quadratic, linear, constant, ridge)


def _placed(first: Hypothesis, one: Aligned, evidence: Evidence, solver: Solver | None) -> Outcome:
    """The ideal wave with this stiffness, damping and angles, turned in all records to where it leaves least."""
    begun = with_stiffness(with_edge(first, SOFT), one.stiffness)
    damping = one.damping * first.given[DAMPING]
    free = tuple(replace(p, start=damping) if p.name == DAMPING else p for p in begun.free)
    begun = replace(begun, given=begun.given | {DAMPING: damping}, free=free)
    tried = []
    for turn in torch.linspace(0, 2 * pi, STARTS + 1, dtype=torch.float64)[:-1]:
        own = {f"{MESH_PHASE}{SEPARATOR}{record}": angle + float(turn) for record, angle in one.angles.items()}
        tried.append(fit_hypothesis(begun, evidence, InitialValues(own=own), NONE, solver=solver))
    return min(tried, key=lambda outcome: outcome.fitted.cost)
