"""A test plan in words, as a table, as plain values and as what a picture shows."""

from collections import Counter
from collections.abc import Iterator
from math import inf, isfinite, pi
from typing import Any

from gear_damping.identification.test_plan.channels import channels_of
from gear_damping.identification.test_plan.maps import IntervalCurves, IntervalMap
from gear_damping.identification.test_plan.plan import Precision, TestPlan, ToldTest
from gear_damping.physics.damping_ratio import is_far
from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.traits import Trait
from gear_damping.reporting.figures.test_plan import PlanCurves, PlanMap, PlanPicture
from gear_damping.reporting.numbers import number, pretty_unit
from gear_damping.reporting.tables import plan_table

START = "initial_displacement"  # where a test of an oscillator begins
RPM = 30 / pi  # revolutions a minute in one rad/s
WIDE = 50.0  # % of the value; beyond it some estimates run off to no damping at all (docs/plan.md)
MOST_OF_FRONT = 8  # sets that a reader looks through
LEAST_GAIN = 1.1  # from one of them to the next; who pays more wants to see more
# Unit that an axis of gears is shown in, and how many of it are in one SI unit.
AXES = {"pinion_speed": ("rpm", RPM), "pinion_torque": ("N m", 1.0)}


def content(plan: TestPlan) -> dict[str, Any]:
    """Everything, as plain values with the unit in the key."""
    surveyed, goal = plan.survey, plan.asked.goal
    rig = surveyed.rig
    return {
        "rig": {
            "system": rig.model.system.name,
            "unit": rig.model.system.unit_of("m") or None,
            "damping_law": rig.damping.name,
            "damping_ratio_percent": surveyed.ratio_percent,
            **_in_metres(rig.model.system, "at_velocity", "m/s", float(rig.velocity)),
            "exponent": float(rig.values[rig.exponent][0]) if rig.exponent else None,
        },
        "unknown": [{"name": one.name, "deviation_si": one.deviation, "percent": one.percent, "each_test": one.each}
                    for one in plan.asked.unknown],
        "sensors": [{"name": one.name, "channel": one.sees, "unit": channels_of(rig.model.system)[one.sees],
                     "noise": one.noise, "snr_db": one.snr_db, "offset_unknown": one.offset, "cost": one.cost}
                    for one in plan.asked.sensors],
        "wanted": {"half_interval95_percent_of_ratio": goal.percent, "half_interval95_exponent": goal.exponent,
                   "exponent_unknown": goal.joint, "most_tests": goal.most_tests, "repeats": goal.repeats},
        "tests": [_plain(plan, one) for one in plan.single],
        "cheapest": None if plan.cheapest is None else _plain(plan, plan.cheapest),
        "best": _plain(plan, plan.best),
        "front": [_plain(plan, one) for one in plan.front],
        "search": {"sets_tried": plan.search.tried, "exact_to_tests": plan.search.exact_to,
                   "most_tests": plan.search.most},
    }  # fmt: skip


def sentences(plan: TestPlan) -> list[str]:
    """The answer in plain words."""
    surveyed, goal = plan.survey, plan.asked.goal
    wanted = f"± {number(goal.percent)} % of it"
    if goal.exponent is not None:
        wanted += f" and its exponent within ± {number(goal.exponent)}"
    chosen = plan.cheapest
    if chosen is not None:
        said = f"the cheapest set that knows the damping ratio within {wanted}: {_told(plan, chosen)}"
    elif isfinite(goal_precision(plan, plan.best).percent):
        which = f"no set of up to {plan.search.most} tests" if plan.search.most > 1 else "no single test"
        said = f"{which} knows the damping ratio within {wanted}; "
        said += f"the best: {_told(plan, plan.best)}"
    else:
        said = "no test tells anything of the damping: its effect is nowhere seen apart from what else is unknown"
    found = [said, _how_found(plan)]
    rig = surveyed.rig
    ratio = f"the damping ratio is {number(surveyed.ratio_percent)} % of critical at a velocity amplitude of "
    ratio += f"{_with_unit(float(rig.velocity), rig.model.system.unit_of('m/s'), 3)}, by {rig.damping.name}"
    found.append(ratio + (", its exponent unknown" if goal.joint else "") + _elsewhere(plan))
    if WIDE < goal_precision(plan, chosen or plan.best).percent < inf:
        found.append(f"beyond ± {WIDE:g} % some estimates run off to no damping at all: no interval is promised there")
    lost = int((~surveyed.fine).sum())
    if lost:
        text = f"{lost} of {surveyed.fine.numel()} tests diverge or move irregularly in simulation"
        found.append(f"{text}: nothing can be promised for them")
    return found


