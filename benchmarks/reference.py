"""Independent answers: scipy at tight tolerances for smooth motion, the located switches of the test oracle."""

import sys
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.members import SAMPLING_RATE, Batch

ORACLES = Path(__file__).resolve().parents[1] / "tests" / "oracles"
RTOL, ATOL = 1e-12, 1e-13


def smooth(members: Batch) -> np.ndarray:
    """Displacement / length, (batch, time): every member in one system, so tolerances hold for all together."""
    p = members.natural()
    batch = len(p["a"])
    order = np.arange(1, len(p["c"]) + 1)[:, None]

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        displacement, velocity = y[:batch], y[batch:]
        angle = p["w"] * t + p["phase"]
        stiffness = 1 + p["c"] @ np.cos(order * angle)
        force = p["a"] * np.sign(velocity) * np.abs(velocity) ** p["n"]
        return np.concatenate([velocity, 1 - force - stiffness * displacement])

    start = np.concatenate([p["y0"], np.zeros(batch)])
    found = solve_ivp(rates, (0, p["t"][-1]), start, method="DOP853", rtol=RTOL, atol=ATOL, t_eval=p["t"])
    return found.y[:batch]


def backlash(members: Batch, n_samples: int) -> np.ndarray:
    """Displacement / length, (batch, time), by the event-located reference of the tests."""
    sys.path.insert(0, str(ORACLES))
    import gear_reference

    times = np.arange(n_samples) / SAMPLING_RATE
    rows = []
    for i in range(len(members.torque)):
        values = {name: float(getattr(members, name)[i]) for name in ("torque", "x0")}
        case = gear_reference.GearCase(
            pinion_speed=float(members.speed[i]), power_alpha=float(members.alpha[i]),
            power_n=float(members.exponent[i]), gap=members.gap, **values,
        )  # fmt: skip
        rows.append(gear_reference.simulate(case, times)[0] / members.length[i])
    return np.array(rows)


def errors(found: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Relative L2 error of each member, (batch,)."""
    return np.linalg.norm(found - expected, axis=1) / np.linalg.norm(expected, axis=1)
