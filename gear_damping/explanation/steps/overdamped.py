"""A mesh that came out damped beyond critical: the fit has gone to where nothing swings."""

from math import pi

from gear_damping.explanation.model.hypothesis import Outcome, natural_frequency_hz
from gear_damping.explanation.state import State
from gear_damping.identification.oscillator.linear_model import DAMPING
from gear_damping.physics.systems.traits import Trait

CRITICAL = 1.0  # no mesh comes near it: lubricated steel has a hundredth to a tenth


def overdamped(state: State) -> str:
    """A sentence where the viscous damping of a mesh is beyond critical, else nothing.

    Where most of what the records hold is not in the model, and slow, a stiff and dead one follows them best: what is
    stated without an uncertainty is where the fit begins, and does not hold it.
    """
    if not state.bench.evidence.has(Trait.TEETH):
        return ""
    ratio = _damping_ratio(state.outcome)
    if ratio <= CRITICAL:
        return ""
    return (
        f"A damping of {100 * ratio:.3g} % of critical is none of a mesh: the fit has gone to where nothing swings, "
        "and what it says of stiffness and damping is not to be used. State mesh_stiffness_max, mesh_stiffness_min and "
        "damping_ratio with an `uncertainty` (10 %, and 50 %), which holds it near them, and ask again."
    )


def _damping_ratio(outcome: Outcome) -> float:
    """Of the small motion of the model, by its viscous law."""
    given, model = outcome.flat_given(), outcome.hypothesis.model
    frequency = natural_frequency_hz(model, given)
    mass = float(model.prepare(model.values(1, **given)).derived["equivalent_mass"][0])
    return float(given.get(DAMPING, 0.0)) / mass / (4 * pi * frequency) if frequency > 0 else 0.0
