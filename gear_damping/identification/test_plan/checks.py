"""What cannot be planned, said before anything is simulated."""

from collections.abc import Iterator, Sequence
from dataclasses import fields
from math import isfinite

from gear_damping.errors import InputError, Problem, nearest, with_article
from gear_damping.identification.test_plan.asked import PlanCosts, PlanGoal, PlannedSensor, PlannedTests, Unknown
from gear_damping.identification.test_plan.channels import channels_of
from gear_damping.identification.test_plan.rig import Rig
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import HeldLoad

MOST_SENSORS = 6  # 63 ways to choose from them
LEAST_SAMPLES = 16  # of a record: with fewer than twice the unknowns there is nothing to learn
NOISY = ("sensor_noise", "sensor_quantisation", "sensor_saturation")  # sensor effects that have no slope
SPLIT = {"pinion_speed": "speeds", "pinion_torque": "torques", "initial_displacement": "amplitudes"}  # by parameter


def refuse(rig: Rig, tests: PlannedTests, sensors: Sequence[PlannedSensor], unknown: Sequence[Unknown]) -> None:
    """Refuse a plan that cannot be worked out.

    Raises:
        InputError: everything that is wrong with it.
    """
    problems = [*_of_rig(rig), *_of_tests(rig, tests), *_of_sensors(rig, sensors), *_of_unknown(rig, tests, unknown)]
    if problems:
        raise InputError(problems)


def refuse_goal(rig: Rig, goal: PlanGoal) -> None:
    """Refuse a goal that no plan of this rig can have.

    Raises:
        InputError: everything that is wrong with it.
    """
    problems = []
    if not goal.percent > 0:
        problems.append(Problem("plan.wanted_percent", "must be positive", goal.percent))
    if goal.joint and rig.exponent is None:
        rule = f"asks for an exponent, and {rig.damping.name} has none"
        problems.append(Problem("plan.joint", rule, goal.joint, "leave it out, or choose power_law_damping"))
    if goal.exponent is not None and not goal.joint:
        rule = "is of an exponent that counts as known"
        problems.append(Problem("plan.wanted_exponent", rule, goal.exponent, "add plan.joint=true"))
    elif goal.exponent is not None and not goal.exponent > 0:
        problems.append(Problem("plan.wanted_exponent", "must be positive", goal.exponent))
    for name in ("most_tests", "repeats"):
        if getattr(goal, name) < 1:
            problems.append(Problem(f"plan.{name}", "must be 1 or more", getattr(goal, name)))
    for one in fields(PlanCosts):
        cost = getattr(goal.costs, one.name)
        if not (isfinite(cost) and cost >= 0):
            problems.append(Problem(f"plan.cost.{one.name}", "must be 0 or more", cost))
    if not rig.model.system.has(Trait.SHAFTS):
        for name in ("per_speed", "per_torque"):
            if getattr(goal.costs, name):
                problems.append(Problem(f"plan.cost.{name}", "has no effect: an oscillator does not turn", None))
    if problems:
        raise InputError(problems)


def _of_rig(rig: Rig) -> Iterator[Problem]:
    for effect in rig.model.effects:
        key = f"simulator.{effect.name}"
        if effect.name in NOISY:
            remedy = f"switch it off ({key}=null) and say its noise in plan.sensors; a step q makes q/sqrt(12)"
            yield Problem(key, "has no slope that a plan could follow", None, remedy)
        elif isinstance(effect, HeldLoad):
            rule = "drives the motion by what nobody knows: no interval follows from the noise of sensors alone"
            yield Problem(key, rule, None, f"switch it off: {key}=null")
    ratio = float(rig.ratio_percent(rig.values))
    if not (isfinite(ratio) and ratio > 0):
        rule = "has no damping ratio of which an interval could be planned"
        yield Problem(f"simulator.{rig.coefficient}", rule, ratio, "give it a positive value, and the rig a stiffness")


