"""The same motion by other solvers, written as their users write it; natural units, float64."""

from collections.abc import Callable

import numpy as np

from benchmarks.members import N_HARMONICS, draw

Run = Callable[[], np.ndarray]


def scipy_rk45(batch: int, tolerance: float, keep: int = 64) -> Run:
    """A loop over members."""
    from scipy.integrate import solve_ivp

    p = draw(batch).natural()
    order = np.arange(1, N_HARMONICS + 1)

    def rates(t: float, y: np.ndarray, a: float, n: float, w: float, phase: float) -> list[float]:
        stiffness = 1 + p["c"] @ np.cos(order * (w * t + phase))
        return [y[1], 1 - a * np.sign(y[1]) * abs(y[1]) ** n - stiffness * y[0]]

    def run() -> np.ndarray:
        found = []
        for i in range(batch):
            own = tuple(p[name][i] for name in ("a", "n", "w", "phase"))
            span, start = (0, p["t"][-1]), [p["y0"][i], 0.0]
            solution = solve_ivp(rates, span, start, "RK45", p["t"], rtol=tolerance, atol=tolerance, args=own)
            found.append(solution.y[0])
        return np.array(found[:keep])

    return run


def torchdiffeq_dopri5(batch: int, tolerance: float, keep: int = 64) -> Run:
    import torch
    from torchdiffeq import odeint

    torch.set_num_threads(1)
    p = {name: torch.as_tensor(value) for name, value in draw(batch).natural().items()}
    order = torch.arange(1, N_HARMONICS + 1, dtype=torch.float64)[:, None]
    c = p["c"][:, None]

    def rates(t: torch.Tensor, y: torch.Tensor) -> torch.Tensor:
        stiffness = 1 + (c * torch.cos(order * (p["w"] * t + p["phase"]))).sum(0)
        force = p["a"] * torch.sign(y[1]) * y[1].abs() ** p["n"]
        return torch.stack([y[1], 1 - force - stiffness * y[0]])

    def run() -> np.ndarray:
        start = torch.stack([p["y0"], torch.zeros(batch, dtype=torch.float64)])
        with torch.no_grad():
            found = odeint(rates, start, p["t"], method="dopri5", rtol=tolerance, atol=tolerance)
        return found[:, 0, :keep].T.numpy()

    return run


def diffrax(batch: int, tolerance: float, keep: int = 64) -> Run:
    """Adaptive Tsit5, vmap over members, jit."""
    return _diffrax(batch, keep, tolerance=tolerance)


def diffrax_same_algebra(batch: int, substeps: int, keep: int = 64) -> Run:
    """Fixed steps of Tsit5, the stiffness by Horner's rule in one cosine."""
    return _diffrax(batch, keep, substeps=substeps)


def _diffrax(batch: int, keep: int, tolerance: float | None = None, substeps: int | None = None) -> Run:
    import diffrax as dfx
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    p = draw(batch).natural()
    order = jnp.arange(1, N_HARMONICS + 1)
    powers, c, times = jnp.asarray(cosine_powers(p["c"])), jnp.asarray(p["c"]), jnp.asarray(p["t"])

    def stiffness(angle):
        if tolerance is not None:
            return 1 + jnp.sum(c * jnp.cos(order * angle))
        cosine, total = jnp.cos(angle), powers[-1]
        for k in range(N_HARMONICS - 1, -1, -1):
            total = total * cosine + powers[k]
        return total

    def rates(t, y, own):
        a, n, w, phase = own
        force = a * jnp.sign(y[1]) * jnp.abs(y[1]) ** n
        return jnp.stack([y[1], 1 - force - stiffness(w * t + phase) * y[0]])

    if tolerance is not None:
        control, dt0 = dfx.PIDController(rtol=tolerance, atol=tolerance), 0.01
    else:
        control, dt0 = dfx.StepTo(ts=jnp.asarray(fine_grid(p["t"], substeps))), None
    saved = dfx.SaveAt(ts=times)

    def one(start, own):
        return dfx.diffeqsolve(
            dfx.ODETerm(rates), dfx.Tsit5(), 0.0, times[-1], dt0, start, own, saveat=saved,
            stepsize_controller=control, max_steps=200_000,
        ).ys[:, 0]  # fmt: skip

    every = jax.jit(jax.vmap(one))
    start = jnp.stack([jnp.asarray(p["y0"]), jnp.zeros(batch)], axis=1)
    own = tuple(jnp.asarray(p[name]) for name in ("a", "n", "w", "phase"))
    return lambda: np.asarray(every(start, own).block_until_ready())[:keep]


def numba_rk4(batch: int, substeps: int, keep: int = 64) -> Run:
    """Classical RK4, a compiled loop over members, Horner's rule in one cosine."""
    from numba import njit, prange

    p = draw(batch).natural()
    powers = cosine_powers(p["c"])

    @njit(fastmath=True)
    def acceleration(t, y, v, a, n, w, phase, powers):
        cosine = np.cos(w * t + phase)
        stiffness = powers[-1]
        for k in range(len(powers) - 2, -1, -1):
            stiffness = stiffness * cosine + powers[k]
        return 1.0 - a * np.sign(v) * abs(v) ** n - stiffness * y

    @njit(parallel=True, fastmath=True)
    def walk(y0, a, n, w, phase, powers, times, substeps, out):
        for i in prange(len(y0)):
            y, v = y0[i], 0.0
            out[i, 0] = y
            for j in range(len(times) - 1):
                h = (times[j + 1] - times[j]) / substeps
                for s in range(substeps):
                    t = times[j] + s * h
                    k1 = acceleration(t, y, v, a[i], n[i], w[i], phase[i], powers)
                    v2 = v + h / 2 * k1
                    k2 = acceleration(t + h / 2, y + h / 2 * v, v2, a[i], n[i], w[i], phase[i], powers)
                    v3 = v + h / 2 * k2
                    k3 = acceleration(t + h / 2, y + h / 2 * v2, v3, a[i], n[i], w[i], phase[i], powers)
                    v4 = v + h * k3
                    k4 = acceleration(t + h, y + h * v3, v4, a[i], n[i], w[i], phase[i], powers)
                    y += h / 6 * (v + 2 * v2 + 2 * v3 + v4)
                    v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
                out[i, j + 1] = y

    def run() -> np.ndarray:
        out = np.empty((batch, len(p["t"])))
        walk(p["y0"], p["a"], p["n"], p["w"], p["phase"], powers, p["t"], substeps, out)
        return out[:keep]

    return run


def cosine_powers(c: np.ndarray) -> np.ndarray:
    """1 + sum_h c_h cos(h x) as powers of cos(x), ascending."""
    return np.polynomial.chebyshev.cheb2poly(np.concatenate([[1.0], c]))


def fine_grid(times: np.ndarray, substeps: int) -> np.ndarray:
    inner = np.arange(substeps) / substeps
    steps = times[:-1, None] + np.diff(times)[:, None] * inner
    return np.append(steps.ravel(), times[-1])
