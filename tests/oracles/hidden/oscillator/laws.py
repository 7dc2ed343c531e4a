"""What can be hidden in an oscillator: forces, and faults of its sensor, with their truth in the rig's own units."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

Params = dict[str, float]
# what a member can contain, with the value at which it is absent; natural units
NEUTRAL: dict[str, float] = {
    "zeta": 0.01, "cubic": 0.0, "quadratic": 0.0, "bend": 0.0, "dry": 0.0, "dry_width": 1.0,
    "forward": 0.0, "backward": 0.0, "viscous_forward": 0.0, "viscous_backward": 0.0, "one_way_width": 1.0,
    "power": 0.0, "power_n": 1.0, "rounding": 1e-3, "hysteresis": 0.0, "yield": 1.0, "contact": 0.0, "contact_p": 1.0,
    "delay": 0.0, "lowpass": np.inf, "limit": np.inf, "drift": 0.0,
}  # fmt: skip
YIELD_RATIOS = np.array([0.5, 1.0, 1.6])[:, None]  # yields of the three hysteretic elements over their nominal value


@dataclass(frozen=True)
class Scales:
    """One natural unit in the unit of the rig: displacement, angular frequency / (rad/s), reading of the channel."""

    amplitude: float
    rate: float
    reading: float


@dataclass(frozen=True)
class Law:
    """An effect. draw: parameters, natural, at their largest; sizes: powers with which they shrink; knobs: of a member.

    own: the parameters by the names and in the units that the truth states. units: those of the channel it needs.
    """

    name: str
    draw: Callable[[np.random.Generator], Params]
    sizes: Mapping[str, float]
    knobs: Callable[[Params], Params]
    own: Callable[[Params, Scales], Params]
    least: float = 1e-2
    units: tuple[str, ...] = ()

    def at(self, params: Params, size: float) -> Params:
        """The parameters at a size of at most 1."""
        return {name: value * size ** self.sizes.get(name, 0.0) for name, value in params.items()}


def restoring(p: Params, u: np.ndarray) -> np.ndarray:
    """Of the spring: linear, or a pendulum's, with what bends it."""
    bent = np.where(p["bend"] > 0.0, p["bend"], 1.0)
    spring = np.where(p["bend"] > 0.0, np.sin(bent * u) / bent, u)
    return spring + p["quadratic"] * u * u + p["cubic"] * u * u * u


