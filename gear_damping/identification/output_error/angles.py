"""Where the angles of single records begin: tried all around, record by record."""

from collections.abc import Mapping, Sequence
from math import ceil, inf, pi

import torch
from torch import Tensor

from gear_damping.identification.output_error.normal_equations import nuisance_basis, project_out
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import SEPARATOR, FitRecord
from gear_damping.identification.output_error.unknowns import is_of_model
from gear_damping.physics.model import Model

MESH_PHASE, SPEED = "mesh_phase", "pinion_speed"
TURNED, LIKELY = 0.25, 2.0  # of a cycle that a harmonic may turn away; standard deviations of the speed that do so
PER_HARMONIC, MOST_STARTS = 4.0, 120  # angles for each harmonic up to the natural frequency
MOST_SAMPLES = 1_000_000  # that are predicted at once: the sensitivities of all starts would be large
STARTS = 18  # angles that are tried where a parameter asks for no more, 20 degrees apart


def angle_bases(problem: OutputErrorProblem) -> list[str]:
    """Names of the angles that single records have of their own."""
    bases = (p.name.partition(SEPARATOR) for p in problem.free[problem.unknowns.n_common :])
    return list(dict.fromkeys(base for base, _, _ in bases if base.endswith("phase")))


def scanned(
    problem: OutputErrorProblem,
    shared: Tensor,
    horizon: float | None = None,
    bases: Sequence[str] | None = None,
    states: Tensor | None = None,
) -> Mapping[str, float]:
    """The best of several angles of every record, by name; everything else stays.

    Args:
        problem: With angles that are the records' own.
        shared: Coordinates of everything else, (n_shared,).
        horizon: Seconds of each record that are looked at; all where absent.
        bases: Which angles; all of them where absent, one after another.
        states: How the records begin, (records, local); as they themselves show it where absent.
    """
    found: dict[str, float] = {}
    states = problem.first_states() if states is None else states
    for base in angle_bases(problem) if bases is None else bases:
        places = [i for i, p in enumerate(problem.free) if p.name.startswith(base + SEPARATOR)]
        count = max(problem.free[place].places for place in places) or _starts(problem, base)
        around = torch.linspace(0, 2 * pi, count + 1, dtype=torch.float64)[:-1]
        angles = {place: around + _tooth_in_mesh(problem, base, place, shared) for place in places}
        starts = shared.repeat(count, 1)
        for place in places:
            starts[:, place] = torch.tensor([problem.free[place].coordinate(float(a)) for a in angles[place]])
        cost = _costs(problem, starts, places, horizon, states)
        for place in places:
            record = problem.free[place].name.partition(SEPARATOR)[2]
            own = [i for i, one in enumerate(problem.records) if one.record == record]
            best = int(cost[:, own].sum(1).argmin())
            shared = shared.clone()
            shared[place] = starts[best, place]
            found[problem.free[place].name] = float(angles[place][best])
    return found


def _tooth_in_mesh(problem: OutputErrorProblem, base: str, place: int, shared: Tensor) -> float:
    """The angle at which a tooth is in mesh, of an angle that tells teeth apart: as given, and as the mesh stands."""
    parameter = problem.free[place]
    if not parameter.places:
        return 0.0
    record = parameter.name.partition(SEPARATOR)[2]
    mesh = {p.name: i for i, p in enumerate(problem.free)}.get(f"{MESH_PHASE}{SEPARATOR}{record}")
    stands = 0.0 if mesh is None else float(problem.free[mesh].value(shared[mesh]))
    return float(problem.given.get(base, 0.0)) + stands / parameter.places


def _starts(problem: OutputErrorProblem, base: str) -> int:
    """Angles at which a base is tried: of a mesh so many that none of its harmonics up to the resonance is missed."""
    if base != MESH_PHASE:
        return STARTS
    given = {name: value for name, value in problem.given.items() if is_of_model(name)}
    harmonics = harmonics_to_resonance(problem.model, given, problem.records)
    return min(max(STARTS, ceil(PER_HARMONIC * harmonics)), MOST_STARTS)


def steady_horizon(problem: OutputErrorProblem) -> float:
    """Seconds for which the mesh keeps its phase though the speeds of the records are uncertain; inf where none is.

    So long the highest harmonic up to the natural frequency turns away from where it should be by little.
    """
    places = range(problem.unknowns.n_common, problem.n_shared)
    speeds = [p for p in (problem.free[i] for i in places) if p.name.startswith(SPEED + SEPARATOR)]
    uncertain = max((p.deviation for p in speeds if p.deviation < inf), default=0.0)
    if not uncertain:
        return inf
    given = {name: value for name, value in problem.given.items() if is_of_model(name)}
    teeth = float(problem.model.values(1, **given)["n_teeth_pinion"][0])
    highest = max(harmonics_to_resonance(problem.model, given, problem.records), 1.0) * teeth
    return TURNED * 2 * pi / (LIKELY * uncertain * highest)


def harmonics_to_resonance(
    model: Model, given: Mapping[str, float | tuple[float, ...]], records: Sequence[FitRecord]
) -> float:
    """Natural frequency of a gear pair over the mesh frequency of its slowest record."""
    values = model.values(1, **given)
    default = float(values["pinion_speed"][0])
    slowest = min(abs(record.conditions.get("pinion_speed", default)) for record in records)
    mesh = float(values["n_teeth_pinion"][0]) * slowest
    return float(model.prepare(values).derived["natural_frequency"][0]) / max(mesh, 1e-9)


def _costs(
    problem: OutputErrorProblem, starts: Tensor, tried: Sequence[int], horizon: float | None, states: Tensor
) -> Tensor:
    """Sum of squares by start and record, (starts, records), beside what the record's own start and zero can do."""
    own = [i for i in range(problem.unknowns.n_common, problem.n_shared) if i not in set(tried)]
    columns = problem.n_shared + len(problem.local) + 1
    samples = columns * len(problem.records) * problem.response.samples_within(horizon)
    rows = []
    for some in starts.split(max(1, MOST_SAMPLES // samples)):
        prediction = problem.linearise(some, states.expand(len(some), *states.shape), horizon, own)
        residual, sensitivity = prediction.residual, prediction.sensitivity
        nuisance = torch.cat([sensitivity[..., own], sensitivity[..., problem.n_shared :]], -1)
        good = nuisance.isfinite().flatten(1).all(1) & residual.isfinite().flatten(1).all(1)
        nuisance = torch.where(good[:, None, None, None], nuisance, 0.0).flatten(0, 1)
        each = residual.flatten(0, 1).unsqueeze(-1)
        left = project_out(each, nuisance_basis(nuisance, 0)).unflatten(0, residual.shape[:2])
        rows.append(left.squeeze(-1).square().sum(-1).nan_to_num(torch.inf))
    return torch.cat(rows)
