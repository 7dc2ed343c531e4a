"""All members at once in fixed steps of sixth order; a step that meets or leaves a flank is cut in two there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .contact import Instant, Motion
from .excitation import error, load, reliefs, stiffness, turning
from .knobs import any_on
from .runge_kutta import NODES, step
from .stiffness import Arrays

CHUNK = 400_000  # numbers in one table of excitations, to bound the memory
DIVERGED = 1e-2  # m


@dataclass
class Trajectory:
    """Motion at the sampling instants: time (n,) / s, from before 0 on; the others (n, member) in SI."""

    time: np.ndarray
    x: np.ndarray
    v: np.ndarray
    a: np.ndarray
    delta: np.ndarray
    diverged: np.ndarray


@dataclass
class Tables(Instant):
    """Excitations at the five nodes of consecutive steps: each (step, node, member) or a scalar."""

    def at(self, step_index: int, node: int) -> Instant:
        """One instant."""
        here = (step_index, node)
        return Instant(*(v[here] if isinstance(v, np.ndarray) else v for v in vars(self).values()))

    def within(self, step_index: int, members: np.ndarray, begin: np.ndarray, length: np.ndarray) -> Tables:
        """One step of some members cut to a part of it, by the polynomial through the five nodes."""
        weights = _lagrange(begin + NODES[:, None] * length)  # (node, new node, member)

        def cut(values):
            return np.einsum("ijl,il->jl", weights, values[step_index][:, members])[None]

        return Tables(*(cut(v) if isinstance(v, np.ndarray) else v for v in vars(self).values()))


def _lagrange(at: np.ndarray) -> np.ndarray:
    weights = np.ones((5, *at.shape))
    for i, own in enumerate(NODES):
        for other in np.delete(NODES, i):
            weights[i] *= (at - other) / (own - other)
    return weights


def tabulate(knobs: Arrays, first: float, count: int, h: float, held: np.ndarray | None = None) -> Tables:
    """Excitations of `count` steps of h from the time `first`; `held` (step, member) times the load noise is added."""
    nodes = (first + h * (np.arange(count)[:, None] + NODES[:4])).ravel()
    t = np.append(nodes, first + h * count)[:, None]
    at = turning(knobs, t)
    k, friction = stiffness(knobs, t, at)
    e, e_rate = error(knobs, at)
    force, torque = load(knobs, t, at)
    turned = at.speed**2 * np.cos(at.pinion + knobs["unbalance_phase"]) * knobs["unbalance"]
    unbalance = _by_step(turned) if any_on(knobs, "unbalance") else 0.0
    force = _by_step(force) if held is None else _by_step(force) + (held * knobs["load_noise"])[:, None]
    friction = _by_step(friction) if isinstance(friction, np.ndarray) else friction
    cut = [_by_step(one) for one in reliefs(knobs, at)] if any_on(knobs, "relief") else []
    return Tables(_by_step(k), _by_step(e), _by_step(e_rate), force, _by_step(torque), friction, unbalance, *cut)


def _by_step(values: np.ndarray) -> np.ndarray:
    """(4 n + 1, member) -> (n, 5, member) with the shared node repeated."""
    count = values.shape[0] // 4
    inner = values[:-1].reshape(count, 4, -1)
    return np.concatenate([inner, values[4::4][:, None]], axis=1)


def integrate(
    knobs: Arrays,
    n_samples: int,
    rate: float,
    substeps: int = 4,
    settle: int = 0,
    moved: np.ndarray | float = 0.0,
    pushed: np.ndarray | float = 0.0,
    held: np.ndarray | None = None,
) -> Trajectory:
    """Motion of all members at -settle/rate, ..., 0, 1/rate, ..., (n_samples - 1)/rate.

    moved, pushed: start off the static equilibrium (Motion.start). held: (settle + n_samples, member), the load
    noise of each sample in units of the knob.
    """  # fmt: skip
    motion, h = Motion(knobs), 1.0 / (rate * substeps)
    run = _Run(motion, h, Delayed.of(knobs, h, (settle + n_samples) * substeps + 1))
    members, total = knobs["mass"].size, settle + n_samples - 1
    block = max(1, CHUNK // (5 * members * substeps))
    kept = np.empty((4, total + 1, members))
    for begin in range(0, total + 1, block):
        samples = min(block, total + 1 - begin)
        slow = None if held is None else np.repeat(held[begin : begin + samples], substeps, axis=0)
        tables = tabulate(knobs, (begin - settle) / rate, samples * substeps, h, slow)
        if begin == 0:
            run.begin(tables, moved, pushed)
        with np.errstate(over="ignore", invalid="ignore"):  # members that diverge are named in the trajectory
            for sample in range(samples):
                for sub in range(substeps):
                    run.advance(tables, sample * substeps + sub)
                    if sub == 0:
                        kept[:, begin + sample] = run.before
    diverged = ~(np.abs(kept[0]).max(axis=0) < DIVERGED)
    return Trajectory(np.arange(-settle, n_samples) / rate, *kept, diverged)


class _Run:
    """The state of all members on its way."""

    def __init__(self, motion: Motion, h: float, delayed: Delayed | None) -> None:
        self.motion, self.h, self.delayed, self.count = motion, h, delayed, 0

    def begin(self, tables: Tables, moved, pushed) -> None:
        at = tables.at(0, 0)
        self.y = self.motion.start(at, moved, pushed)
        self.motion.region = self.motion.region_of(self.motion.approach(self.y, at)[0])
        self.slopes = np.empty((7, *self.y.shape))

    def advance(self, tables: Tables, index: int) -> None:
        """One step; `before` keeps x, v, a and delta at its start."""
        nodes = [tables.at(index, node) for node in range(5)]
        if self.delayed is not None:
            self.delayed.add(self.count, self.y, nodes)
        motion, y = self.motion, self.y
        end = step(lambda node, z: motion.rates(z, nodes[node]), y, self.h, self.slopes)
        delta, rate = motion.approach(y, nodes[0])
        self.before = y[0], y[1], self.slopes[0, 1].copy(), delta
        if motion.gapped:
            after, after_rate = motion.approach(end, nodes[4])
            region = motion.region_of(after)
            crossed = np.flatnonzero(region != motion.region)
            if crossed.size:
                ends = (delta, rate, after, after_rate)
                end[:, crossed] = self._cut(tables, index, crossed, [value[crossed] for value in ends])
                motion.region = motion.region_of(motion.approach(end, nodes[4])[0])
        self.y, self.count = end, self.count + 1

    def _cut(self, tables: Tables, index: int, members: np.ndarray, ends: list[np.ndarray]) -> np.ndarray:
        """The step of the members that change flank: up to the crossing, then on in the region behind it."""
        part = self.motion.of(members)
        level = np.where(part.region > 0.0, 0.0, -part.coast_shift)
        leaving_gap_upwards = (part.region == 0.0) & (ends[2] > 0.5 * level)
        level = np.where(leaving_gap_upwards, 0.0, level)
        share = _hermite_root(*ends, self.h, level)
        rising = ends[2] > level
        y = _partial(part, tables, index, members, np.zeros_like(share), share, self.y[:, members], self.h)
        part.region = np.where(level == 0.0, np.where(rising, 1.0, 0.0), np.where(rising, 0.0, -1.0))
        return _partial(part, tables, index, members, share, 1.0 - share, y, self.h)


def _partial(part: Motion, tables: Tables, index: int, members, begin, length, y, h) -> np.ndarray:
    cut = tables.within(index, members, begin, length)
    nodes = [cut.at(0, node) for node in range(5)]
    return step(lambda node, z: part.rates(z, nodes[node]), y, h * length, np.empty((7, *y.shape)))


def _hermite_root(a, a_rate, b, b_rate, h, level) -> np.ndarray:
    """Where in [0, 1] the cubic through both ends crosses the level: bisection, then it is exact enough."""
    low, high = np.zeros_like(a), np.ones_like(a)
    sign = np.sign(b - level)
    for _ in range(40):
        u = 0.5 * (low + high)
        w = 1.0 - u
        value = w * w * (1 + 2 * u) * a + u * u * (3 - 2 * u) * b + h * u * w * (w * a_rate - u * b_rate) - level
        behind = value * sign > 0.0
        low, high = np.where(behind, low, u), np.where(behind, u, high)
    return 0.5 * (low + high)


class Delayed:
    """A force feedback * (x(t - delay) - x0) from the path already travelled."""

    def __init__(self, knobs: Arrays, h: float, steps: int) -> None:
        members = knobs["mass"].size
        self.gain, self.path = knobs["feedback"], np.empty((2, steps, members))
        self.back = np.maximum(1, np.round(knobs["feedback_delay"] / h)).astype(int)
        self.member, self.h = np.arange(members), h

    @classmethod
    def of(cls, knobs: Arrays, h: float, steps: int) -> Delayed | None:
        """None where no member has feedback."""
        return cls(knobs, h, steps) if any_on(knobs, "feedback") else None

    def add(self, count: int, y: np.ndarray, nodes: list[Instant]) -> None:
        """Note the state at the start of step `count` and add the force to its nodes."""
        self.path[:, count] = y[:2]
        first = np.maximum(count - self.back, 0)
        second = np.minimum(first + 1, count)
        (x0, v0), (x1, v1) = self.path[:, first, self.member], self.path[:, second, self.member]
        for u, at in zip(NODES, nodes, strict=True):
            w = 1.0 - u
            x = w * w * (1 + 2 * u) * x0 + u * u * (3 - 2 * u) * x1 + self.h * u * w * (w * v0 - u * v1)
            at.load = at.load + self.gain * (x - self.path[0, 0])