def _elsewhere(plan: TestPlan) -> str:
    """What is said where tests of an oscillator begin far from the amplitude that its damping ratio is stated at."""
    rig = plan.survey.rig
    if not rig.model.system.has(Trait.REST):
        return ""
    stated, unit = float(rig.values["amplitude"][0]), rig.model.system.unit_of("m")
    own = float(rig.values[START][0])
    starts = sorted({abs(one.get(START, own)) for one in plan.survey.settings})
    if not any(is_far(stated, one) for one in starts):
        return ""
    begin = " … ".join(_with_unit(one, unit, 3) for one in dict.fromkeys((starts[0], starts[-1])))
    return (
        f", which is that of the rig's amplitude, {_with_unit(stated, unit, 3)}; the tests begin at {begin}, "
        "and a damping that depends on the amplitude is another one there"
    )


def goal_precision(plan: TestPlan, told: ToldTest) -> Precision:
    """The one that the goal is about."""
    return told.joint if plan.asked.goal.joint and told.joint is not None else told.alone


def table(plan: TestPlan, most: int | None = None) -> str:
    """Tests, then sets, 100 columns wide."""
    rows = sorted(plan.single, key=lambda one: goal_precision(plan, one).percent)
    shown = list(plan.single) if most is None or most >= len(rows) else rows[:most]
    left = f"; {len(shown)} of {len(rows)}, those that tell most" if len(shown) < len(rows) else ""
    axes = list(plan.survey.settings[0])
    columns = (*(_shown_in(plan, name)[0] or "amplitude" for name in axes), "s", "sensors", *_precisions(plan), "cost")
    text = plan_table(f"halves of 95 % intervals of the damping ratio, in % of it{left}", columns,
                      [_row(plan, one) for one in shown])  # fmt: skip
    front = _thinned(plan, list(plan.front))
    sets = [(number(one.cost), *_cells(plan, one), _sensors(plan, one), "; ".join(_settings(plan, one)))
            for one in front]  # fmt: skip
    columns = ("cost", *_precisions(plan), "sensors", "tests")
    return text + "\n" + plan_table("what more money buys: the best set at its price", columns, sets)


def picture(plan: TestPlan, found: IntervalMap | None, curves: IntervalCurves | None) -> PlanPicture:
    """What a figure shows."""
    settings, chosen = plan.survey.settings, plan.cheapest or plan.best
    numbers = [setting for setting, _ in chosen.tests]
    if found is not None:
        points = [(one["pinion_speed"] * RPM, one["pinion_torque"]) for one in settings]
        chosen_points = sorted({*numbers})
        shown: PlanMap | PlanCurves = PlanMap(found.speeds * RPM, found.torques, found.percent, points, chosen_points)
    else:
        labels = [
            ", ".join(_axis(plan, name, value) for name, value in one.items()) or "as configured" for one in settings
        ]
        seconds = [(setting, plan.survey.lengths[length] / plan.survey.tests.sampling_rate)
                   for setting, length in chosen.tests]  # fmt: skip
        shown = PlanCurves(curves.durations, curves.percent, labels, seconds)
    title = f"half of the 95 % interval of the damping ratio{', exponent unknown' if plan.asked.goal.joint else ''}"
    if found is not None:
        longest = plan.survey.lengths[-1] / plan.survey.tests.sampling_rate
        title += f"; records of {number(longest)} s{', all sensors' if len(plan.asked.sensors) > 1 else ''}"
    return PlanPicture(title, plan.asked.goal.percent, plan.cheapest is not None, shown)


def _plain(plan: TestPlan, told: ToldTest) -> dict[str, Any]:
    rate = plan.survey.tests.sampling_rate
    return {
        "tests": [{**_setting(plan, plan.survey.settings[setting]), "duration_s": plan.survey.lengths[length] / rate}
                  for setting, length in told.tests],
        "sensors": [plan.asked.sensors[n].name for n in told.sensors],
        "exponent_known": _halves(told.alone),
        "exponent_unknown": None if told.joint is None else _halves(told.joint),
        "cost": told.cost,
    }  # fmt: skip


def _setting(plan: TestPlan, one: dict[str, float]) -> dict[str, float]:
    system, keys = plan.survey.rig.model.system, {"pinion_speed": "speed_rpm", "pinion_torque": "torque_nm"}
    found = {keys[name]: value * AXES[name][1] for name, value in one.items() if name in keys}
    own = [_in_metres(system, "amplitude", "m", value) for name, value in one.items() if name not in keys]
    return found | (own[0] if own else {})


