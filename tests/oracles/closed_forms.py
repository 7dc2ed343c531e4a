"""Exact solutions and averaged laws of one mass on one spring, m x'' + c x' + k x = F(t), all in SI.

Written with complex roots and phasors where a simulator would use real arithmetic.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq


def natural_frequency(mass: float, stiffness: float) -> float:
    """Undamped natural frequency / (rad/s)."""
    return math.sqrt(stiffness / mass)


def static_deflection(load: float, stiffness: float) -> float:
    """Deflection / m of a spring under a constant load."""
    return load / stiffness


def free_decay(
    t: np.ndarray, mass: float, damping: float, stiffness: float, x0: float, v0: float
) -> tuple[np.ndarray, np.ndarray]:
    """Exact x / m and v / (m/s) of the unloaded linear oscillator: under-, over- and critically damped.

    With r = -c/2m and s = sqrt(r^2 - k/m), complex where underdamped,
    x = e^{rt} (x0 cosh st + (v0 - r x0) sinh(st)/s).
    """
    t = np.asarray(t, dtype=float)
    r = -damping / (2.0 * mass)
    s = np.sqrt(complex(r * r - stiffness / mass))
    critical = abs(s) * np.max(np.abs(t), initial=0.0) < 1e-8
    sine = t if critical else (np.exp(s * t) - np.exp(-s * t)) / (2.0 * s)
    cosine = (np.exp(s * t) + np.exp(-s * t)) / 2.0
    slope = v0 - r * x0
    x = x0 * cosine + slope * sine
    v = r * x + x0 * s * s * sine + slope * cosine
    return np.real(np.exp(r * t) * x), np.real(np.exp(r * t) * v)


def steady_state(
    t: np.ndarray,
    mass: float,
    damping: float,
    stiffness: float,
    force: float,
    omega: float,
    phase: float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Steady x / m and v / (m/s) under force * cos(omega t + phase); omega 0 is the static answer."""
    receptance = 1.0 / (stiffness - mass * omega**2 + 1j * damping * omega)
    turning = force * receptance * np.exp(1j * (omega * np.asarray(t, dtype=float) + phase))
    return turning.real, (1j * omega * turning).real


def forced_response(
    t: np.ndarray,
    mass: float,
    damping: float,
    stiffness: float,
    x0: float,
    v0: float,
    forces: tuple[tuple[float, float, float], ...],
) -> tuple[np.ndarray, np.ndarray]:
    """Steady state and transient from x0, v0 at t = 0 under forces (amplitude / N, rad/s, phase)."""
    start_x, start_v, x, v = x0, v0, 0.0, 0.0
    for force, omega, phase in forces:
        at_0 = steady_state(np.zeros(1), mass, damping, stiffness, force, omega, phase)
        steady = steady_state(t, mass, damping, stiffness, force, omega, phase)
        start_x, start_v = start_x - float(at_0[0][0]), start_v - float(at_0[1][0])
        x, v = x + steady[0], v + steady[1]
    decay = free_decay(t, mass, damping, stiffness, start_x, start_v)
    return x + decay[0], v + decay[1]


def energy(
    x: np.ndarray, v: np.ndarray, mass: float, stiffness: float | np.ndarray, gap: float | None = None
) -> np.ndarray:
    """Kinetic and spring energy / J; with a gap the spring is slack for -gap < x < 0."""
    stretch = np.asarray(x) if gap is None else np.maximum(x, 0.0) + np.minimum(np.asarray(x) + gap, 0.0)
    return 0.5 * mass * np.asarray(v) ** 2 + 0.5 * stiffness * stretch**2


def power_law_force(rate: np.ndarray, alpha: float, n: float) -> np.ndarray:
    """Damping force alpha sign(rate) |rate|^n / N, against the motion."""
    return alpha * np.copysign(np.abs(rate) ** n, rate)


def dissipated_per_cycle(alpha: float, n: float, amplitude: float, omega: float) -> float:
    """Energy / J that the power law takes from one cycle of amplitude cos(omega t), by quadrature."""
    speed = amplitude * omega
    quarter, _ = quad(lambda u: math.sin(u) ** (n + 1.0), 0.0, math.pi / 2.0, epsabs=0.0, epsrel=1e-13)
    return 4.0 * alpha * speed ** (n + 1.0) / omega * quarter


