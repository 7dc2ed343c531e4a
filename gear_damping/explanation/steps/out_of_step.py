"""Records in which a simulation loses the mesh phase are named, with what would keep it in step."""

from gear_damping.explanation.evidence.excess import ac_energy
from gear_damping.explanation.state import State
from gear_damping.physics.systems.traits import Trait


def out_of_step(state: State) -> str:
    """A sentence where the model misses most of records that turn and whose shaft angle nobody recorded, else nothing.

    Shafts that turn unevenly by a part of a tooth take the mesh phase with them: no model at a steady speed follows.

    Args:
        state: Where the search ended.
    """
    evidence = state.bench.evidence
    if not evidence.has(Trait.SHAFTS):
        return ""
    lost = [
        record.name
        for record, residual in zip(evidence.fitted, state.outcome.fit_residuals, strict=True)
        if record.conditions.get("pinion_speed")
        and "pinion_angle" not in record.inputs
        and float(residual.square().sum()) > evidence.settings.lost_share * ac_energy(record)
    ]
    if not lost:
        return ""
    return (
        f"The simulation misses most of {', '.join(lost)}: where shafts turn unevenly it loses the mesh phase. Record "
        "the angle of a shaft (channel `pinion_angle`, or an encoder), which it then follows."
    )
