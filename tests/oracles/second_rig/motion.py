"""Motion of the second rig: m x'' + F_d(x' - e') + k(t) (x - e) = F(t), by the classical method of Runge and Kutta.

x is the relative motion along the line of action / m. Both shafts turn at a speed that is prescribed, so that
stiffness, load and geometric error are functions of time alone: they are tabulated before, twice a step.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from .pair import Rig, mesh_stiffness, smooth_step, tooth_stiffness

STEPS_A_PERIOD = 70  # of the natural frequency, at least
FEWEST_STEPS = 2  # between two samples
SETTLING = 0.06  # s before the first sample of a record that begins in the steady state
RISE = 1e-3  # s in which a torque goes from one level to the next
HALVINGS = 45  # of a step, until the place where it crosses a flank is found
MOST_CROSSINGS = 8  # of flanks in one step
DRIVE, FREE, COAST = 1, 0, -1  # the flank that touches


@dataclass(frozen=True)
class Steps:
    """A torque / (N m) that goes from level to level; changes: (from, to, time of the change / s)."""

    changes: tuple[tuple[float, float, float], ...]

    def __call__(self, t: np.ndarray) -> np.ndarray:
        """At the times t / s."""
        return sum((new - old) * smooth_step((t - at) / RISE) for old, new, at in self.changes) + self.changes[0][0]


@dataclass(frozen=True)
class Run:
    """One record: what is set, and what is drawn once it is taken.

    rate: samples per s. duration, settling: s. speed, speed_end: of the pinion / rpm, where absent the speed stays.
    torque: of the pinion / (N m). at_rest: whether it begins at `begin` (m, m/s) rather than in the steady state.
    mesh_zero: mesh periods from the meeting of a pair to the zero of the pinion's angle. pinion_angle, gear_angle:
    rad at the first sample. tooth: by how many a cracked one of the gear is ahead, drawn anew for each record, as where
    nobody knows which teeth had met.
    """

    rate: float
    duration: float
    speed: float
    torque: float | Steps
    at_rest: bool = False
    begin: tuple[float, float] = (0.0, 0.0)
    speed_end: float | None = None
    settling: float = SETTLING
    role: str | None = None
    mesh_zero: float | None = None
    pinion_angle: float = 0.0
    gear_angle: float = 0.0
    tooth: int = 0

    @property
    def samples(self) -> int:
        """Of the record."""
        return round(self.rate * self.duration)

    @property
    def acceleration(self) -> float:
        """Of the pinion / (rad/s^2)."""
        end = self.speed if self.speed_end is None else self.speed_end
        return (end - self.speed) * math.pi / 30 / (self.samples / self.rate)


@dataclass(frozen=True)
class Hidden:
    """An effect by the name that the catalogue has for it, or by one of its own, and its parameters in SI."""

    name: str
    values: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Motion:
    """At the samples of a record: t / s, x / m and its derivatives, both angles / rad, speed / (rad/s), N m."""

    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    a: np.ndarray
    pinion_angle: np.ndarray
    gear_angle: np.ndarray
    speed: np.ndarray
    torque: np.ndarray


@dataclass(frozen=True)
class Tables:
    """What is prescribed, twice a step: stiffness / (N/m), force / N, error / m and its rate / (m/s)."""

    stiffness: np.ndarray
    force: np.ndarray
    error: np.ndarray
    error_rate: np.ndarray


def simulate(rig: Rig, run: Run, hidden: Hidden | None = None, substeps: int | None = None) -> Motion:
    """The motion of one record; substeps: steps between two samples."""
    substeps = substeps or max(FEWEST_STEPS, math.ceil(rig.natural_frequency * STEPS_A_PERIOD / run.rate))
    step = 1.0 / run.rate / substeps
    before = 0 if run.at_rest else round(run.settling * run.rate)
    t = (np.arange(2 * (run.samples - 1 + before) * substeps + 1) / 2 - before * substeps) * step
    speed, pinion, gear = _turned(rig, run, t)
    torque = run.torque(t) if callable(run.torque) else np.full_like(t, run.torque)
    tables = tabulated(rig, run, hidden, (pinion, gear), torque, step / 2)
    start = run.begin if run.at_rest else (tables.force[0] / tables.stiffness[0] + tables.error[0], 0.0)
    if hidden and hidden.name == "backlash":
        path = integrate_gap(tables, step, start, rig.mass, rig.viscous, hidden.values["gap"])
    else:
        path = integrate(tables, step, start, rig.mass, damping_force(rig, hidden))
    kept, kept_of_tables = slice(before * substeps, None, substeps), slice(2 * before * substeps, None, 2 * substeps)
    prescribed = (values[kept_of_tables] for values in (pinion, gear, speed, torque))
    return Motion(t[kept_of_tables], *(values[kept] for values in path), *prescribed)


def _turned(rig: Rig, run: Run, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Speed of the pinion / (rad/s) and angles of both shafts / rad; a run-up begins with the first sample."""
    first, after = run.speed * math.pi / 30, np.maximum(t, 0.0)
    speed = first + run.acceleration * after
    pinion = run.pinion_angle + first * t + 0.5 * run.acceleration * after**2
    gear = run.gear_angle + (pinion - run.pinion_angle) * rig.teeth[0] / rig.teeth[1]
    return speed, pinion, gear


