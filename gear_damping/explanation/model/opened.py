"""Held-out records, opened once: a fitted model on records that took no part in any choice."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import torch
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome, slowest_time
from gear_damping.identification.output_error.angles import MESH_PHASE
from gear_damping.identification.output_error.holdout import Frozen, HeldOut, predict_holdout
from gear_damping.identification.output_error.least_squares import Fitted
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import SEPARATOR, FreeParameter
from gear_damping.simulation.solver_settings import Solver

ASTRAY = 3.0  # times what is left of the fitted records


def opened(
    outcome: Outcome, evidence: Evidence, solver: Solver | None = None, initial: Mapping[str, float] | None = None
) -> Outcome:
    """A model with what it leaves of the held-out records, its parameters frozen.

    Args:
        outcome: The fitted model.
        evidence: The records, those held out among them.
        solver: Settings of the solver.
        initial: Where angles of held-out records begin, by name; they are tried all around where absent.
    """
    settled = outcome.hypothesis
    scale = slowest_time(settled, evidence)
    own = [parameter for parameter in settled.free if parameter.per_record]
    given = {**settled.given, **settled.gains, **_teeth_in_mesh(own, outcome.values)}
    frozen = Frozen(settled.model, given, own, evidence.noise, solver)
    held = predict_holdout(frozen, evidence.holdout, scale, evidence.segments, initial)
    if initial and _is_astray(held.residuals, outcome.fitted, outcome.problem):
        # another model's angles may lie in another valley
        anew = predict_holdout(frozen, evidence.holdout, scale, evidence.segments)
        held = _better_of_each(held, anew, [record.name for record in evidence.holdout])
    return replace(
        outcome,
        holdout=held.residuals,
        own=held.own,
        error_amplification=max(outcome.error_amplification, held.error_amplification),
    )


def _better_of_each(one: HeldOut, other: HeldOut, names: Sequence[str]) -> HeldOut:
    """Of every record the prediction that leaves less: with its parameters frozen a model has no record in common."""
    costs = [[float(left.square().sum()) for left in found.residuals] for found in (one, other)]
    taken = [one if mine <= theirs else other for mine, theirs in zip(*costs, strict=True)]
    from_which = dict(zip(names, taken, strict=True))
    own = {
        name: from_which.get(name.partition(SEPARATOR)[2], one).own.get(name, value)
        for name, value in other.own.items()
    }
    return HeldOut(
        [found.predictions[i] for i, found in enumerate(taken)],
        [found.residuals[i] for i, found in enumerate(taken)],
        max(found.error_amplification for found in taken),
        own,
    )


def _teeth_in_mesh(own: Sequence[FreeParameter], values: Mapping[str, float]) -> dict[str, float]:
    """Where teeth stand to the mesh in fitted records, of every angle that tells teeth apart, by its name.

    A tooth is in mesh once a pitch: as angles of the mesh these are all one.
    """
    found = {}
    for parameter in (one for one in own if one.places):
        start = parameter.name + SEPARATOR
        angles = {n.removeprefix(start): value for n, value in values.items() if n.startswith(start)}
        meshes = [parameter.places * a - values.get(f"{MESH_PHASE}{SEPARATOR}{r}", 0.0) for r, a in angles.items()]
        if meshes:
            turned = torch.exp(1j * torch.tensor(meshes, dtype=torch.float64)).mean()
            found[parameter.name] = float(turned.angle()) / parameter.places
    return found


def _is_astray(held: Sequence[Tensor], fitted: Fitted, problem: OutputErrorProblem) -> bool:
    """Whether held-out records are predicted far worse than fitted ones are followed, per sample."""
    count = sum(int((weights > 0).sum()) for weights in problem.response.weights)
    left = sum(float(residual.square().sum()) for residual in held) / sum(len(residual) for residual in held)
    return left > ASTRAY * fitted.cost / max(count, 1)
