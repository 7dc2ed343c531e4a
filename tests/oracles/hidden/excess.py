"""How much of a response an effect leaves over once the nominal model has been calibrated to it.

The proxy D: the difference of the responses with and without the effect, projected off the sensitivities of
the response to what calibration frees (mean stiffness, its Fourier coefficients and phase, damping), fitted on
the fit records; the mean square of what is left on held-out records over the variance of the response.
"""

from __future__ import annotations

import numpy as np

from .excitation import turning
from .integrate import Tables, Trajectory, tabulate
from .runge_kutta import NODES, step
from .stiffness import Arrays, mean_stiffness

HARMONICS = 8
BLOCK = 256  # samples whose steps are computed together


def sensitivities(knobs: Arrays, path: Trajectory, order: int = 0) -> np.ndarray:
    """(n, record, parameter) from t = 0 on, of x or a derivative per relative change, by the variational equation.

    Parameters: mean stiffness, cosine and sine coefficients 1 ... HARMONICS, mesh phase, damping.
    """
    h = path.time[1] - path.time[0]
    begin = int(np.sum(path.time < -1e-12))
    y, kept = 0.0, []
    for first in range(0, path.time.size - 1, BLOCK):
        count = min(BLOCK, path.time.size - 1 - first)
        forced = _forcing(knobs, path, first, count, h)
        for i, (free, driven) in enumerate(zip(*_steps(knobs, *forced, h), strict=True)):
            kept.append(y if order < 2 else _acceleration(y, i, forced, knobs["mass"]))
            y = np.einsum("ijr,jrs->irs", free, y) + driven if kept[1:] else driven
    kept.append(y if order < 2 else kept[-1])  # no step begins at the last sample
    kept[0] = np.zeros_like(kept[-1])
    return np.stack(kept)[begin:, order % 2]


def _acceleration(y: np.ndarray | float, step_index: int, forced, mass: np.ndarray) -> np.ndarray | float:
    """The acceleration at the start of a step in place of x and x'."""
    if np.ndim(y) == 0:
        return y
    k, c, forces = (part[step_index, 0] for part in forced)
    return ((forces - k[:, None] * y[0] - c[:, None] * y[1]) / mass[:, None])[None]


def _forcing(knobs: Arrays, path: Trajectory, first: int, count: int, h: float):
    """Stiffness and damping that act at the nodes (step, node, record), and forces (..., parameter)."""
    tables = tabulate(knobs, path.time[first], count, h)
    delta, rate = _deflection(path, tables, first, count, h)
    touching = np.where(np.isfinite(knobs["gap"]), delta > 0.0, True)
    t = (path.time[first : first + count][:, None] + h * NODES).reshape(-1, 1)
    mesh = turning(knobs, t).mesh.reshape(count, 5, -1)
    k0 = mean_stiffness(knobs)
    shapes = [np.ones_like(mesh), *(f(i * mesh) for i in range(1, HARMONICS + 1) for f in (np.cos, np.sin))]
    tiny = 1e-4
    shifted = tabulate({**knobs, "mesh_phase": knobs["mesh_phase"] + tiny}, path.time[first], count, h).stiffness
    forces = [-k0 * shape * delta for shape in shapes]
    forces += [-(shifted - tables.stiffness) / tiny * delta, -knobs["viscous"] * rate]
    return tables.stiffness * touching, knobs["viscous"] * touching, np.stack(forces, axis=-1) * touching[..., None]


def _deflection(path: Trajectory, tables: Tables, first: int, count: int, h: float):
    """delta and delta' at the nodes: the cubic through both ends of each step, and its slope."""
    begin, end = slice(first, first + count), slice(first + 1, first + count + 1)
    (d0, d1), u = (path.delta[rows][:, None] for rows in (begin, end)), NODES[:, None]
    v0, v1 = (h * (path.v[rows] - tables.error_rate[:, n])[:, None] for rows, n in ((begin, 0), (end, 4)))
    bend, twist = 3.0 * (d1 - d0) - 2.0 * v0 - v1, v0 + v1 - 2.0 * (d1 - d0)
    return d0 + u * (v0 + u * (bend + u * twist)), (v0 + u * (2.0 * bend + 3.0 * u * twist)) / h


def _steps(knobs: Arrays, k: np.ndarray, c: np.ndarray, forces: np.ndarray, h: float):
    """Of every step: its transition matrix (step, 2, 2, record) and its answer to the forces (step, 2, record, s)."""
    count, _, members, parameters = forces.shape
    y = np.zeros((2, count, members, parameters + 2))
    y[0, ..., 0] = y[1, ..., 1] = 1.0
    forces = np.concatenate([np.zeros((count, 5, members, 2)), forces], axis=-1)
    k, c, mass = k[..., None], c[..., None], knobs["mass"][:, None]

    def rates(node: int, y: np.ndarray) -> np.ndarray:
        return np.stack([y[1], (forces[:, node] - k[:, node] * y[0] - c[:, node] * y[1]) / mass])

    end = step(rates, y, h, np.empty((7, *y.shape)))
    return np.transpose(end[..., :2], (1, 0, 3, 2)), np.transpose(end[..., 2:], (1, 0, 2, 3))


def excess(
    difference: np.ndarray, columns: np.ndarray, response: np.ndarray, fit: np.ndarray, scored: np.ndarray
) -> dict[str, float]:
    """D in %: `excess_percent`, and `excess_percent_without_mean`, which forgives an offset of each record.

    difference, response: (n, record); columns: (n, record, parameter); fit, scored: masks of records.
    """
    if not np.all(np.isfinite(difference)):
        return {"excess_percent": np.inf, "excess_percent_without_mean": np.inf}
    scale = np.sqrt(np.mean(columns**2, axis=(0, 1)))
    flat = (columns[:, fit] / scale).reshape(-1, scale.size)
    size = np.linalg.lstsq(flat, difference[:, fit].reshape(-1), rcond=1e-10)[0]
    left = difference[:, scored] - columns[:, scored] @ (size / scale)
    variance = np.mean(np.var(response[:, scored], axis=0))
    return {
        "excess_percent": float(100.0 * np.mean(left**2) / variance),
        "excess_percent_without_mean": float(100.0 * np.mean(np.var(left, axis=0)) / variance),
    }
