"""A torque that was measured on the other shaft shows in a mesh that comes out stiffer by the ratio of the teeth."""

from math import log

from gear_damping.explanation.answer.gain import nrmse
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.nominal_gear_pair import MESH

LIKE_THE_TEETH = log(1.1)  # between both ratios: a drawing's stiffness is known to some per cent
UNLIKE_ONE = log(1.3)  # of the teeth: nearer to one, the stiffness alone may be wrong by as much
ANGLE = "A transmission error in an angle, as arcsec, that is the other shaft's shows so too: check its `shaft`."
MISSED = 0.05  # of the variance: a right torque beside a wrong stiffness is followed better


def torque_of_the_other_shaft(outcome: Outcome, evidence: Evidence) -> str:
    """A sentence where `pinion_torque` may be the gear's, empty elsewhere.

    The static deflection is torque over stiffness, and the natural frequency knows the stiffness alone: with a torque
    that is too large by the ratio of the teeth the mesh comes out stiffer by as much, and little is followed.
    """
    stated, found = evidence.parameters.get("mesh_stiffness_max"), outcome.values.get(f"{MESH}.maximum", 0.0)
    teeth = [evidence.parameters.get(f"n_teeth_{shaft}") for shaft in ("pinion", "gear")]
    if not stated or found <= 0 or not all(teeth):
        return ""
    stiffer, ratio = found / stated, teeth[1] / teeth[0]
    if abs(log(ratio)) < UNLIKE_ONE or abs(log(stiffer / ratio)) > LIKE_THE_TEETH:
        return ""
    if nrmse(outcome.fit_residuals, evidence.fitted) ** 2 < MISSED:
        return ""
    said = (
        f"mesh_stiffness_max comes out at {found:.3g} N/m, {stiffer:.3g} times what is stated, and the gear has "
        f"{ratio:.3g} times the teeth of the pinion: if pinion_torque is the torque on the gear's shaft, give it times "
        f"{teeth[0]:g}/{teeth[1]:g}."
    )
    return f"{said} {ANGLE}" if evidence.channel.name == "transmission_error" else said
