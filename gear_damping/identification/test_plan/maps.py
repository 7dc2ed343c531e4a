"""Between and beyond the tests of a plan: the interval over speed and torque, and over the length of a record."""

from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from gear_damping.identification.test_plan.information import UNKNOWN, half_intervals
from gear_damping.identification.test_plan.plan import TestPlan, known_exponent
from gear_damping.identification.test_plan.survey import Survey, survey
from gear_damping.simulation.solver_settings import Progress

SPEEDS, TORQUES = 49, 9  # points of a map: resonances are narrow in speed
LENGTHS = 40  # points of a curve, which then looks smooth
SHORTEST = 32  # samples at which a curve begins


@dataclass(frozen=True, eq=False)
class IntervalMap:
    """Half of the 95 % interval of the damping ratio, in % of it, by the longest record with all sensors.

    Args:
        speeds: rad/s, (n,).
        torques: N m, (m,).
        percent: (m, n); nan where nothing is told.
    """

    speeds: NDArray[np.float64]
    torques: NDArray[np.float64]
    percent: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class IntervalCurves:
    """The same against the length of the record.

    Args:
        durations: s, (n,).
        percent: (settings, n); nan where nothing is told.
    """

    durations: NDArray[np.float64]
    percent: NDArray[np.float64]


def interval_map(plan: TestPlan, progress: Progress | None = None) -> IntervalMap | None:
    """A map within the speeds and torques of a plan; None where it has fewer than two of one."""
    tests = plan.asked.tests
    if min(len(tests.speeds), len(tests.torques)) < 2:
        return None
    speeds, torques = (
        np.union1d(np.linspace(min(values), max(values), count), values)
        for values, count in ((tests.speeds, SPEEDS), (tests.torques, TORQUES))
    )
    durations = tuple(sorted({min(tests.durations), max(tests.durations)}))
    wider = replace(tests, speeds=tuple(speeds.tolist()), torques=tuple(torques.tolist()), durations=durations)
    found = survey(plan.survey.rig, wider, plan.asked.sensors, plan.asked.unknown, progress)
    percent = _percent(found, plan.asked.goal.joint)[:, -1]
    return IntervalMap(speeds, torques, percent.reshape(len(speeds), len(torques)).T)


def interval_curves(plan: TestPlan) -> IntervalCurves:
    """Curves from a few samples to the longest record, one for each setting."""
    tests = plan.asked.tests
    last = plan.survey.lengths[-1]
    lengths = np.unique(np.geomspace(min(SHORTEST, last), last, LENGTHS).round())
    durations = tuple((lengths / tests.sampling_rate).tolist())
    # noise that is told by its ratio is that of the plan
    levels = plan.survey.noise
    curves = []
    for setting in range(len(plan.survey.settings)):
        sensors = [
            replace(sensor, noise=float(levels[number, setting]), snr_db=None)
            for number, sensor in enumerate(plan.asked.sensors)
        ]
        own = replace(tests, durations=durations, **_one_setting(plan.survey.settings[setting]))
        found = survey(plan.survey.rig, own, sensors, plan.asked.unknown)
        curves.append(_percent(found, plan.asked.goal.joint)[0])
    return IntervalCurves(np.array(durations), np.stack(curves))


def _one_setting(setting: dict[str, float]) -> dict[str, tuple[float, ...]]:
    names = {"pinion_speed": "speeds", "pinion_torque": "torques", "initial_displacement": "amplitudes"}
    return {names[name]: (value,) for name, value in setting.items()}


def _percent(found: Survey, joint: bool) -> NDArray[np.float64]:
    """(settings, lengths)."""
    kept = known_exponent(found, joint)
    total = found.told(range(len(found.sensors)))[..., kept, :][..., kept] + torch.diag(found.shared_prior[kept])
    percent = 100 * half_intervals(total, found.gradient[kept]) / found.ratio_percent
    return torch.where(percent < UNKNOWN, percent, torch.nan).numpy()
