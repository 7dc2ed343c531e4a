"""What two models of one effect share whatever their form: energy per cycle, force at a rate, lost stiffness."""

from __future__ import annotations

import numpy as np

from .contact import YIELD_RATIOS, damping_laws
from .effect import Effect, Params
from .effects_geometry import crack_area
from .knobs import Knobs, stack
from .stiffness import Arrays, mean_stiffness

AMPLITUDES = (0.5e-6, 1e-6, 2e-6, 4e-6)  # m, of the deflection about its static value
DAMPERS = ("power_law_damping", "coulomb_friction", "asymmetric_friction", "hunt_crossley_damping")


def invariants(effect: Effect, params: Params, record: Knobs, rms_rate: float) -> dict[str, object]:
    """JSON-able; energies / J are of cycles at the natural frequency about the static deflection of `record`.

    rms_rate: of the deflection in the case's records / (m/s), where the force of a damper is stated.
    """
    if effect.name == "tooth_crack":
        area = crack_area(record["teeth_2" if params.get("shaft") == "gear" else "teeth_1"])
        return {"stiffness_loss_area": params["depth"] * area * record["contact_ratio"]}
    if effect.name not in (*DAMPERS, "hysteretic_damping"):
        return {}
    knobs = stack([{**record, **effect.turn(params, record), "viscous": 0.0}])
    static = float(knobs["torque"][0] / knobs["radius_1"][0] / mean_stiffness(knobs)[0])
    rate = float(np.sqrt(mean_stiffness(knobs) / knobs["mass"])[0])
    found: dict[str, object] = {"amplitudes": list(AMPLITUDES), "static_deflection": static, "angular_rate": rate}
    if effect.name == "hysteretic_damping":
        return found | {"energies_per_cycle": [hysteretic_loss(knobs, a) for a in AMPLITUDES]}
    found["energies_per_cycle"] = [memoryless_loss(knobs, static, a, rate) for a in AMPLITUDES]
    return found | {"rms_rate": rms_rate, "force_at_rms_rate": float(_force(knobs, static, rms_rate)[0])}


def _force(knobs: Arrays, deflection, rate) -> np.ndarray:
    return sum(law(knobs, np.asarray(deflection), np.asarray(rate)) for law in damping_laws(knobs))


def memoryless_loss(knobs: Arrays, static: float, amplitude: float, angular_rate: float) -> float:
    """Energy / J that the damping laws take from one harmonic cycle."""
    turn = np.linspace(0.0, 2.0 * np.pi, 4096, endpoint=False)
    speed = -amplitude * angular_rate * np.sin(turn)
    force = _force(knobs, static + amplitude * np.cos(turn), speed)
    return float(np.mean(force * speed) * 2.0 * np.pi / angular_rate)


def hysteretic_loss(knobs: Arrays, amplitude: float) -> float:
    """Energy / J of one cycle of the three elements z' = delta' - |delta'| z / z_y; exact."""
    limit = float(knobs["yield"][0]) * YIELD_RATIOS[:, 0]
    reached = limit * np.tanh(amplitude / limit)
    branch = 2.0 * amplitude * limit - limit * (limit + reached) * (1.0 - np.exp(-2.0 * amplitude / limit))
    return float(knobs["hysteresis"][0] * np.mean(2.0 * branch))
