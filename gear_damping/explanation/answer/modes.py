"""The two modes that a cause makes of one, as a free swing or a resonance shows them."""

import numpy as np
import torch
from numpy.typing import NDArray

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.covariance import covariance_of
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.two_modes import OF_TWO, figures
from gear_damping.explanation.state import State
from gear_damping.identification.output_error.uncertainty import QUANTILE

STEP = 1e-4  # of a coordinate, most of which are logarithms: over it modes are linear, whatever its deviation is


def modes_of(state: State) -> list[str]:
    """A sentence for each cause that makes two modes of one: their frequencies and damping ratios."""
    named = [cause.name for cause in state.accepted if cause.effect.cause.modes is not None]
    said = [_said(state.outcome, name, state.bench.evidence) for name in named]
    return [one for one in said if one]


def _said(outcome: Outcome, name: str, evidence: Evidence) -> str:
    found = figures(outcome, name, outcome.values)
    if len(found) < OF_TWO:
        return ""
    half = QUANTILE * _deviations(outcome, name, evidence)
    if not np.isfinite(half).all():
        return ""
    modes = [
        f"{f:.5g} Hz ({f - df:.5g} … {f + df:.5g}) with {z:.3g} % ({max(z - dz, 0.0):.3g} … {z + dz:.3g}) of damping"
        for f, z, df, dz in ((found[i], found[i + 1], half[i], half[i + 1]) for i in (0, 2))
    ]
    return f"The two modes lie at {modes[0]} and at {modes[1]}."


def _deviations(outcome: Outcome, name: str, evidence: Evidence) -> NDArray[np.float64]:
    """Standard deviations of the figures, (4,), by how they change along the fitted coordinates."""
    covariance, shared = covariance_of(outcome, evidence).numpy(), outcome.fitted.shared

    def at(place: int, way: int) -> NDArray[np.float64]:
        aside = shared + way * STEP * torch.eye(len(shared), dtype=shared.dtype)[place]
        return figures(outcome, name, {key: float(v) for key, v in outcome.problem.unknowns.parameters(aside).items()})

    ends = [(at(place, 1), at(place, -1)) for place in range(len(shared))]
    if any(len(one) < OF_TWO for both in ends for one in both):  # one hardly swings
        return np.full(OF_TWO, np.inf)
    slope = np.stack([(more - less) / (2 * STEP) for more, less in ends], 1)
    return np.sqrt(np.einsum("fi,ij,fj->f", slope, covariance, slope))
