"""The forces between the flanks and the equations of motion of all members, as rates of the state.

State rows: x, v; then, where any member has them, bearing y, y'; shaft twist q, q'; three hysteretic deflections.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, field

import numpy as np

from .knobs import any_on
from .stiffness import Arrays, mean_stiffness

YIELD_RATIOS = np.array([0.5, 1.0, 1.6])[:, None]  # yields of the three elements over their nominal value
DRIVE, LOOSE, COAST = 1.0, 0.0, -1.0
Law = Callable[[Arrays, np.ndarray, np.ndarray], np.ndarray]  # knobs, deflection, rate -> force / N


@dataclass
class Instant:
    """What acts at one instant whatever the state, each (member,)."""

    stiffness: np.ndarray
    error: np.ndarray
    error_rate: np.ndarray
    load: np.ndarray
    torque: np.ndarray
    friction: np.ndarray | float
    unbalance: np.ndarray | float
    cut_last: np.ndarray | float = 0.0  # of the pair that met last: its relief and its stiffness,
    last: np.ndarray | float = 0.0
    cut_before: np.ndarray | float = 0.0  # and those of the pair before it
    before: np.ndarray | float = 0.0


def damping_laws(knobs: Arrays) -> list[Law]:
    """The memoryless laws that are on."""
    laws = [viscous]
    if any_on(knobs, "power"):
        laws.append(power)
    if any_on(knobs, "dry"):
        laws.append(dry_friction)
    if any_on(knobs, "dry_forward", "dry_backward", "viscous_forward", "viscous_backward"):
        laws.append(one_way_friction)
    if any_on(knobs, "contact_damping"):
        laws.append(contact_damping)
    return laws


def viscous(p: Arrays, deflection: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """c delta'."""
    return p["viscous"] * rate


