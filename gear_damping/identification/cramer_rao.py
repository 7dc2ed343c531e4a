"""The Cramer-Rao bound: how well anybody could know a parameter from a record behind white noise.

With the sensitivities J of the response and what is known beforehand, the covariance of any unbiased estimate is at
least (J'J / noise^2 + P)^-1 (van Trees 1968, part I, 2.4; P: of the prior). The displacement and the velocity at the
start are always unknown.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf

import torch
from torch import Tensor

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.physics.damping_ratio import DAMPING_RATIO
from gear_damping.simulation.driven import Driven
from gear_damping.simulation.runs import Runs
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

START = ("initial_displacement", "initial_velocity")
STEP = 1e-5  # of what counts as a step of order one, on either side
LEAST_SHARE = 1e-8  # of a slope, that others do not have: two that are one by theory differ by 6e-11 in differences
SMALLEST = 1e-300  # of a scale that is divided by, in its own unit: one of 0 stays finite


@dataclass(frozen=True)
class Bound:
    """The smallest standard deviations, run by run.

    Args:
        names: What is unknown, in order; the start of the runs at the end.
        covariance: (batch, n, n), in the units of the parameters; a damping ratio in %.
    """

    names: tuple[str, ...]
    covariance: Tensor

    def deviation(self, name: str) -> Tensor:
        """Smallest standard deviation of one of them, (batch,)."""
        place = self.names.index(name)
        return self.covariance[:, place, place].sqrt()


def cramer_rao(
    runs: Runs,
    free: Sequence[str],
    noise: Tensor,
    *,
    expected: Mapping[str, float] | None = None,
    samples: int | None = None,
    solver: Solver | None = None,
) -> Bound:
    """The bound for each of several runs.

    Args:
        runs: Simulated with the values that are true.
        free: Flat names of what is unknown beside the start; `damping_ratio` is that of the one damping law, in %.
        noise: Standard deviation of white noise on every sample of the response, (batch,) or one.
        expected: Standard deviations of what is known beforehand, by name, those of the start included.
        samples: Of the record that are used, from its beginning; all where absent.
        solver: Settings of the solver, those of the runs.

    Raises:
        InputError: a name is unknown or there twice, there is not one damping law, no positive noise, or the response
            does not depend on something that nothing is known of.
    """
    names, used = (*free, *START), runs.response.shape[-1] if samples is None else samples
    flat = [*(_flat(runs, name) for name in free), *START]
    _refuse(runs, noise, names, flat, expected or {}, used)
    columns = torch.stack([_sensitivity(runs, one, used, solver) for one in flat], -1)
    _refuse_unseen(columns, free, expected or {})
    for place, name in enumerate(names):
        if name == DAMPING_RATIO:  # the ratio grows with the coefficient
            columns[..., place] *= (runs.values[flat[place]] / runs.stated_ratio_percent).unsqueeze(-1)
    level = torch.as_tensor(noise, dtype=torch.float64).expand(len(columns))
    prior = torch.tensor([(expected or {}).get(name, inf) for name in names], dtype=torch.float64)
    return Bound(names, covariance(columns / level[:, None, None], prior**-1))


def _refuse(
    runs: Runs, noise: Tensor, names: Sequence[str], flat: Sequence[str], expected: Mapping[str, float], used: int
) -> None:
    """Refuse what has no bound.

    Raises:
        InputError: everything that is wrong.
    """
    level, longest = torch.as_tensor(noise), runs.response.shape[-1]
    strange = [name for name in expected if name not in names]
    found = [Problem("expected", "is not among what is unknown", name, nearest(name, names)) for name in strange]
    found += [Problem(f"expected.{n}", "must be positive", v) for n, v in expected.items() if not v > 0]
    if not bool((level > 0).all()):
        found.append(Problem("noise", "must be positive", level.tolist(), "without noise there is no bound"))
    if not 2 <= used <= longest:
        remedy = "simulate longer runs" if used > longest else "leave it out for all of them"
        found.append(Problem("samples", f"must lie within 2 and {longest}", used, remedy))
    if len(set(flat)) < len(flat):
        found.append(Problem("free", "names one parameter twice", list(names[: -len(START)]), "name it once"))
    found += [
        Problem("free", "is 0 in a run, where no ratio follows it", name, "give it a value")
        for name, one in zip(names, flat, strict=True)
        if name == DAMPING_RATIO and not bool((runs.values[one] != 0).all())
    ]
    if found:
        raise InputError(found)


def _refuse_unseen(columns: Tensor, free: Sequence[str], expected: Mapping[str, float]) -> None:
    """Refuse what the response of a run does not depend on, which no record of it tells.

    Args:
        columns: Slopes of the response, (batch, time, n), those by what is free first.
        free: What is free, in order.
        expected: What is known beforehand.

    Raises:
        InputError: names all of it.
    """
    seen = (columns != 0).any(1).all(0).tolist()
    unseen = [name for name, one in zip(free, seen, strict=False) if not one and name not in expected]
    rule, remedy = "does not act on the response of a run, so that no record tells it", "leave it out"
    found = [Problem("free", rule, name, remedy) for name in unseen]
    if found:
        raise InputError(found)


def _flat(runs: Runs, name: str) -> str:
    """The parameter of the model that a name stands for."""
    declared = runs.model.parameters()
    if name in declared and not declared[name].vector and name not in START:
        return name
    if name == DAMPING_RATIO:
        count = len(runs.model.damping_laws)
        if count != 1:
            raise InputError(Problem("free", f"the model has {count} damping laws", name, "name their coefficients"))
        return runs.model.damping_coefficient
    known = [one for one, parameter in declared.items() if not parameter.vector and one not in START]
    raise InputError(Problem("free", "no such parameter of the model", name, nearest(name, [*known, DAMPING_RATIO])))


def _sensitivity(runs: Runs, name: str, samples: int, solver: Solver | None) -> Tensor:
    """Slope of the response by one parameter, (batch, time), by central differences."""
    value = runs.values[name]
    scale = _start_scale(runs, name) if name in START else torch.where(value != 0, value.abs(), 1.0)
    moved = []
    for side in (1, -1):
        values = {**runs.values, name: value + side * STEP * scale}
        inputs = Driven({n: series[:, :samples] for n, series in runs.inputs.items()})
        again = simulate(
            runs.model, values, sampling_rate=runs.sampling_rate, n_samples=samples, inputs=inputs, solver=solver
        )
        moved.append(again.response)
    return (moved[0] - moved[1]) / (2 * STEP * scale).unsqueeze(-1)


def _start_scale(runs: Runs, name: str) -> Tensor:
    state = "displacement" if name == START[0] else "velocity"
    return runs.states[state].std(-1).clamp(min=SMALLEST)


def covariance(columns: Tensor, known: Tensor) -> Tensor:
    """Inverse of the information of slopes whose units differ; the variance of what they do not tell is infinite.

    By an orthogonal factor, which keeps what the product of the slopes squares away: of two columns that are one but
    for rounding their inverse holds anything.

    Args:
        columns: Slopes over the noise, (batch, time, n).
        known: Of each unknown, one over how well it is known beforehand, (n,).
    """
    rows = torch.cat([columns, torch.diag(known).expand(len(columns), -1, -1)], 1)
    size = rows.norm(dim=1).clamp(min=SMALLEST)
    factor = torch.linalg.qr(rows / size.unsqueeze(1), mode="r").R
    one = torch.eye(len(known), dtype=columns.dtype).expand_as(factor)
    inverse = torch.linalg.solve_triangular(factor, one, upper=True)
    found = inverse @ inverse.mT
    variances = found.diagonal(dim1=-2, dim2=-1)
    told = variances * LEAST_SHARE**2 < 1  # false of what is nan, too
    variances[~told] = inf
    return found / (size.unsqueeze(-1) * size.unsqueeze(-2))
