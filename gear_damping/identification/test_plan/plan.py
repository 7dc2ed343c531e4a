"""A test plan: what each test tells, the cheapest set that tells enough, and what more money would buy."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations

import torch
from torch import Tensor

from gear_damping.errors import InputError, Problem
from gear_damping.identification.test_plan.asked import PlanGoal, PlannedSensor, PlannedTests, Unknown
from gear_damping.identification.test_plan.cheapest import Candidates, Found, Judge, Search, search
from gear_damping.identification.test_plan.checks import refuse, refuse_goal
from gear_damping.identification.test_plan.information import UNKNOWN, half_intervals
from gear_damping.identification.test_plan.rig import Rig
from gear_damping.identification.test_plan.survey import Survey, survey
from gear_damping.simulation.solver_settings import Progress


@dataclass(frozen=True)
class Asked:
    """Everything that one asks of a plan."""

    tests: PlannedTests
    sensors: tuple[PlannedSensor, ...]
    unknown: tuple[Unknown, ...] = ()
    goal: PlanGoal = field(default_factory=PlanGoal)


@dataclass(frozen=True)
class Precision:
    """Halves of 95 % intervals; infinite where nothing is told.

    Args:
        damping_ratio: % of critical.
        percent: The same in % of the damping ratio.
        exponent: Of the exponent of the law; None where it counts as known.
    """

    damping_ratio: float
    percent: float
    exponent: float | None = None


@dataclass(frozen=True)
class ToldTest:
    """What one test, or one set of tests, tells.

    Args:
        tests: Numbers of the setting and of the length of each test.
        sensors: Numbers of the sensors.
        alone: Where the exponent of the law is known.
        joint: Where it is unknown too; None for a law without one.
        cost: Of all.
    """

    tests: tuple[tuple[int, int], ...]
    sensors: tuple[int, ...]
    alone: Precision
    joint: Precision | None
    cost: float


@dataclass(frozen=True)
class TestPlan:
    """A plan.

    Args:
        asked: What was asked.
        survey: What tests would tell.
        single: Each test with each sensor by itself, and with all of them.
        cheapest: The cheapest set that reaches what is wanted, or None.
        best: The set that comes nearest, or goes farthest beyond.
        front: Sets none of which is both dearer and worse than another, cheapest first.
        search: How they were found.
    """

    asked: Asked
    survey: Survey
    single: tuple[ToldTest, ...]
    cheapest: ToldTest | None
    best: ToldTest
    front: tuple[ToldTest, ...]
    search: Search

    def told(self, tests: Sequence[tuple[int, int]], sensors: Sequence[int] | None = None) -> ToldTest:
        """What a set of tests tells.

        Args:
            tests: Numbers of the setting (`survey.settings`) and of the length (`survey.lengths`) of each.
            sensors: Numbers of the sensors, ascending; all where absent.
        """
        chosen = tuple(range(len(self.asked.sensors))) if sensors is None else tuple(sensors)
        return _Book(self.asked, self.survey).told(tuple(tests), chosen)


def plan_tests(rig: Rig, asked: Asked, progress: Progress | None = None) -> TestPlan:
    """Plan.

    Raises:
        InputError: everything that is wrong with what is asked.
    """
    refuse(rig, asked.tests, asked.sensors, asked.unknown)
    refuse_goal(rig, asked.goal)
    surveyed = survey(rig, asked.tests, asked.sensors, asked.unknown, progress)
    if not bool(surveyed.fine.any()):
        rule = "no test tells anything: in simulation each stands still, diverges or moves irregularly"
        raise InputError(Problem("plan", rule, None, "give speeds, torques or amplitudes at which the rig vibrates"))
    book = _Book(asked, surveyed)
    everyone = tuple(range(len(asked.sensors)))
    shown = [(one,) for one in everyone] + ([everyone] if len(everyone) > 1 else [])
    single = [book.told((test,), sensors) for test in book.tests for sensors in shown]
    found = search(book.judge(), asked.goal.most_tests, asked.goal.repeats)
    sets = {one: book.of(one) for one in (*found.front, found.best)}
    cheapest = None if found.cheapest is None else sets[found.cheapest]
    front = tuple(sets[one] for one in found.front)
    return TestPlan(asked, surveyed, tuple(single), cheapest, sets[found.best], front, found)


def precision_of(surveyed: Survey, total: Tensor, joint: bool) -> Precision:
    """Of information on what is shared, without what is known beforehand, (shared, shared)."""
    kept = known_exponent(surveyed, joint)
    total = total[kept][:, kept] + torch.diag(surveyed.shared_prior[kept])
    half = float(half_intervals(total, surveyed.gradient[kept]))
    percent = 100 * half / surveyed.ratio_percent
    if not percent < UNKNOWN:
        half = percent = float("inf")
    if not joint:
        return Precision(half, percent)
    exponent = float(half_intervals(total, _unit(surveyed, kept)))
    return Precision(half, percent, exponent if exponent < UNKNOWN else float("inf"))


def known_exponent(surveyed: Survey, joint: bool) -> list[int]:
    """Places of the shared unknowns, without the exponent where that is known."""
    return [n for n in range(len(surveyed.names.shared)) if joint or n != surveyed.exponent_place]


def _unit(surveyed: Survey, kept: list[int]) -> Tensor:
    """The gradient of the exponent, whose scale is its value."""
    value = float(surveyed.rig.values[surveyed.rig.exponent][0])
    return torch.tensor([value * (n == surveyed.exponent_place) for n in kept], dtype=torch.float64)


class _Book:
    """The tests with what they tell and what they cost."""

    def __init__(self, asked: Asked, surveyed: Survey) -> None:
        self.asked, self.survey = asked, surveyed
        everyone = range(len(asked.sensors))
        self.choices = [some for size in range(1, len(everyone) + 1) for some in combinations(everyone, size)]
        self.information = {sensors: surveyed.told(sensors) for sensors in self.choices}
        settings, lengths = range(len(surveyed.settings)), range(len(surveyed.lengths))
        self.tests = [(setting, length) for setting in settings for length in lengths]

    def candidates(self) -> Candidates:
        kept = known_exponent(self.survey, self.asked.goal.joint)
        told = torch.stack([self.information[one].flatten(0, 1)[:, kept][..., kept] for one in self.choices])
        speeds = [one.get("pinion_speed", 0.0) for one in self.survey.settings]
        numbers = {speed: number for number, speed in enumerate(dict.fromkeys(speeds))}
        return Candidates(
            cost=torch.tensor([self._price(length) for _, length in self.tests], dtype=torch.float64),
            speed=torch.tensor([numbers[speeds[setting]] for setting, _ in self.tests]),
            torque=torch.tensor([setting for setting, _ in self.tests]),
            told=told,
            prior=torch.diag(self.survey.shared_prior[kept]),
            sensors=torch.tensor([self._mounted(one) for one in self.choices], dtype=torch.float64),
        )

    def judge(self) -> Judge:
        goal, kept = self.asked.goal, known_exponent(self.survey, self.asked.goal.joint)
        gradients = [self.survey.gradient[kept] / (goal.percent / 100 * self.survey.ratio_percent)]
        if goal.exponent is not None:
            gradients.append(_unit(self.survey, kept) / goal.exponent)
        return Judge(self.candidates(), torch.stack(gradients), (goal.costs.per_speed, goal.costs.per_torque))

    def of(self, found: Found) -> ToldTest:
        return self.told(tuple(self.tests[test] for test in found.tests), self.choices[found.sensors])

    def told(self, tests: tuple[tuple[int, int], ...], sensors: tuple[int, ...]) -> ToldTest:
        surveyed, costs = self.survey, self.asked.goal.costs
        total = sum(self.information[sensors][setting, length] for setting, length in tests)
        settings = {setting for setting, _ in tests}
        speeds = {surveyed.settings[setting].get("pinion_speed") for setting in settings}
        cost = sum(self._price(length) for _, length in tests) + self._mounted(sensors)
        cost += costs.per_speed * len(speeds) + costs.per_torque * len(settings)
        joint = precision_of(surveyed, total, True) if surveyed.rig.exponent else None
        return ToldTest(tests, sensors, precision_of(surveyed, total, False), joint, cost)

    def _mounted(self, sensors: tuple[int, ...]) -> float:
        return sum(self.asked.sensors[n].cost for n in sensors)

    def _price(self, length: int) -> float:
        seconds = self.survey.lengths[length] / self.survey.tests.sampling_rate
        return self.asked.goal.costs.per_test + self.asked.goal.costs.per_second * seconds