def power(p: Arrays, deflection: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """alpha delta' |delta'|^(n - 1), the size of the rate rounded at zero."""
    return p["power"] * rate * (rate * rate + p["power_rounding"] ** 2) ** (0.5 * (p["power_n"] - 1.0))


def dry_friction(p: Arrays, deflection: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Coulomb's force, rounded by a hyperbola."""
    return p["dry"] * rate / np.sqrt(rate * rate + p["dry_width"] ** 2)


def one_way_friction(p: Arrays, deflection: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Dry and viscous friction, each with a value for either direction, exchanged along an arc tangent."""
    forward = 0.5 + np.arctan(rate / p["one_way_width"]) / np.pi
    dry = p["dry_forward"] * forward - p["dry_backward"] * (1.0 - forward)
    return dry + rate * (p["viscous_forward"] * forward + p["viscous_backward"] * (1.0 - forward))


def contact_damping(p: Arrays, deflection: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Hunt and Crossley: the deeper the contact the stronger."""
    return p["contact_damping"] * np.abs(deflection / p["contact_at"]) ** p["contact_exponent"] * rate


@dataclass
class Motion:
    """The right-hand side; `region` (member,) says which flank touches and is held fixed within a step."""

    knobs: Arrays
    region: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        p = self.knobs
        self.region = np.full(p["mass"].shape, DRIVE)
        self.laws = damping_laws(p)
        self.bearing = 2 if any_on(p, "bearing") else None
        self.torsion = 2 + 2 * (self.bearing is not None) if any_on(p, "torsion") else None
        self.yielding = 2 + 2 * (self.bearing is not None) + 2 * (self.torsion is not None)
        self.rows = self.yielding + 3 * any_on(p, "hysteresis")
        self.gapped, self.filmed = any_on(p, "gap"), any_on(p, "film")
        self.relieved = any_on(p, "relief")
        self.curved = [name for name in ("cubic", "hertz") if any_on(p, name)]
        self.coast_shift = np.where(np.isfinite(p["gap"]), p["gap"], 0.0)
        self.relaxation = np.sqrt(mean_stiffness(p) / p["mass"])

    def of(self, members: np.ndarray) -> Motion:
        """The motion of some of the members."""
        part = copy(self)
        part.knobs = {name: value[..., members] for name, value in self.knobs.items()}
        for name in ("region", "coast_shift", "relaxation"):
            setattr(part, name, getattr(self, name)[members])
        return part

    def start(self, at: Instant, moved: np.ndarray, pushed: np.ndarray) -> np.ndarray:
        """State near the static equilibrium: off by `moved` of the deflection and `pushed` of its speed."""
        p = self.knobs
        y, static = np.zeros((self.rows, *p["mass"].shape)), at.load / mean_stiffness(p)
        y[0] = static * (1.0 + moved) + at.error + (static < 0.0) * -self.coast_shift
        y[1] = np.abs(static) * self.relaxation * pushed + at.error_rate
        if self.bearing is not None:
            y[self.bearing] = p["bearing"] * at.load / p["bearing_stiffness"]
            y[0] += y[self.bearing]
        if self.torsion is not None:
            y[self.torsion] = p["torsion"] * at.torque / p["torsion_stiffness"]
        return y

    def approach(self, y: np.ndarray, at: Instant) -> tuple[np.ndarray, np.ndarray]:
        """delta / m and delta' / (m/s)."""
        delta, rate = y[0] - at.error, y[1] - at.error_rate
        if self.bearing is not None:
            delta, rate = delta - y[self.bearing], rate - y[self.bearing + 1]
        return delta, rate

    def region_of(self, delta: np.ndarray) -> np.ndarray:
        """Which flank touches; the bilateral mesh always drives."""
        gap = self.knobs["gap"]
        found = np.where(delta >= 0.0, DRIVE, np.where(delta <= -self.coast_shift, COAST, LOOSE))
        return np.where(np.isfinite(gap), found, DRIVE)

    def rates(self, y: np.ndarray, at: Instant) -> np.ndarray:
        """The derivative of the state."""
        p = self.knobs
        delta, rate = self.approach(y, at)
        touching, deflection = 1.0, delta
        if self.gapped:
            touching = np.abs(self.region)
            deflection = touching * delta + (self.region < 0.0) * self.coast_shift
        damping = sum(law(p, deflection, rate) for law in self.laws)
        if self.rows > self.yielding:
            damping = damping + p["hysteresis"] * y[self.yielding :].mean(axis=0)
        mesh = self._elastic(deflection, at) + touching * damping
        if self.filmed:
            mesh = mesh + self._film(delta, rate)
        mesh = mesh * at.friction
        out = np.empty_like(y)
        out[0], out[1] = y[1], (at.load - mesh) / p["mass"]
        self._further(y, at, mesh, rate, touching, out)
        return out

    def _elastic(self, deflection: np.ndarray, at: Instant) -> np.ndarray:
        p, k = self.knobs, at.stiffness
        if "hertz" in self.curved:
            k = k * ((deflection / p["hertz_at"]) ** 2 + 1e-8) ** (0.5 * p["hertz"])
        force = k * deflection
        if self.relieved:  # a pair carries nothing of what its flanks are cut back by
            pressed = np.maximum(deflection, 0.0)
            force = force - at.last * np.minimum(pressed, at.cut_last) - at.before * np.minimum(pressed, at.cut_before)
        return force + p["cubic"] * deflection**3 if "cubic" in self.curved else force

    def _film(self, delta: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Squeeze film on both flanks, by the oil that is left between them."""
        h = self.knobs["film_thickness"]
        drive, coast = h + np.maximum(-delta, 0.0), h + np.maximum(delta + self.coast_shift, 0.0)
        return self.knobs["film"] * rate * ((h / drive) ** 3 + (h / coast) ** 3)

    def _further(self, y, at: Instant, mesh, rate, touching, out) -> None:
        """Rates of bearing, shaft and hysteresis."""
        p = self.knobs
        if self.bearing is not None:
            place, speed = y[self.bearing], y[self.bearing + 1]
            force = mesh + at.unbalance - p["bearing_stiffness"] * place - p["bearing_damping"] * speed
            out[self.bearing], out[self.bearing + 1] = speed, p["bearing"] * force / p["bearing_mass"]
        if self.torsion is not None:
            twist, speed = y[self.torsion], y[self.torsion + 1]
            shaft = p["torsion_stiffness"] * twist + p["torsion_damping"] * speed
            arm, inertia = p["radius_1"], p["inertia_1"]
            relative = (at.torque - shaft) / p["motor"] - (shaft - arm * mesh) / inertia
            out[self.torsion], out[self.torsion + 1] = speed, p["torsion"] * relative
            out[1] += p["torsion"] * p["joint_mass"] * arm / inertia * (shaft - at.torque) / p["mass"]
        if self.rows > self.yielding:
            z, limit = y[self.yielding :], p["yield"] * YIELD_RATIOS
            held = rate - np.abs(rate) * z / limit
            out[self.yielding :] = touching * held - (1.0 - touching) * self.relaxation * z
