"""Phases that every record has of its own, where no index says how the shafts stand: probed, scored and started.

A level of each record stands in the place of a phase where what differs between records is a size.
"""

import torch
from torch import Tensor

from gear_damping.explanation.model.candidates import Candidate
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.own_teeth import Teeth, every_tooth, one_tooth
from gear_damping.identification.output_error.angles import MESH_PHASE
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import SEPARATOR


def turn_own_phases(points: Tensor, candidate: Candidate, problem: OutputErrorProblem) -> None:
    """Every second point of a strength whose phases are the records' own: turned by a quarter; of one tooth: by one."""
    single, meshes = len(candidate.strengths) == 1, _mesh_phases(problem, points[0])
    for place, parameter in enumerate(problem.free if candidate.own_tooth else ()):
        if parameter.name.startswith(candidate.own_tooth + SEPARATOR):
            mesh = meshes.get(parameter.name.partition(SEPARATOR)[2], 0.0)
            turned = (parameter.coordinate(_tooth_at(candidate, k * single, mesh)) for k in range(len(points)))
            points[:, place] = torch.tensor(list(turned), dtype=torch.float64)
    for number, phase in enumerate(candidate.own_phases.values()):
        for place, parameter in enumerate(problem.free):
            if not parameter.name.startswith(phase + SEPARATOR):
                continue
            if candidate.own_levels:
                points[number, place] = parameter.coordinate(1.0)
            else:
                points[2 * number, place] = parameter.coordinate(0.0)
                points[2 * number + 1, place] = parameter.coordinate(torch.pi / 2)


def own_levels(outcome: Outcome) -> dict[str, tuple[str, str]]:
    """Flat names of the spread between records and of the level of each, by effect that has them."""
    found = {}
    for effect in outcome.hypothesis.effects:
        if effect.cause and effect.cause.turns_with == "record":
            spread, level = (f"{effect.name}.{parameter.name}" for parameter in effect.parameters)
            found[effect.name] = spread, level
    return found


def reach_of_records(problem: OutputErrorProblem) -> Tensor:
    """(names, records): 1 where a record, or a segment of one, bears a name."""
    of_name = [[float(record.record == name) for record in problem.records] for name in _record_names(problem)]
    return torch.tensor(of_name, dtype=torch.float64)


def start_by_record(
    candidate: Candidate, coefficients: Tensor, problem: OutputErrorProblem, n_free: int
) -> tuple[Tensor, dict[str, float]]:
    """Coordinates of the linearised optimum, and the phase or the level of every record."""
    names, own = _record_names(problem), {}
    start = torch.zeros(n_free, dtype=torch.float64)
    if candidate.own_levels:
        parts = coefficients.unflatten(0, (len(candidate.own_phases), len(names)))
        for (place, level), sizes in zip(candidate.own_phases.items(), parts, strict=True):
            start[place] = sizes.square().mean().sqrt()
            own |= {f"{level}{SEPARATOR}{n}": float(z / start[place]) for n, z in zip(names, sizes, strict=True)}
        return start, own
    parts = coefficients.unflatten(0, (len(candidate.own_phases), 2, len(names)))
    for (place, phase), (cosine, sine) in zip(candidate.own_phases.items(), parts, strict=True):
        start[place] = torch.hypot(cosine, sine).square().mean().sqrt()
        own |= {f"{phase}{SEPARATOR}{n}": float(torch.atan2(s, c)) for n, c, s in zip(names, cosine, sine, strict=True)}
    return start, own


def teeth_of(candidate: Candidate, orthogonal: Tensor, residual: Tensor, problem: OutputErrorProblem) -> Teeth | None:
    """Which tooth is in mesh at the start of each record, for what tells teeth apart where nothing else does."""
    if not candidate.own_tooth:
        return None
    search = one_tooth if len(candidate.strengths) == 1 else every_tooth
    return search(orthogonal, residual, len(_record_names(problem)))


def start_of_teeth(
    candidate: Candidate, teeth: Teeth, problem: OutputErrorProblem, n_free: int, at: Tensor
) -> tuple[Tensor, dict[str, float]]:
    """The same of single teeth, beside what records have of their own at these coordinates, (n_shared,)."""
    meshes = _mesh_phases(problem, at)
    start = torch.zeros(n_free, dtype=torch.float64)
    start[list(candidate.strengths)] = teeth.strengths
    own = {}
    for name, number in zip(_record_names(problem), teeth.numbers, strict=True):
        own[f"{candidate.own_tooth}{SEPARATOR}{name}"] = _tooth_at(candidate, number, meshes.get(name, 0.0))
    return start, own


def _tooth_at(candidate: Candidate, number: int, mesh: float) -> float:
    """The phase of a record at whose start a tooth of this number is in mesh, where the mesh has this phase."""
    return float(candidate.hypothesis.given[candidate.own_tooth]) + (2 * torch.pi * number + mesh) / candidate.teeth


def _mesh_phases(problem: OutputErrorProblem, point: Tensor) -> dict[str, float]:
    """Phases of the mesh by record, (n_shared,), where records have their own."""
    found = {}
    for place, parameter in enumerate(problem.free):
        base, _, record = parameter.name.partition(SEPARATOR)
        if record and base == MESH_PHASE:
            found[record] = float(parameter.value(point[place]))
    return found


def _record_names(problem: OutputErrorProblem) -> list[str]:
    return list(dict.fromkeys(record.record for record in problem.records))
