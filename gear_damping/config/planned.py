"""The `plan` node: tests that could be made, sensors, what is unknown, what is wanted and what tests cost."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from gear_damping.config.quantities import quantity, split_suffix
from gear_damping.config.reader import Reader
from gear_damping.config.simulator import SimulatorSettings
from gear_damping.config.source import ORDER, Origin
from gear_damping.errors import InputError, nearest, with_article
from gear_damping.identification.test_plan.asked import PlanCosts, PlanGoal, PlannedSensor, PlannedTests, Unknown
from gear_damping.identification.test_plan.channels import channels_of
from gear_damping.physics.parameter import Parameter
from gear_damping.schema.values import Flag, Given, Number, Text
from gear_damping.units import spoken

AXES = {
    "speeds": Parameter("speeds", "rad/s", None, "speeds of the pinion", vector=True),
    "torques": Parameter("torques", "N*m", None, "torques on the pinion", vector=True),
    "amplitudes": Parameter("amplitudes", "m", None, "displacements at the start", vector=True),
    "durations": Parameter("durations", "s", None, "lengths of the records", 0, 1e6, vector=True),
    "settle": Parameter("settle", "s", None, "time before the record", 0, 1e6),
}
PLAIN = {
    "joint": Flag(),
    "wanted_percent": Number(0, 1000, exclusive=True),
    "wanted_exponent": Given(Number(0, 100, exclusive=True), optional=True),
    "most_tests": Number(1, 100, whole=True),
    "repeats": Number(1, 100, whole=True),
    "simulated_tests": Number(0, 1_000_000, whole=True),
}
COSTS = {name: Number(0, 1e12) for name in ("per_test", "per_second", "per_speed", "per_torque")}
SENSOR = {
    "snr_db": Given(Number(-40, 200, unit="dB"), optional=True),
    "channel": Given(Text(), optional=True),
    "offset": Given(Flag(), optional=True),
    "cost": Given(Number(0, 1e12), optional=True),
}
ASSUMED = "response"  # the sensor of conf/plan
GROUPS = ("sensors", "unknown", "unknown_each", "cost")


@dataclass(frozen=True)
class PlanSettings:
    """What task=plan is told, in SI.

    Args:
        tests: That could be made.
        sensors: That could be mounted.
        unknown: Beside the damping.
        goal: What is wanted, and what tests cost.
        simulated_tests: That check the chosen set; 0 for none.
    """

    tests: PlannedTests
    sensors: tuple[PlannedSensor, ...]
    unknown: tuple[Unknown, ...]
    goal: PlanGoal
    simulated_tests: int


def read_plan(node: Mapping[str, Any], simulator: SimulatorSettings, origin: Origin) -> PlanSettings:
    """The settings of the node.

    Raises:
        InputError: everything that is wrong with it.
    """
    reader = Reader(origin)
    for key in node:
        if split_suffix(key, AXES)[0] not in AXES and key not in (*PLAIN, *GROUPS):
            reader.refuse_unknown(f"plan.{key}", [*AXES, *PLAIN, *GROUPS])
    system = simulator.model.system
    axes = {name: replace(one, unit=system.unit_of(one.unit)) for name, one in AXES.items()}
    given = reader.parameters(_last_said(reader, node, axes, "plan."), axes, "plan.")
    plain = reader.plain(node, PLAIN, "plan.")
    costs = _group(reader, node, "cost")
    for key in set(costs) - set(COSTS):
        reader.refuse_unknown(f"plan.cost.{key}", COSTS)
    prices = reader.plain(costs, COSTS, "plan.cost.")
    mounted = _mounted(_group(reader, node, "sensors"), origin)
    sensors = [_sensor(reader, name, one, simulator) for name, one in mounted.items()]
    unknown = [_unknown(reader, one, key, simulator) for key in ("unknown", "unknown_each")
               for one in _listed(reader, node, key)]  # fmt: skip
    if not given.get("durations") and not any(one.key.startswith("plan.durations") for one in reader.problems):
        reader.refuse("plan.durations", "must be given", None, "for example plan.durations=[0.05,0.2]")
    if reader.problems:
        raise InputError(reader.problems)
    lists = {name: tuple(given.get(name, ())) for name in ("speeds", "torques", "amplitudes", "durations")}
    goal = PlanGoal(
        percent=plain["wanted_percent"],
        joint=plain["joint"],
        exponent=plain["wanted_exponent"],
        most_tests=plain["most_tests"],
        repeats=plain["repeats"],
        costs=PlanCosts(**prices),
        law=simulator.damping_law,
    )
    tests = PlannedTests(sampling_rate=simulator.sampling_rate, settle=given.get("settle"), **lists)
    return PlanSettings(tests, tuple(sensors), tuple(unknown), goal, plain["simulated_tests"])


def _mounted(sensors: Mapping[str, Any], origin: Origin) -> dict[str, Any]:
    """Sensors that are not taken out; the assumed one gives way to those that somebody names."""
    found = {name: one for name, one in sensors.items() if one is not None}
    is_assumed = origin.rank(f"plan.sensors.{ASSUMED}") <= ORDER.index("plan")
    return {name: one for name, one in found.items() if name != ASSUMED or len(found) == 1 or not is_assumed}


def _last_said(reader: Reader, node: Mapping[str, Any], known: Mapping[str, Any], prefix: str) -> dict[str, Any]:
    """The keys that give values, without those that a later null takes back."""
    found = dict(node)
    for name in known:
        spelled = [key for key in node if split_suffix(key, known)[0] == name]
        taken_back = max((reader.origin.rank(prefix + key) for key in spelled if node[key] is None), default=-1)
        for key in spelled:
            if node[key] is None or reader.origin.rank(prefix + key) < taken_back:
                del found[key]
    return found


def _group(reader: Reader, node: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    found = node.get(name)
    if isinstance(found, Mapping):
        return found
    reader.refuse(f"plan.{name}", "is a group of keys", found, f"give plan.{name}.<key>")
    return {}


def _listed(reader: Reader, node: Mapping[str, Any], name: str) -> list[Any]:
    found = node.get(name)
    if found is None or isinstance(found, list):
        return found or []
    reader.refuse(f"plan.{name}", "must be a list of parameters", found, "write [inertia_gear]")
    return []


def _sensor(reader: Reader, name: str, node: Any, simulator: SimulatorSettings) -> PlannedSensor | None:
    prefix = f"plan.sensors.{name}."
    if not isinstance(node, Mapping):
        reader.refuse(prefix[:-1], "must be null (left out) or hold keys", node, f"give {prefix}snr_db=30")
        return None
    found = reader.plain(node, SENSOR, prefix)
    channels = channels_of(simulator.model.system)
    sees = found["channel"] or name
    if sees not in channels:
        key = prefix + "channel" if found["channel"] else prefix[:-1]
        reader.refuse(
            key, f"sees no channel of {with_article(simulator.model.system.name)}", sees, nearest(sees, list(channels))
        )
        return None
    noise = {"noise": Parameter("noise", channels[sees], None, "standard deviation of its noise", 0, 1e300)}
    for key in node:
        if split_suffix(key, noise)[0] not in noise and key not in SENSOR:
            reader.refuse_unknown(prefix + key, [*SENSOR, *noise])
    level = reader.parameters(_last_said(reader, node, noise, prefix), noise, prefix).get("noise")
    snr_db = found["snr_db"]
    if level is not None and snr_db is not None:  # what was said last counts
        said = max(reader.origin.rank(prefix + key) for key in node if split_suffix(key, noise)[0] in noise)
        later = said - reader.origin.rank(prefix + "snr_db")
        level, snr_db = (level if later >= 0 else None), (snr_db if later <= 0 else None)
    return PlannedSensor(name, level, snr_db, sees, bool(found["offset"]), float(found["cost"] or 0))


def _unknown(reader: Reader, one: Any, key: str, simulator: SimulatorSettings) -> Unknown | None:
    full, each = f"plan.{key}", key == "unknown_each"
    if isinstance(one, str):
        return Unknown(one, each=each)
    if not isinstance(one, Mapping) or not isinstance(one.get("name"), str) or set(one) - {"name", "deviation"}:
        reader.refuse(full, "must name parameters", one, "write a name, or {name: pinion_torque, deviation: 1 %}")
        return None
    declared, deviation = simulator.model.parameters(), one.get("deviation")
    if deviation is None or one["name"] not in declared:  # the plan itself knows the names
        return Unknown(one["name"], each=each)
    if (said := spoken(deviation)) and said[1] == "%":
        return Unknown(one["name"], percent=said[0], each=each)
    if isinstance(deviation, Mapping) and deviation.get("unit") == "%":
        percent = reader.collect(lambda: 100 * quantity(deviation, "1", full, reader.origin.of(full)))
        return Unknown(one["name"], percent=percent, each=each)
    unit, place = simulator.model.system.unit_of(declared[one["name"]].unit), f"{full}.{one['name']}"
    found = reader.collect(lambda: quantity(deviation, unit, place, reader.origin.of(full)))
    return Unknown(one["name"], found, each=each)