def _of_tests(rig: Rig, tests: PlannedTests) -> Iterator[Problem]:
    gears = rig.model.system.has(Trait.SHAFTS)
    planned = {name: getattr(tests, name) for name in ("durations", *SPLIT.values())}
    alone = {name: one for name, one in planned.items() if isinstance(one, int | float)}
    for name, one in alone.items():
        yield Problem(f"plan.{name}", "must be a list", one, f"write [{one:g}]")
    if alone:
        return
    if not tests.durations:
        yield Problem("plan.durations", "must be given", None, "for example plan.durations=[0.05,0.2]")
    for parameter, name in SPLIT.items():
        values = getattr(tests, name)
        key = f"plan.{name}"
        if values and gears == (name == "amplitudes"):
            what, other = ("a gear pair", "speeds and torques") if gears else ("an oscillator", "amplitudes")
            yield Problem(key, f"is nothing that {what} has", list(values), f"leave it out; it has {other}")
            continue
        if len(set(values)) < len(values):
            yield Problem(key, "names one value twice", list(values), "name it once; plan.repeats repeats tests")
        declared = rig.model.parameters().get(parameter)
        for value in values:
            found = declared.problem(value, key) if isinstance(declared, Parameter) else None
            yield from [found] if found else []
    if len(set(tests.durations)) < len(tests.durations):
        yield Problem("plan.durations", "names one value twice", list(tests.durations), "name it once")
    least = LEAST_SAMPLES / tests.sampling_rate
    for duration in tests.durations:
        if not duration >= least or not isfinite(duration):
            rule = f"must be {least:g} s or more: {LEAST_SAMPLES} samples at {tests.sampling_rate:g} Hz"
            yield Problem("plan.durations", rule, duration, "make it longer, or sample faster")
    if tests.settle is not None and not 0 <= tests.settle < 1e6:
        yield Problem("plan.settle", "must be 0 s or more", tests.settle)


def _of_sensors(rig: Rig, sensors: Sequence[PlannedSensor]) -> Iterator[Problem]:
    known = channels_of(rig.model.system)
    if not 0 < len(sensors) <= MOST_SENSORS:
        yield Problem("plan.sensors", f"must name 1 to {MOST_SENSORS} sensors", len(sensors))
    for sensor in sensors:
        key = f"plan.sensors.{sensor.name}"
        if sensor.sees not in known:
            end = ".channel" if sensor.channel else ""
            yield Problem(key + end, f"no channel of {with_article(rig.model.system.name)}", sensor.sees,
                          nearest(sensor.sees, list(known)))  # fmt: skip
        if (sensor.noise is None) == (sensor.snr_db is None):
            rule = "needs its noise: one of noise and snr_db"
            yield Problem(key, rule, None, f"for example {key}.snr_db=30, and {key}.noise=null")
        if sensor.noise is not None and not (isfinite(sensor.noise) and sensor.noise > 0):
            yield Problem(f"{key}.noise", "must be positive", sensor.noise, "without noise every test tells all")
        if not (isfinite(sensor.cost) and sensor.cost >= 0):
            yield Problem(f"{key}.cost", "must be 0 or more", sensor.cost)


def _of_unknown(rig: Rig, tests: PlannedTests, unknown: Sequence[Unknown]) -> Iterator[Problem]:
    declared = rig.model.parameters()
    known = [name for name, one in declared.items() if not one.vector and not name.startswith("initial_")]
    names = [one.name for one in unknown]
    varied = {parameter for parameter, name in SPLIT.items() if getattr(tests, name)}
    for one in unknown:
        key = "plan.unknown_each" if one.each else "plan.unknown"
        if one.name not in known:
            start = "the start of a record is always unknown; leave it out"
            remedy = start if one.name.startswith("initial_") else nearest(one.name, known)
            yield Problem(key, "no such parameter of the model", one.name, remedy)
            continue
        if names.count(one.name) > 1:
            yield Problem(key, "is named twice", one.name, "name it once")
        if one.name == rig.coefficient:
            yield Problem(key, "is what one wants to know", one.name, "leave it out")
        elif one.name == rig.exponent:
            yield Problem(key, "is the exponent of the law", one.name, "leave it out, and say plan.joint=true")
        elif one.name in varied and not one.each:
            rule = "is set anew in every test"
            yield Problem(key, rule, one.name, "name it under plan.unknown_each")
        for way in ("deviation", "percent"):
            value = getattr(one, way)
            if value is not None and not (isfinite(value) and value > 0):
                yield Problem(f"{key}.{one.name}", "what is known of it must be positive", value)
        if one.deviation is not None and one.percent is not None:
            yield Problem(f"{key}.{one.name}", "is known in two ways", one.percent, "say one of them")
        value = float(rig.values[one.name][0])
        if one.percent is not None and value == 0 and one.name not in varied:
            yield Problem(f"{key}.{one.name}", "is 0, of which there is no share", one.percent, "give its unit")
