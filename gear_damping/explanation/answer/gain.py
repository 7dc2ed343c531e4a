"""Step 9: what naming the cause was worth, in residuals and in the damping figure."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import pi

import torch
from torch import Tensor

from gear_damping.explanation.evidence.declared_units import unit_of
from gear_damping.explanation.evidence.excess import ac_energy
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.covariance import FEWEST, SILENT
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.identification.decay_rate import half_width, jackknife_error
from gear_damping.identification.output_error.problem import set_value
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.uncertainty import QUANTILE
from gear_damping.identification.output_error.unknowns import OFFSET, is_of_model
from gear_damping.measurement.vocabulary import GEAR_CHANNELS
from gear_damping.physics.effects.mesh_stiffness_shape import MeshStiffnessShape
from gear_damping.physics.kinematics import Kinematics, Rotation
from gear_damping.physics.model import Model, Prepared
from gear_damping.physics.ratio_by_law import ratio_by_law
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import MeshStiffness
from gear_damping.simulation.runs import reference_velocity

PHASES = 128  # of the mesh: more than the harmonics of wave and shape together, so that the mean is exact
STEP = 1e-4  # of a coordinate, for the slope of the damping ratio


@dataclass(frozen=True)
class Interval:
    """A value with its 95 % interval; not `told` where that is all it may be."""

    value: float
    interval95: tuple[float, float]
    unit: str
    told: bool = True

    def plain(self) -> dict[str, object]:
        """As JSON types."""
        found = {"value": self.value, "unit": self.unit, "interval95": list(self.interval95)}
        return found if self.told else found | {"told": False}


def rmse(residuals: Sequence[Tensor]) -> float:
    """Root mean square over all samples."""
    return (sum(float(r.square().sum()) for r in residuals) / max(sum(len(r) for r in residuals), 1)) ** 0.5


def nrmse(residuals: Sequence[Tensor], records: Sequence[FitRecord]) -> float:
    """Root mean square residual over the standard deviation of the channel within records."""
    energy = sum(ac_energy(record) for record in records)
    return (sum(float(r.square().sum()) for r in residuals) / max(energy, 1e-300)) ** 0.5


def parameters_of(
    outcome: Outcome, covariances: Tensor, cause: str, evidence: Evidence, resting: Collection[tuple[str, int]] = ()
) -> dict[str, dict[str, object]]:
    """The fitted parameters of an effect with 95 % intervals, by own name.

    Those in `resting` may lie at the bound that is named with them, -1 for the lower one and 1 for the upper one.
    Of one that the records say nothing of (a gap whose far flank is never touched) it is its whole range; of one
    that the fit has driven to its bound, it takes in what lies beyond.
    """
    found = {}
    at_bound = outcome.problem.unknowns.at_bound(outcome.fitted.shared)
    for place, parameter in enumerate(outcome.problem.free):
        effect, _, own = parameter.name.partition(".")
        if effect != cause:
            continue
        unit = unit_of(parameter.declared_name, outcome.hypothesis.model, evidence)
        end = int(at_bound[place])
        has_run = end != 0 and (parameter.name, end) not in resting
        found[own] = _interval(outcome, covariances, place, evidence, unit).plain() | {"at_bound": has_run}
    return found


def final_parameters(outcome: Outcome, covariances: Tensor, evidence: Evidence) -> dict[str, dict[str, object]]:
    """Every fitted parameter of a model with its 95 % interval, nuisances and those of single records included."""
    declared, found = outcome.hypothesis.model.parameters(), {}
    for place, parameter in enumerate(outcome.problem.free):
        flat = parameter.declared_name
        kind, _, channel = flat.partition(".")
        if kind == OFFSET:
            unit = unit_of_channel(channel.partition("[")[0], evidence)
        else:
            unit = unit_of(flat, outcome.hypothesis.model, evidence) if flat in declared else "1"
        found[parameter.name] = _interval(outcome, covariances, place, evidence, unit).plain()
    return found


def unit_of_channel(name: str, evidence: Evidence) -> str:
    """The unit that a response channel is kept in."""
    if name == evidence.channel.name:
        return evidence.channel.unit
    return GEAR_CHANNELS.get(name, "own") if evidence.has(Trait.TEETH) else "own"


def _interval(outcome: Outcome, covariances: Tensor, place: int, evidence: Evidence, unit: str) -> Interval:
    """A fitted parameter with its 95 % interval.

    Of one that the records say nothing of it is the whole range; of one that the fit has driven to its bound, it
    takes in what lies beyond; one that is positive and not told from nothing goes down to zero: its logarithm has no
    lower end, and the upper end of the logarithm would be far beyond what the records allow.
    """
    parameter, z = outcome.problem.free[place], outcome.fitted.shared[place]
    value, half = float(parameter.value(z)), QUANTILE * float(covariances[place, place].clamp(min=0).sqrt())
    if parameter.logarithmic and half > 1:
        ends = sorted((0.0, value * (1 + half)))
    else:
        ends = sorted(float(parameter.value(z + shift)) for shift in (-half, half))
    known, told = outcome.hypothesis.model.parameters().get(parameter.declared_name), True
    if known is not None:
        moved = float(outcome.fitted.prediction.sensitivity[..., place].norm())
        at_bound = int(outcome.problem.unknowns.at_bound(outcome.fitted.shared)[place])
        silent = moved < SILENT * evidence.noise and not parameter.logarithmic
        lower = known.lower if silent or at_bound < 0 else ends[0]
        upper = known.upper if silent or at_bound > 0 else ends[1]
        ends = [min(max(lower, known.lower), value), max(min(upper, known.upper), value)]
        told = ends != [known.lower, known.upper]
    return Interval(value, (ends[0], ends[1]), unit, told)


def damping_ratio(outcome: Outcome, covariances: Tensor, moves: Tensor | None = None) -> dict[str, object] | None:
    """The equivalent damping ratio of every damping law together, in % of critical, at its reference velocity.

    Dry friction, hysteresis and what grows with the deflection count with what a harmonic motion of that velocity
    loses to them. None where there is no linear stiffness, or none that is told from nothing: then nothing is
    critical. Laws of damping take energy: the interval ends at zero.

    Args:
        outcome: The model.
        covariances: Of its coordinates, as the noise has it.
        moves: Of the coordinates without one record each, (records, n), where something else than noise is left. That
            acts on every record in its own way, and its scatter between them (the jackknife: Efron & Stein 1981) counts
            where it is the larger one.
    """
    problem, shared = outcome.problem, outcome.fitted.shared
    if _has_no_spring(outcome, covariances):
        return None
    points = shared.repeat(len(shared) + 1, 1)
    points[1:] += STEP * torch.eye(len(shared), dtype=torch.float64)
    by_law, velocity = _by_law(outcome, problem.unknowns.parameters(points), len(points))
    ratios = _summed(by_law, len(points))
    if not bool(ratios.isfinite().all()):
        return None
    slope = (ratios[1:] - ratios[0]) / STEP
    half = QUANTILE * float((slope @ covariances @ slope).clamp(min=0).sqrt())
    if moves is not None and len(moves) >= FEWEST:
        half = max(half, half_width(jackknife_error((moves @ slope).numpy()), len(moves) - 1))
    value = float(ratios[0])
    ends = (max(value - half, min(value, 0.0)), value + half)
    parts = {name: float(each[0]) for name, each in by_law.items() if float(each[0])}
    several = parts if len(parts) > 1 else {}
    return Interval(value, ends, "%").plain() | {"reference_velocity": velocity, "by_law": several}


def _has_no_spring(outcome: Outcome, covariances: Tensor) -> bool:
    """Whether a stiffness that was fitted is not told from nothing."""
    for place, parameter in enumerate(outcome.problem.free):
        if parameter.name == outcome.hypothesis.system.spring:
            half = QUANTILE * float(covariances[place, place].clamp(min=0).sqrt())
            size = 1.0 if parameter.logarithmic else outcome.values[parameter.name] / parameter.scale
            return half > abs(size)
    return False


def damping_ratios(outcome: Outcome, others: Mapping[str, Tensor]) -> list[float]:
    """The equivalent damping ratios in % of critical with other values of some parameters, (batch,) each."""
    batch = len(next(iter(others.values())))
    fitted = {name: torch.full((batch,), value, dtype=torch.float64) for name, value in outcome.values.items()}
    return _summed(_by_law(outcome, fitted | dict(others), batch)[0], batch).tolist()


def _summed(by_law: Mapping[str, Tensor], batch: int) -> Tensor:
    """(batch,) of all laws together."""
    return sum(by_law.values(), torch.zeros(batch, dtype=torch.float64))


def _by_law(outcome: Outcome, free: Mapping[str, Tensor], batch: int) -> tuple[dict[str, Tensor], float]:
    """Damping ratios in % of a batch of points, (batch,) of each law of damping, and the velocity that they are at."""
    model = outcome.hypothesis.model
    values = model.values(batch, **outcome.flat_given())
    for name, value in free.items():
        if is_of_model(name):
            set_value(values, name, value)
    prepared = model.prepare(values)
    speed = reference_velocity(prepared.derived)
    speed = speed[:1].expand(batch)  # the same amplitude for every point
    by_law = ratio_by_law(model, values, prepared, mean_stiffness(model, prepared), speed)
    return {name: 100 * ratio for name, ratio in by_law.items()}, float(speed[0])


def mean_stiffness(model: Model, prepared: Prepared) -> Tensor:
    """Mean over a mesh period in N/m, (batch,), with the calibrated shape of the teeth.

    The harmonics of the shape have no mean, but their product with those of the ideal wave has: some 1 % of the mean.
    """
    plain = prepared.derived["mean_stiffness"]
    shape = next((effect for effect in model.effects if isinstance(effect, MeshStiffnessShape)), None)
    if shape is None:
        return plain
    mesh = next(effect for effect in model.effects if isinstance(effect, MeshStiffness))
    none, sums = torch.zeros_like(plain), torch.zeros(2, len(plain), dtype=plain.dtype)
    for angle in torch.arange(PHASES) * (2 * pi / PHASES):
        at = Kinematics(none, none, none, mesh=Rotation(none + angle, none))
        ideal = mesh.stiffness(at, prepared.terms[mesh.name])
        sums += torch.stack([ideal, ideal * shape.factor(at, prepared.terms[shape.name])])
    return plain * sums[1] / sums[0]
