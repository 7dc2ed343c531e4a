"""What tests of a rig would tell of its damping, and which are the cheapest that tell enough."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any

from matplotlib.figure import Figure

from gear_damping.identification.test_plan.asked import PlanGoal, PlannedSensor, PlannedTests, Unknown
from gear_damping.identification.test_plan.maps import IntervalMap, interval_curves, interval_map
from gear_damping.identification.test_plan.plan import Asked, TestPlan, ToldTest, plan_tests
from gear_damping.identification.test_plan.repeated import Repeated, repeat
from gear_damping.identification.test_plan.rig import Rig
from gear_damping.interface import planned_page as page
from gear_damping.interface.arguments import SEED, refuse_no_flag, refuse_other_kind, refuse_other_solver
from gear_damping.interface.model import refuse_unsaid
from gear_damping.interface.planned_arguments import Handed
from gear_damping.physics.model import Model
from gear_damping.reporting.figures.test_plan import test_plan_figure
from gear_damping.schema.values import Number, Problems
from gear_damping.simulation.sampling import whole_number_problems
from gear_damping.simulation.solver_settings import Solver

TIMES = Number(whole=True)  # how often: a count, that of none is refused with what it is for


class Plan:
    """A test plan: `content`, as in plan.json, a `table()`, `sentences` and a `plot()` of it.

    Tests and sets of tests are `gear_damping.identification.test_plan.plan.ToldTest`: halves of 95 % intervals, with
    the exponent of the law known (`alone`) and unknown (`joint`), and the cost.
    """

    def __init__(self, found: TestPlan) -> None:
        """Hold a plan of `gear_damping.identification.test_plan.plan`."""
        self.found = found

    @property
    def tests(self) -> tuple[ToldTest, ...]:
        """Every test with each sensor by itself, and with all of them."""
        return self.found.single

    @property
    def cheapest(self) -> ToldTest | None:
        """The cheapest set that reaches what is wanted, or None."""
        return self.found.cheapest

    @property
    def best(self) -> ToldTest:
        """The set that tells most."""
        return self.found.best

    @property
    def front(self) -> tuple[ToldTest, ...]:
        """Sets none of which is both dearer and worse than another, cheapest first."""
        return self.found.front

    @property
    def content(self) -> dict[str, Any]:
        """Everything, as plain values with the unit in the key."""
        return page.content(self.found)

    @property
    def sentences(self) -> list[str]:
        """The answer in plain words."""
        return page.sentences(self.found)

    def table(self, most: int | None = None) -> str:
        """Tests with their intervals and costs, and sets that cost more and tell more, 100 columns wide.

        Args:
            most: Only so many tests, those that tell most; all where absent.
        """
        return page.table(self.found, most)

    @cached_property
    def map(self) -> IntervalMap | None:
        """The interval over speed and torque; None where there are fewer than two of one."""
        return interval_map(self.found)

    def plot(self) -> Figure:
        """The map with the tests on it, the chosen ones filled; without one, intervals over the length of a record."""
        curves = None if self.map is not None else interval_curves(self.found)
        return test_plan_figure(page.picture(self.found, self.map, curves))

    def simulated(
        self, of: ToldTest | None = None, *, count: int = 1000, joint: bool = False, seed: int = 0
    ) -> Repeated:
        """Simulate a test or a set many times behind noise, fit each, and compare what the fits scatter by.

        Args:
            of: A test or a set; the cheapest, or the best where none reaches what is wanted.
            count: How often.
            joint: Whether the exponent of the law is unknown too.
            seed: Of the noise.

        Raises:
            InputError: nothing is promised for it, or the count is none.
        """
        refuse_other_kind("of", of, ToldTest, "plan.best")
        refuse_no_flag("joint", joint)
        Problems(whole_number_problems("count", count, TIMES) + whole_number_problems("seed", seed, SEED)).raise_any()
        return repeat(self.found, of or self.cheapest or self.best, count, joint=joint, seed=seed)

    def __repr__(self) -> str:
        return f"<Plan of {len(self.tests)} tests: {self.sentences[0]}>"


def plan(
    model: Model,
    tests: PlannedTests,
    sensors: PlannedSensor | Sequence[PlannedSensor],
    *,
    unknown: Unknown | str | Sequence[Unknown | str] = (),
    goal: PlanGoal | None = None,
    solver: Solver | None = None,
) -> Plan:
    """Plan tests of a rig before any is made.

    Every test's interval is what the noise of its sensors leaves (Cramér-Rao), its own start unknown; tests of a set
    share the rig and add up.

    Args:
        model: The rig, with the values that it is expected to have.
        tests: Speeds, torques or amplitudes, and durations that could be tested. Here as below numbers are in SI, and
            texts in their own unit, `'2 min'`.
        sensors: What could be mounted.
        unknown: What is unknown beside the damping: flat names, or `Unknown` where something is known beforehand or
            it differs from test to test.
        goal: The interval that is wanted, and what tests cost.
        solver: Settings of the solver, and who is told of its progress.

    Raises:
        InputError: everything that is wrong with it.
    """
    refuse_other_solver(solver)
    solver, handed = solver or Solver(), Handed(model)
    refuse_unsaid(model, model.given)
    asked = Asked(
        handed.tests(tests),
        handed.sensors(sensors),
        handed.each("unknown", unknown, (str, Unknown), handed.unknown),
        handed.goal(goal),
    )
    handed.problems.raise_any()
    return Plan(plan_tests(Rig(model, {}, asked.goal.law, solver), asked, solver.progress))
