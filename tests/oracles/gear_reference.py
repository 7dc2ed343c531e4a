"""Slow, exact reference of the gear pair: smooth pieces by scipy, restarted at every located switch."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from gear_case import GearCase, Ripple
from gear_regimes import BREAKS_LOOSE, Event, Regime, displacement_scale
from gear_terms import Piece, break_times, sampled
from scipy.integrate import solve_ivp

__all__ = ["GearCase", "Ripple", "Trajectory", "sampled", "simulate", "trajectory"]

RTOL, ATOL_SHARE = 1e-12, 1e-13  # the absolute tolerance is this share of the run's displacement and speed
STEP_SHARE = 0.1  # longest step, in radians of the natural oscillation: the dense output is exact to 1e-12
CHECKS_PER_STEP = 3  # interior points at which a piece is searched for a switch that the stepping jumped over
PILE = 20  # so many switches at one instant are no motion
JUMP_SHARE = 1e-9  # how far beyond a switch, relative to the run's size, counts as jumped over


@dataclass
class Trajectory:
    """A reference run: x / m, v / (m/s) at the asked times, and its switches as (time / s, kind)."""

    x: np.ndarray
    v: np.ndarray
    switches: list[tuple[float, str]] = field(default_factory=list)

    def note(self, t: float, kind: str) -> None:
        """Add a switch; RuntimeError where switches pile up at one instant and the run would never end."""
        self.switches.append((t, kind))
        if len(self.switches) > PILE and t - self.switches[-PILE][0] < 1e-15:
            raise RuntimeError(f"switches pile up at {t:.9g} s: {self.switches[-4:]}")


def simulate(
    case: GearCase, times: np.ndarray, method: str = "DOP853", rtol: float = RTOL
) -> tuple[np.ndarray, np.ndarray]:
    """x / m and v / (m/s) of a case at ascending times >= 0 / s; the start x0, v0 is at t = 0."""
    run = trajectory(case, times, method, rtol)
    return run.x, run.v


def trajectory(case: GearCase, times: np.ndarray, method: str = "DOP853", rtol: float = RTOL) -> Trajectory:
    """As `simulate`, with the located switches of contact and slip."""
    times = np.asarray(times, dtype=float)
    run = Trajectory(np.full(times.shape, np.nan), np.full(times.shape, np.nan))
    t, y, end = 0.0, np.array([case.x0, case.v0], dtype=float), float(times[-1])
    contact = Regime.contact_at_start(Piece(case, 0.0), case.x0, case.v0)
    run.x[times == 0.0], run.v[times == 0.0] = case.x0, case.v0
    for stop in [*break_times(case, end), end]:
        piece = Piece(case, 0.5 * (t + stop))
        regime = Regime.enter(piece, contact, t, y)
        while t < stop:
            solution, event = _smooth_piece(regime, t, y, stop, method, rtol)
            inside = (times > t) & (times <= solution.t[-1])
            if inside.any():
                run.x[inside], run.v[inside] = solution.sol(times[inside])
            t, y = float(solution.t[-1]), solution.y[:, -1]
            if event is not None:
                run.note(t, event.kind)
                loose = event.kind == BREAKS_LOOSE
                regime = Regime.enter(piece, event.contact, t, y, at_rest=event.at_rest, loose=loose)
        contact = regime.contact
    return run


def _smooth_piece(regime: Regime, t: float, y: np.ndarray, stop: float, method: str, rtol: float):
    """Integrate to `stop` or to the first switch; returns scipy's solution and the switch, or None.

    Where two crossings fell into one step, and so were not seen, the piece is repeated with shorter steps.
    """
    case, events = regime.piece.case, regime.events()
    length, omega = displacement_scale(case), case.natural_frequency
    step = STEP_SHARE / omega
    for _ in range(8):
        solution = solve_ivp(
            regime.derivative,
            (t, stop),
            y,
            method=method,
            rtol=rtol,
            max_step=step,
            dense_output=True,
            atol=ATOL_SHARE * length * np.array([1.0, omega]),
            events=events or None,
        )
        if solution.status < 0:
            raise RuntimeError(f"the reference failed at {solution.t[-1]:.9g} s: {solution.message}")
        if not _jumped(solution, events):
            break
        step *= 0.25
    else:
        raise RuntimeError(f"a switch near {t:.9g} s cannot be separated from its neighbour")
    hits = zip(events, solution.t_events or [], strict=True)
    return solution, next((event for event, found in hits if found.size), None)


def _jumped(solution, events: list[Event]) -> bool:
    """Whether the piece lies beyond one of its switches anywhere before its end."""
    if not events:
        return False
    shares = np.arange(1, CHECKS_PER_STEP + 1) / (CHECKS_PER_STEP + 1)
    inner = (solution.t[:-1, None] + np.diff(solution.t)[:, None] * shares).ravel()
    states = solution.sol(inner)
    return any(
        event.direction * event(t, states[:, j]) > JUMP_SHARE * event.size
        for event in events
        for j, t in enumerate(inner)
    )