def damping(p: Params, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Viscous, dry rounded by a hyperbola, one-way friction along an arc tangent, a power of the rate, of the depth."""
    total = 2.0 * p["zeta"] * v + p["dry"] * v / np.sqrt(v * v + p["dry_width"] ** 2)
    share = 0.5 + np.arctan(v / p["one_way_width"]) / np.pi
    total = total + (p["forward"] + p["viscous_forward"] * v) * share
    total = total - (p["backward"] - p["viscous_backward"] * v) * (1.0 - share)
    total = total + p["power"] * v * (v * v + p["rounding"] ** 2) ** (0.5 * (p["power_n"] - 1.0))
    return total + p["contact"] * np.abs(u) ** p["contact_p"] * v


def _power(rng) -> Params:
    n = float(rng.uniform(0.5, 0.7) if rng.random() < 0.3 else rng.uniform(1.7, 3.0))
    return {"coefficient": 0.4, "exponent": n}


def _one_way(rng) -> Params:
    weak = float(rng.uniform(0.1, 0.4))
    force = (0.2, 0.2 * weak) if rng.random() < 0.5 else (0.2 * weak, 0.2)
    return {"force_forward": force[0], "force_backward": force[1], "width": float(rng.uniform(0.01, 0.03))}


def _sign(rng) -> float:
    return 1.0 if rng.random() < 0.5 else -1.0


def _named(name: str, draw, sizes, knobs, own, least=1e-2, units=()) -> tuple[str, Law]:
    return name, Law(name, draw, sizes, knobs, own, least, units)


OSCILLATOR_EFFECTS: dict[str, Law] = dict((
    _named("coulomb_friction", lambda rng: {"force": 0.2, "width": float(rng.uniform(0.01, 0.03))}, {"force": 1},
           lambda p: {"dry": p["force"], "dry_width": p["width"]},
           lambda p, s: {"force": p["force"] * s.amplitude * s.rate**2}),
    _named("asymmetric_friction", _one_way, {"force_forward": 1, "force_backward": 1},
           lambda p: {"forward": p["force_forward"], "backward": p["force_backward"], "one_way_width": p["width"]},
           lambda p, s: {name: p[name] * s.amplitude * s.rate**2 for name in ("force_forward", "force_backward")}),
    _named("power_law_damping", _power, {"coefficient": 1},
           lambda p: {"power": p["coefficient"], "power_n": p["exponent"],
                      "rounding": 0.02 if p["exponent"] < 1.0 else 1e-3},
           lambda p, s: {"coefficient": p["coefficient"] * s.amplitude * s.rate**2 / (s.amplitude * s.rate) **
                         p["exponent"], "exponent": p["exponent"]}),
    _named("hunt_crossley_damping",
           lambda rng: {"damping_coefficient": 0.6, "exponent": float(rng.uniform(0.8, 1.5))},
           {"damping_coefficient": 1},
           lambda p: {"contact": p["damping_coefficient"], "contact_p": p["exponent"]},
           lambda p, s: {"damping_coefficient": p["damping_coefficient"] * s.rate, "exponent": p["exponent"],
                         "reference_deflection": s.amplitude}),
    _named("hysteretic_damping", lambda rng: {"share": 0.8, "yield_deflection": float(rng.uniform(0.1, 0.25))},
           {"share": 1}, lambda p: {"hysteresis": p["share"], "yield": p["yield_deflection"]},
           lambda p, s: {"share": p["share"], "yield_deflection": p["yield_deflection"] * s.amplitude}),
    _named("cubic_stiffness", lambda rng: {"coefficient": 1.0 if rng.random() < 0.6 else -0.25}, {"coefficient": 1},
           lambda p: {"cubic": p["coefficient"]},
           lambda p, s: {"coefficient": p["coefficient"] * s.rate**2 / s.amplitude**2}),
    _named("quadratic_stiffness", lambda rng: {"coefficient": 0.4 * _sign(rng)}, {"coefficient": 1},
           lambda p: {"quadratic": p["coefficient"]},
           lambda p, s: {"coefficient": p["coefficient"] * s.rate**2 / s.amplitude}),
    _named("sine_restoring", lambda rng: {"angle": 1.1}, {"angle": 1}, lambda p: {"bend": p["angle"]},
           lambda p, s: {"stiffness": s.rate**2, "length": s.amplitude / p["angle"]}, 0.1, ("deg", "rad")),
    _named("sensor_delay", lambda rng: {"delay": 0.8}, {"delay": 1}, lambda p: {"delay": p["delay"]},
           lambda p, s: {"delay": p["delay"] / s.rate}),
    _named("sensor_lowpass", lambda rng: {"cutoff": 0.7, "order": 2.0}, {"cutoff": -0.5},
           lambda p: {"lowpass": p["cutoff"]},
           lambda p, s: {"cutoff": p["cutoff"] * s.rate / (2.0 * np.pi), "order": 2.0}, 1e-3),
    _named("sensor_saturation", lambda rng: {"limit": 0.25}, {"limit": -0.4}, lambda p: {"limit": p["limit"]},
           lambda p, s: {"limit": p["limit"] * s.reading}, 3e-2),
    _named("sensor_drift", lambda rng: {"rate": 8e-3 * _sign(rng)}, {"rate": 1}, lambda p: {"drift": p["rate"]},
           lambda p, s: {"rate": p["rate"] * s.reading * s.rate}),
))  # fmt: skip
SENSOR_EFFECTS = tuple(name for name in OSCILLATOR_EFFECTS if name.startswith("sensor_"))


def members(knobs: list[Params]) -> dict[str, np.ndarray]:
    """Members as arrays (member,), each naming only what differs from NEUTRAL."""
    unknown = {name for member in knobs for name in member} - set(NEUTRAL)
    if unknown:
        raise KeyError(f"no such knobs: {sorted(unknown)}")
    return {
        name: np.array([member.get(name, value) for member in knobs], dtype=float) for name, value in NEUTRAL.items()
    }
