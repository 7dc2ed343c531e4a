"""Effects that no catalogue has: whoever finds one should say that it is unexplained."""

from __future__ import annotations

import math

import numpy as np

from .effect import Effect, Params, phase, signed
from .knobs import N_IMPACTS, Knobs


def _impacts(rng, duration) -> Params:
    count = int(rng.integers(4, N_IMPACTS + 1))
    return {"force": 4000.0, "width": float(rng.uniform(1e-4, 3e-4)),
            "times": [float(t) for t in np.sort(rng.uniform(0.0, 0.98 * duration, count))]}  # fmt: skip


def _turn_impacts(p: Params, record: Knobs) -> Knobs:
    """Each record has the same number of them, at other times: the drawn times run on from record to record."""
    times = np.asarray(p["times"])
    span = times.max() * 1.02
    shifted = np.mod(times + 0.37 * span * record["angle"], span)
    filled = np.full(N_IMPACTS, -1.0)
    filled[: times.size] = shifted
    return {"impact_times": filled, "impact_force": p["force"], "impact_width": p["width"]}


def _turn_warming(p: Params, record: Knobs) -> Knobs:
    """The mesh softens within a record and has softened more in those that were heated longer."""
    heated = 0.5 * (1.0 + math.sin(7.0 * record["angle"]))  # the record's own history, in no channel
    return {"warming": -p["rate"], "warmed": -p["spread"] * heated}


def _turn_feedback(p: Params, record: Knobs) -> Knobs:
    k = record["one_pair"] + (record["two_pairs"] - record["one_pair"]) * (record["contact_ratio"] - 1.0)
    return {"feedback": p["share"] * k, "feedback_delay": p["delay"]}


OUTSIDE = (
    Effect(
        "delayed_feedback", lambda rng, T: {"share": signed(rng, 0.06), "delay": float(rng.uniform(6e-5, 4e-4))},
        _turn_feedback, {"share": 1},
    ),
    Effect(
        "belt_order", lambda rng, T: {"torque": 40.0, "order": 0.37, "phase": phase(rng)},
        lambda p, record: {"belt": p["torque"], "belt_order": p["order"], "belt_phase": p["phase"]}, {"torque": 1},
    ),
    Effect(
        "thermal_drift", lambda rng, T: {"rate": 0.2 / T, "spread": 0.2}, _turn_warming, {"rate": 1, "spread": 1},
    ),
    Effect("impacts", _impacts, _turn_impacts, {"force": 1}),
    Effect(
        "mains_pickup", lambda rng, T: {"amplitude": 1e-5, "phase": phase(rng)},
        lambda p, record: {"mains": p["amplitude"], "mains_phase": p["phase"] + 11.0 * record["angle"]},
        {"amplitude": 1},
    ),
)  # fmt: skip
