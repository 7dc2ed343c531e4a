"""What many simulated tests show of a plan: each with its own noise, each fitted until nothing moves."""

from dataclasses import dataclass, replace

import torch
from torch import Tensor

from gear_damping.errors import InputError, Problem
from gear_damping.identification.test_plan.fit import SharedFit, TestFit, fitted
from gear_damping.identification.test_plan.information import QUANTILE
from gear_damping.identification.test_plan.plan import Precision, TestPlan, ToldTest, known_exponent
from gear_damping.identification.test_plan.slopes import Recorder, scales_of
from gear_damping.identification.test_plan.starts import AT_ONCE
from gear_damping.identification.test_plan.survey import Survey, picked
from gear_damping.simulation.solver_settings import Progress


@dataclass(frozen=True)
class Shown:
    """What simulated tests show of one quantity.

    Args:
        promised: Standard deviation by the plan.
        deviation: Of the estimates.
        bias: Of their mean.
        covered: Share of the promised 95 % intervals about the estimates that hold the truth.
    """

    promised: float
    deviation: float
    bias: float
    covered: float


@dataclass(frozen=True)
class Repeated:
    """What simulated tests show of a plan.

    Args:
        count: Tests, or sets of them, that were simulated and fitted.
        lost: Of these, fits that did not converge: they count as not covered, and for nothing else.
        damping_ratio: In % of critical.
        exponent: Of the law, where it was unknown.
    """

    count: int
    lost: int
    damping_ratio: Shown
    exponent: Shown | None


def repeat(
    plan: TestPlan, of: ToldTest, count: int, *, joint: bool = False, seed: int = 0, progress: Progress | None = None
) -> Repeated:
    """Simulate a test, or a set, many times behind noise, and estimate the damping of each by maximum likelihood.

    Every fit is Gauss-Newton from the truth on the simulated model until it rests. What is known beforehand is drawn
    about the truth for each.

    Args:
        plan: The plan.
        of: The test or set.
        count: How often, 2 or more.
        joint: Whether the exponent is unknown too.
        seed: Of what is drawn.
        progress: Told (done, total).

    Raises:
        InputError: the plan promises nothing for it, or the count is too small.
    """
    promised = of.joint if joint else of.alone
    if promised is None or not promised.percent < float("inf") or count < 2:
        rule = "needs 2 or more, of a test that tells something of the damping"
        raise InputError(Problem("plan.simulated_tests", rule, count))
    surveyed, generator = plan.survey, torch.Generator().manual_seed(seed)
    common = _shared(surveyed, joint)
    tests = [_test(surveyed, of, setting, length, common) for setting, length in of.tests]
    members = sum(len(common.names) + test.own for test in tests) * 2 + 1
    most = max(1, AT_ONCE // (members * max(test.recorder.samples for test in tests)))
    found = []
    for part in torch.arange(count).split(most):
        found.append(fitted(common, tests, len(part), generator))
        if progress:
            progress(int(part[-1]) + 1, count)
    shared, converged = (torch.cat([one[place] for one in found]) for place in (0, 1))
    return _shown(surveyed, common, shared[converged], promised, count)


def _shared(surveyed: Survey, joint: bool) -> SharedFit:
    kept = known_exponent(surveyed, joint)
    names = tuple(surveyed.names.shared[n] for n in kept)
    return SharedFit(names, surveyed.rig.coefficient, surveyed.shared_prior[kept])


def _test(surveyed: Survey, of: ToldTest, setting: int, length: int, common: SharedFit) -> TestFit:
    sensors = [surveyed.sensors[n] for n in of.sensors]
    rate, samples = surveyed.tests.sampling_rate, surveyed.lengths[length]
    recorder = Recorder(surveyed.rig, rate, samples, tuple(sensor.sees for sensor in sensors))
    start = picked(surveyed.start, torch.tensor([setting]))
    longest = replace(recorder, samples=surveyed.lengths[-1])  # the plan's own sub-steps
    offsets = tuple(n for n, sensor in enumerate(sensors) if sensor.offset)
    prior = surveyed.own_prior[setting]
    own = len(surveyed.names.own)
    return TestFit(
        recorder=recorder,
        start=start,
        scales=scales_of(recorder, start, (*common.names, *surveyed.names.own)),
        solver=longest.solver(surveyed.start.values),
        noise=surveyed.noise[list(of.sensors), setting],
        offsets=offsets,
        prior=torch.cat([prior[:own], torch.zeros(len(offsets), dtype=torch.float64)]),
    )


def _shown(surveyed: Survey, common: SharedFit, shared: Tensor, promised: Precision, count: int) -> Repeated:
    rig, lost = surveyed.rig, count - len(shared)
    values = rig.members(len(shared))
    for place, name in enumerate(common.names):
        values[name] = common.moved(name, values[name], _scale(values[name]), shared[:, place])
    ratio = _of_one(rig.ratio_percent(values), surveyed.ratio_percent, promised.damping_ratio, count)
    if promised.exponent is None:
        return Repeated(count, lost, ratio, None)
    exponent = _of_one(values[rig.exponent], float(rig.values[rig.exponent][0]), promised.exponent, count)
    return Repeated(count, lost, ratio, exponent)


def _scale(value: Tensor) -> Tensor:
    return torch.where(value != 0, value.abs(), 1.0)


def _of_one(found: Tensor, truth: float, half: float, count: int) -> Shown:
    error = found - truth
    covered = int((error.abs() <= half).sum()) / count
    return Shown(half / QUANTILE, float(found.std()), float(error.mean()), covered)