def tabulated(
    rig: Rig, run: Run, hidden: Hidden | None, angles: tuple[np.ndarray, np.ndarray], torque: np.ndarray, spacing: float
) -> Tables:
    """Everything prescribed, with the hidden effect in it.

    angles: of pinion and gear / rad. torque: N m. spacing: of the tables / s.
    """
    phase = angles[0] * rig.teeth[0] / (2.0 * math.pi) - run.mesh_zero
    stiffness, force, error = mesh_stiffness(rig, phase), torque / rig.radii[0], np.zeros_like(phase)
    name, values = (hidden.name, hidden.values) if hidden else (None, {})
    if name == "torque_ripple":
        force = force + _pressed(rig, values) * values["amplitude"] * np.cos(angles[0] + values["phase"])
    elif name in ("pinion_eccentricity", "gear_eccentricity"):
        error = values["amplitude"] * np.cos(angles[name == "gear_eccentricity"] + values["phase"])
    elif name == "tooth_crack":  # of the gear: its own pair loses a share of its own stiffness
        stiffness = stiffness - values["depth"] * tooth_stiffness(rig, phase + run.tooth, rig.teeth[1], 0)
    elif name == "pitch_error":  # of the pinion: a pair that is off by so much pulls with its share of the mesh
        own = tooth_stiffness(rig, phase, rig.teeth[0], values["tooth"])
        error = values["amplitude"] * own / stiffness
    rate = np.gradient(error, spacing) if np.any(error) else np.zeros_like(error)
    return Tables(stiffness, force, error, rate)


def _pressed(rig: Rig, values: Mapping[str, float]) -> float:
    """Force on x for each torque of a ripple / (1/m).

    Where the load of the gear stands only the pinion's share of it drives x, and both shafts speed up, which a sensor
    on a shaft would tell, and nothing here does. Where the gear's torque follows the whole ripple drives x alone.
    """
    return 1.0 / rig.radii[0] if values.get("follows") else rig.mass * rig.radii[0] / rig.inertias[0]


def damping_force(rig: Rig, hidden: Hidden | None) -> Callable[[float], float]:
    """F_d / N of a rate / (m/s)."""
    c, name, values = rig.viscous, hidden.name if hidden else None, hidden.values if hidden else {}
    if name == "power_law_damping":
        size, power = values["coefficient"], values["exponent"] - 1.0
        return lambda rate: c * rate + size * abs(rate) ** power * rate
    if name == "coulomb_friction":
        size, width = values["force"], values["width"]
        return lambda rate: c * rate + size * math.tanh(rate / width)
    return lambda rate: c * rate