def _in_metres(system: System, name: str, unit: str, value: float) -> dict[str, float]:
    """A value with its unit in the key; without one where it is in another, which `unit` of the rig says."""
    return {f"{name}_{unit.replace('/', '_')}" if system.unit_of(unit) == unit else name: value}


def _shown_in(plan: TestPlan, name: str) -> tuple[str, float]:
    """The unit that an axis is shown in, "" for one that nobody knows, and how many are in one of its values."""
    return AXES.get(name) or (pretty_unit(plan.survey.rig.model.system.unit_of("m")), 1.0)


def _with_unit(value: float, unit: str, digits: int = 4) -> str:
    return f"{number(value, digits)} {pretty_unit(unit)}".strip()


def _halves(one: Precision) -> dict[str, float | None]:
    """Those that are not finite become null in a file."""
    return {
        "half_interval95_percent_of_critical": one.damping_ratio,
        "half_interval95_percent_of_ratio": one.percent,
        "half_interval95_exponent": one.exponent,
    }


def _told(plan: TestPlan, told: ToldTest) -> str:
    precise = goal_precision(plan, told)
    text = f"{'; '.join(_settings(plan, told))}; with {_named(plan, told)}; ± {number(precise.percent, 3)} %"
    if precise.exponent is not None:
        text += f", exponent ± {number(precise.exponent, 3)}"
    return f"{text}; cost {number(told.cost)}"


def _settings(plan: TestPlan, told: ToldTest) -> Iterator[str]:
    rate = plan.survey.tests.sampling_rate
    for (setting, length), times in Counter(told.tests).items():
        where = [_axis(plan, name, value) for name, value in plan.survey.settings[setting].items()]
        text = ", ".join([*where, f"{number(plan.survey.lengths[length] / rate)} s"])
        yield f"{times} × {text}" if times > 1 else text


def _axis(plan: TestPlan, name: str, value: float) -> str:
    unit, factor = _shown_in(plan, name)
    return f"{number(value * factor)} {unit}".strip()


def _sensors(plan: TestPlan, told: ToldTest) -> str:
    if 1 < len(told.sensors) == len(plan.asked.sensors):
        return "all"
    return " + ".join(plan.asked.sensors[n].name for n in told.sensors)


def _named(plan: TestPlan, told: ToldTest) -> str:
    return " and ".join(plan.asked.sensors[n].name for n in told.sensors)


def _how_found(plan: TestPlan) -> str:
    found = plan.search
    if found.exact_to >= found.most:
        every = f"every set of up to {found.most} tests" if found.most > 1 else "every test"
        told = "none that reaches it is cheaper" if plan.cheapest is not None else "none reaches it"
        return f"{every} was tried, {found.tried} sets: {told}"
    text = f"every set of up to {found.exact_to} tests was tried; larger ones, up to {found.most}, grew test by test "
    return text + f"({found.tried} sets in all): a cheaper one of more than {found.exact_to} tests may exist"


def _precisions(plan: TestPlan) -> tuple[str, ...]:
    return ("± %, n known", "± %, n free", "± n") if plan.survey.rig.exponent else ("± %",)


def _cells(plan: TestPlan, told: ToldTest) -> tuple[str, ...]:
    cells = [number(told.alone.percent, 3)]
    if told.joint is not None:
        cells += [number(told.joint.percent, 3), number(told.joint.exponent, 3)]
    return tuple(cells)


def _row(plan: TestPlan, told: ToldTest) -> tuple[str, ...]:
    setting, length = told.tests[0]
    where = [number(value * _shown_in(plan, name)[1]) for name, value in plan.survey.settings[setting].items()]
    seconds = number(plan.survey.lengths[length] / plan.survey.tests.sampling_rate)
    return (*where, seconds, _sensors(plan, told), *_cells(plan, told), number(told.cost))


def _thinned(plan: TestPlan, sets: list[ToldTest]) -> list[ToldTest]:
    """So many as a reader looks through, the first and the last among them; each tells clearly more than the last."""
    kept = sets[:1]
    for one in sets[1:]:
        kept += [one] if LEAST_GAIN * goal_precision(plan, one).percent < goal_precision(plan, kept[-1]).percent else []
    sets = kept
    if len(sets) <= MOST_OF_FRONT:
        return sets
    return [sets[round(n * (len(sets) - 1) / (MOST_OF_FRONT - 1))] for n in range(MOST_OF_FRONT)]
