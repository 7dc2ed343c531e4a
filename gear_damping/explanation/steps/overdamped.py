"""A mesh that came out damped beyond critical: the fit has gone to where nothing swings."""

from gear_damping.explanation.model.near_stated import (
    WITHIN,
    is_held_near_stated,
    is_overdamped,
    mesh_damping_ratio,
)
from gear_damping.explanation.state import State

STIFFNESS, RATIO = (f"{100 * WITHIN[name]:.0f} %" for name in ("mesh_stiffness_max", "damping_ratio"))
HELD = (
    "Fitted freely, the mesh came out damped beyond critical, which none is: it was held near what is stated, the "
    f"stiffness with a standard deviation of {STIFFNESS}, the damping ratio with one of {RATIO}. State them with an "
    "`uncertainty` of your own if you know better."
)


def overdamped(state: State) -> str:
    """A sentence where a mesh was held near what is stated for that, or is beyond critical all the same."""
    evidence = state.bench.evidence
    if is_overdamped(state.outcome, evidence):
        return (
            f"A damping of {100 * mesh_damping_ratio(state.outcome):.3g} % of critical is none of a mesh: the fit has "
            "gone to where nothing swings, and what it says of stiffness and damping is not to be used. State "
            f"mesh_stiffness_max, mesh_stiffness_min and damping_ratio with an `uncertainty` ({STIFFNESS}, and "
            f"{RATIO}), which holds it near them, and ask again."
        )
    return HELD if is_held_near_stated(state.nominal, evidence) else ""