def integrate(
    tables: Tables, step: float, start: tuple[float, float], mass: float, damping: Callable[[float], float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x / m, x' and x'' at every step of flanks that never part; step: s."""
    k, f, e, e_rate = (table.tolist() for table in vars(tables).values())
    steps, (x, v) = (len(k) - 1) // 2, start

    def acceleration(x: float, v: float, i: int) -> float:
        return (f[i] - k[i] * (x - e[i]) - damping(v - e_rate[i])) / mass

    path = []
    for i in range(0, 2 * steps, 2):
        a = acceleration(x, v, i)
        path.append((x, v, a))
        v2 = v + step / 2 * a
        a2 = acceleration(x + step / 2 * v, v2, i + 1)
        v3 = v + step / 2 * a2
        a3 = acceleration(x + step / 2 * v2, v3, i + 1)
        v4 = v + step * a3
        a4 = acceleration(x + step * v3, v4, i + 2)
        x, v = x + step / 6 * (v + 2 * v2 + 2 * v3 + v4), v + step / 6 * (a + 2 * a2 + 2 * a3 + a4)
    path.append((x, v, acceleration(x, v, 2 * steps)))
    return tuple(np.array(path).T)


@dataclass(frozen=True)
class GapStep:
    """One step of flanks with a gap (m): the drive flank touches for x > 0, the coast flank for x < -gap.

    stiffness, force: at begin, middle and end of the step, which lasts `step` s. viscous: N s/m, in contact only.
    """

    stiffness: list[float]
    force: list[float]
    step: float
    mass: float
    viscous: float
    gap: float

    def flank(self, x: float) -> int:
        """Which one touches."""
        return DRIVE if x > 0 else (COAST if x < -self.gap else FREE)

    def acceleration(self, x: float, v: float, share: float, flank: int) -> float:
        """At a share of the step, while this flank touches / (m/s^2)."""
        force = _parabola(self.force, share)
        if flank == FREE:
            return force / self.mass
        bent = x if flank == DRIVE else x + self.gap
        return (force - _parabola(self.stiffness, share) * bent - self.viscous * v) / self.mass

    def advanced(self, begin: float, share: float, x: float, v: float, flank: int) -> tuple[float, float]:
        """x and x' after a share of the step from `begin`, as though this flank stayed as it is."""
        h = self.step * share
        a1 = self.acceleration(x, v, begin, flank)
        v2 = v + h / 2 * a1
        a2 = self.acceleration(x + h / 2 * v, v2, begin + share / 2, flank)
        v3 = v + h / 2 * a2
        a3 = self.acceleration(x + h / 2 * v2, v3, begin + share / 2, flank)
        v4 = v + h * a3
        a4 = self.acceleration(x + h * v3, v4, begin + share, flank)
        return x + h / 6 * (v + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)

    def crossing(self, begin: float, x: float, v: float, flank: int) -> float:
        """The share of the step after which this flank has just changed."""
        low, high = 0.0, 1.0 - begin
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            if self.flank(self.advanced(begin, middle, x, v, flank)[0]) == flank:
                low = middle
            else:
                high = middle
        return high

    def whole(self, x: float, v: float, flank: int) -> tuple[float, float, int]:
        """The end of the step, which is parted wherever it crosses a flank."""
        begin = 0.0
        for _ in range(MOST_CROSSINGS):
            end = self.advanced(begin, 1.0 - begin, x, v, flank)
            if self.flank(end[0]) == flank:
                break
            share = self.crossing(begin, x, v, flank)
            x, v = self.advanced(begin, share, x, v, flank)
            begin, flank = begin + share, self.flank(x)
            if begin >= 1.0:
                return x, v, flank
        return *end, flank


def _parabola(three: list[float], share: float) -> float:
    """Through the values at begin, middle and end of a step."""
    u = 2.0 * share
    return three[0] * (u - 1) * (u - 2) / 2 - three[1] * u * (u - 2) + three[2] * u * (u - 1) / 2


def integrate_gap(
    tables: Tables, step: float, start: tuple[float, float], mass: float, viscous: float, gap: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x / m, x' and x'' at every step of flanks with a gap / m and no geometric error; step: s."""
    k, f, (x, v) = tables.stiffness.tolist(), tables.force.tolist(), start
    path, flank = [], None
    for i in range(0, len(k) - 1, 2):
        one = GapStep(k[i : i + 3], f[i : i + 3], step, mass, viscous, gap)
        flank = one.flank(x) if flank is None else flank
        path.append((x, v, one.acceleration(x, v, 0.0, flank)))
        x, v, flank = one.whole(x, v, flank)
    path.append((x, v, one.acceleration(x, v, 1.0, flank)))
    return tuple(np.array(path).T)