def equivalent_damping_ratio(alpha: float, n: float, speed: float, mass: float, stiffness: float) -> float:
    """Ratio of the viscous damper that takes as much from a cycle of velocity amplitude `speed` / (m/s)."""
    omega = natural_frequency(mass, stiffness)
    amplitude = speed / omega
    loss_factor = dissipated_per_cycle(alpha, n, amplitude, omega) / (math.pi * stiffness * amplitude**2)
    return 0.5 * loss_factor


def power_law_coefficient(damping_ratio: float, n: float, speed: float, mass: float, stiffness: float) -> float:
    """The alpha / (N (s/m)^n) with this equivalent damping ratio at velocity amplitude `speed`."""
    return damping_ratio / equivalent_damping_ratio(1.0, n, speed, mass, stiffness)


def power_law_amplitude(
    t: np.ndarray, amplitude_0: float, mass: float, stiffness: float, alpha: float, n: float
) -> np.ndarray:
    """Averaged amplitude / m of free decay: linear for n = 0, exponential for n = 1, hyperbolic for n = 2.

    First-order averaging: valid while a cycle loses little, that is an equivalent damping ratio << 1 at the
    amplitudes met; the relative error is of the order of that ratio over a decay by a factor of a few. For
    n = 0 it is exact at the turning points until the mass sticks; it is 0 afterwards (n < 1 ends in a finite
    time).
    """
    omega = natural_frequency(mass, stiffness)
    rate = dissipated_per_cycle(alpha, n, 1.0, omega) / (2.0 * math.pi * mass * omega)  # a' = -rate a^n
    t = np.asarray(t, dtype=float)
    if n == 1.0:
        return amplitude_0 * np.exp(-rate * t)
    remaining = amplitude_0 ** (1.0 - n) - (1.0 - n) * rate * t
    return np.maximum(remaining, 0.0) ** (1.0 / (1.0 - n))


def coulomb_turning_points(x0: float, friction: float, stiffness: float) -> np.ndarray:
    """Turning points / m of an unloaded Coulomb decay from rest at x0, to the one at which it sticks; exact.

    They are half a natural period apart and each is 2 friction / stiffness nearer to 0 than the one before.
    """
    points = [x0]
    while abs(points[-1]) * stiffness > friction:
        points.append(-math.copysign(abs(points[-1]) - 2.0 * friction / stiffness, points[-1]))
    return np.array(points)


def quadratic_turning_point(x0: float, alpha: float, mass: float, stiffness: float) -> float:
    """Next turning point / m of an unloaded decay with alpha v|v| from rest at x0; exact (first integral).

    With b = 2 alpha / m the energy per mass w = v^2 obeys dw/dx = -2 k x/m + b w while x falls.
    """
    b, c = 2.0 * alpha / mass, 2.0 * stiffness / mass
    a = abs(x0)

    def speed_squared(x: float) -> float:
        return c / b**2 * ((b * x + 1.0) - (b * a + 1.0) * math.exp(b * (x - a)))

    return math.copysign(brentq(speed_squared, -a, -0.0, xtol=1e-18 + 1e-15 * a), -x0)


def bouncing_times(mass: float, stiffness: float, load: float, exit_speed: float) -> tuple[float, float]:
    """Exact times / s in contact and in flight of a mass pressed on a spring that cannot pull, undamped.

    It leaves the spring at `exit_speed`, comes back at the same speed after the flight, and so on.
    """
    omega = natural_frequency(mass, stiffness)
    contact = 2.0 * (math.pi - math.atan(omega * exit_speed * mass / load)) / omega
    return contact, 2.0 * mass * exit_speed / load


def pushed_decay(
    random: np.random.Generator,
    load: float,
    mass: float,
    damping: float,
    stiffness: float,
    rate: float,
    samples: int,
    x0: float = 0.05,
    finer: int = 10,
) -> np.ndarray:
    """A decay from x0 at rest under a white load of intensity `load` / (N s^1/2), by `finer` steps a sample."""
    interval = 1.0 / (rate * finer)
    rates = np.array([[0.0, 1.0], [-stiffness / mass, -damping / mass]])
    values, vectors = np.linalg.eig(rates)
    step = (vectors @ np.diag(np.exp(values * interval)) @ np.linalg.inv(vectors)).real
    state, seen = np.array([x0, 0.0]), []
    for _ in range(samples):
        seen.append(state[0])
        for kick in load / mass * interval**0.5 * random.normal(size=finer):
            state = step @ state + np.array([0.0, kick])
    return np.array(seen)
