"""How the sizes of effects, which are drawn for the usual rig, carry over to another: their dimensions.

`reading` is a reading of the channel: a deflection, or its rate, as the sensor gives it.
"""

from __future__ import annotations

from .effect import Params
from .pair import Rig

DAMPING = {"force": 1, "time": 1, "length": -1}
TORQUE = {"force": 1, "radius": 1}
LENGTH, TIME, RATE, FORCE = {"length": 1}, {"time": 1}, {"time": -1}, {"force": 1}
DIMENSIONS: dict[str, dict[str, dict[str, float]]] = {
    "coulomb_friction": {"force": FORCE},
    "asymmetric_friction": {"force_forward": FORCE, "force_backward": FORCE, "damping_forward": DAMPING,
                            "damping_backward": DAMPING},
    "squeeze_film_damping": {"damping_coefficient": DAMPING, "film_thickness": LENGTH},
    "hunt_crossley_damping": {"damping_coefficient": DAMPING, "reference_deflection": LENGTH},
    "hysteretic_damping": {"yield_deflection": LENGTH},
    "backlash": {"gap": LENGTH},
    "cubic_stiffness": {"coefficient": {"force": 1, "length": -3}},
    "hertz_stiffness": {"reference_deflection": LENGTH},
    "load_dependent_contact": {"reference_load": FORCE}, "tip_relief": {"depth": LENGTH},
    "pinion_eccentricity": {"amplitude": LENGTH}, "gear_eccentricity": {"amplitude": LENGTH},
    "profile_error": {"amplitudes": LENGTH}, "pitch_error": {"values": LENGTH},
    "torque_ripple": {"amplitude": TORQUE},
    "torque_variation": {"sine_amplitude": TORQUE, "ramp_change": TORQUE},
    "windage_drag": {"coefficient": {"force": 1, "radius": 1, "turn": 2}},
    "bearing_flexibility": {"stiffness": {"force": 1, "length": -1}, "mass": {"force": 1, "length": -1, "time": 2}},
    "shaft_torsion": {"stiffness": {"force": 1, "length": -1, "radius": 2},
                      "motor_inertia": {"force": 1, "length": -1, "radius": 2, "time": 2}},
    "encoder_error": {"pinion_amplitude": {"length": 1, "radius": -1}, "gear_amplitude": {"length": 1, "radius": -1}},
    "shaft_angle_error": {"amplitude": {"turn": 1, "time": -1}},
    "sensor_offset": {"offset": {"reading": 1}}, "sensor_drift": {"rate": {"reading": 1}},
    "sensor_saturation": {"limit": {"reading": 1}}, "sensor_quantisation": {"step": {"reading": 1}},
    "sensor_delay": {"delay": TIME}, "sensor_lowpass": {"cutoff": RATE},
    "delayed_feedback": {"delay": TIME}, "belt_order": {"torque": TORQUE},
    "mains_pickup": {"amplitude": {"reading": 1}},
    "impacts": {"force": FORCE, "width": TIME},
    "unbalance": {"unbalance": {"force": 1, "turn": 2}},
}  # fmt: skip


def carried_over(name: str, params: Params, rig: Rig, reading: float) -> Params:
    """The parameters of an effect as they should be on this rig; `reading` per deflection, in time and length."""
    dimensions = dict(DIMENSIONS.get(name, {}))
    if name == "power_law_damping":
        dimensions["coefficient"] = {"force": 1, "time": params["exponent"], "length": -params["exponent"]}
    found = dict(params)
    for key, powers in dimensions.items():
        if key in params:
            factor = reading * rig.scale(length=1) if "reading" in powers else rig.scale(**powers)
            value = params[key]
            found[key] = [entry * factor for entry in value] if isinstance(value, list) else value * factor
    return found
