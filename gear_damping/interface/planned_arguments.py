"""What is handed to `gd.plan`, as plain numbers: quantities with units are read, and what is none is answered."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields, replace
from math import isfinite
from numbers import Integral, Real
from typing import Any

from gear_damping.config.decided import decided_by_options, unseen_sensors
from gear_damping.config.planned import COSTS, PLAIN, SENSOR
from gear_damping.errors import InputError, Problem
from gear_damping.identification.test_plan.asked import PlanCosts, PlanGoal, PlannedSensor, PlannedTests, Unknown
from gear_damping.identification.test_plan.channels import channels_of
from gear_damping.interface.arguments import (
    refuse_no_flag,
    refuse_no_model,
    refuse_other_kind,
    require_kind,
    wrong_values,
)
from gear_damping.physics.model import Model
from gear_damping.schema.values import Problems, Value
from gear_damping.simulation.sampling import SAMPLING_RATE
from gear_damping.units import number_in

LISTS = {"durations": "s", "speeds": "rad/s", "torques": "N*m", "amplitudes": "m"}  # of tests, with their units
GOAL = {"percent": "%", "exponent": "1"}  # numbers of a goal, with their units
COUNTS = ("most_tests", "repeats")  # numbers of a goal that count something


class Handed:
    """Reads what was handed over for one model, and gathers what is wrong with it."""

    def __init__(self, model: Model) -> None:
        """Begin with the model whose units they are in.

        Raises:
            InputError: it is none.
        """
        refuse_no_model(model)
        self.model, self.system = model, model.system
        unseen = [Problem(name, rule, remedy=remedy) for name, rule, remedy in unseen_sensors(model)]
        self.declared, self.problems = model.parameters(), Problems(unseen)

    def tests(self, given: object) -> PlannedTests:
        """Tests with numbers alone."""
        require_kind("tests", given, PlannedTests, "gd.PlannedTests(durations=[1, 2], sampling_rate=500)")
        found = {name: self._list(f"plan.{name}", getattr(given, name), unit) for name, unit in LISTS.items()}
        rate = self._number("plan.sampling_rate", given.sampling_rate, "Hz")
        wrong = None if rate is None else SAMPLING_RATE.problem(rate, "plan.sampling_rate")
        self.problems += [wrong] if wrong else []
        settle = self._number("plan.settle", given.settle, "s", optional=True)
        return PlannedTests(sampling_rate=rate, settle=settle, **found)

    def sensors(self, given: Any) -> tuple[PlannedSensor, ...]:
        """Sensors, each of which is told by its name."""
        found = self.each("sensors", given, (str, PlannedSensor), self.sensor)
        for name, count in Counter(one.name for one in found).items():
            if count > 1:
                remedy = "name each differently, and say what it sees: channel=…"
                self.problems.append(Problem("plan.sensors", "names one twice", name, remedy))
        return found

    def sensor(self, given: object) -> PlannedSensor:
        """A sensor with numbers alone."""
        require_kind("sensors", given, PlannedSensor, "gd.PlannedSensor('response', snr_db=30)")
        _refuse_no_text("plan.sensors", given.name, "response")
        key, seen = f"plan.sensors.{given.name}", channels_of(self.system)
        unit = seen.get(given.sees) if isinstance(given.sees, str) else None
        found = {
            "noise": given.noise if unit is None else self._number(f"{key}.noise", given.noise, unit, optional=True),
            "snr_db": self._number(f"{key}.snr_db", given.snr_db, "dB", optional=True),
            "cost": self._number(f"{key}.cost", given.cost, ""),
            "offset": self._flag(f"{key}.offset", given.offset),
        }
        if found["snr_db"] is not None and not isfinite(found["snr_db"]):
            remedy = "for example 30; without noise every test tells all"
            self.problems.append(Problem(f"{key}.snr_db", "must be a finite level in dB", found["snr_db"], remedy))
        else:
            self.problems += wrong_values(f"{key}.snr_db", found["snr_db"], SENSOR["snr_db"])
        found["noise"] = (
            found["noise"] if isinstance(found["noise"], float | None) else 1.0
        )  # of no channel, as is said
        return replace(given, **found)

    def unknown(self, given: object) -> Unknown:
        """What is unknown, with numbers alone."""
        given = Unknown(given) if isinstance(given, str) else given
        require_kind("unknown", given, Unknown, "gd.Unknown('stiffness', percent=2)")
        _refuse_no_text("plan.unknown", given.name, "stiffness")
        key, declared = f"plan.unknown.{given.name}", self.declared.get(given.name)
        self.problems += [Problem("plan.unknown", *idle) for idle in self._idle(given.name)]
        unit = "" if declared is None else self.system.unit_of(declared.unit)
        said = None if declared is None else given.deviation  # that there is no such parameter is said later
        deviation = self._number(f"{key}.deviation", said, unit, optional=True)
        percent, each = self._number(f"{key}.percent", given.percent, "%", True), self._flag(f"{key}.each", given.each)
        return replace(given, deviation=deviation, percent=percent, each=each)

    def _idle(self, name: str) -> Iterator[tuple[str, str, str]]:
        """Rule, value and remedy of what has no effect in any test, though it may be unknown."""
        if decided := decided_by_options(self.model).get(name):
            yield decided.rule, name, decided.remedy
        for channel, gain in self.system.gains.items():
            if name == gain and channel not in self.declared:
                yield f"has no effect: it scales a {channel}, and none drives the tests of a plan", name, "leave it out"

    def goal(self, given: object) -> PlanGoal:
        """A goal with numbers alone."""
        refuse_other_kind("goal", given, PlanGoal, "gd.PlanGoal(percent=5)")
        given = given or PlanGoal()
        require_kind("goal.costs", given.costs, PlanCosts, "gd.PlanCosts(per_test=1)")
        found = {
            name: self._number(f"plan.wanted_{name}", getattr(given, name), unit, optional=name == "exponent")
            for name, unit in GOAL.items()
        }
        counts = {name: self.count(f"plan.{name}", getattr(given, name)) for name in COUNTS}
        costs = {
            one.name: self._number(f"plan.cost.{one.name}", getattr(given.costs, one.name), "")
            for one in fields(PlanCosts)
        }
        self._within(COSTS, "plan.cost.", costs)
        self._within(PLAIN, "plan.", counts | {f"wanted_{name}": value for name, value in found.items()})
        joint = self._flag("plan.joint", given.joint)
        return replace(given, **found, **counts, joint=joint, costs=PlanCosts(**costs))

    def each(self, key: str, given: Any, alone: type | tuple[type, ...], read: Callable[[object], Any]) -> tuple:
        """What is made of each of a list, or of one that stands alone."""
        if isinstance(given, alone):
            return (read(given),)
        if not isinstance(given, Iterable):
            raise InputError(Problem(key, "must be a list", repr(given), f"write {key}=[…]"))
        return tuple(read(one) for one in given)

    def count(self, key: str, value: object) -> int | None:
        """A whole number."""
        if isinstance(value, Integral) and not isinstance(value, bool):
            return int(value)
        self.problems.append(Problem(key, "must be a whole number", _shown(value), "for example 2"))
        return None

    def _within(self, kinds: Mapping[str, Value], prefix: str, given: Mapping[str, float | None]) -> None:
        """Note numbers outside of what the command line takes; what is None was noted, or is open."""
        for name, value in given.items():
            self.problems += [] if value is None else wrong_values(prefix + name, value, kinds[name])

    def _flag(self, key: str, value: object) -> bool:
        """True or false; False, noted, for what is neither."""
        with self.problems.collecting():
            refuse_no_flag(key, value)
            return bool(value)
        return False

    def _list(self, key: str, given: Any, unit: str) -> tuple | float | None:
        unit = self.system.unit_of(unit)
        if isinstance(given, str | Real) or getattr(given, "ndim", 1) == 0:
            return self._number(key, given, unit)  # that it must be a list is said later
        if isinstance(given, Mapping) or not isinstance(given, Iterable):
            self.problems.append(Problem(key, "must be a list", _shown(given), "write [1, 2]"))
            return ()
        return tuple(self._number(f"{key}[{place}]", one, unit) for place, one in enumerate(given))

    def _number(self, key: str, value: Any, unit: str, optional: bool = False) -> float | None:
        """A number in a unit; a text with another unit of its kind too. None, noted, for what is neither."""
        if value is None and optional:
            return None
        value = value.item() if getattr(value, "ndim", 1) == 0 else value
        with self.problems.collecting():
            value = number_in(value, unit, key) if unit else value
            if isinstance(value, Real) and not isinstance(value, bool):
                return float(value)
            of, such = (f" in {unit}", f" or '2 {unit}'") if unit not in ("", "1") else ("", "")
            self.problems.append(Problem(key, f"must be a number{of}", _shown(value), f"for example 2{such}"))
        return None


def _refuse_no_text(key: str, name: object, example: str) -> None:
    """Refuse what is no name.

    Raises:
        InputError: it is none.
    """
    if not isinstance(name, str) or not name.strip():
        raise InputError(Problem(f"{key}.name", "must be a name", _shown(name), f"for example '{example}'"))


def _shown(value: object) -> object:
    return value if isinstance(value, str | Real) else repr(value)
