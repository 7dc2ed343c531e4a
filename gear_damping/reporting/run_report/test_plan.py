"""The report of task=plan: the tests to make, and what each would tell of the damping."""

from collections.abc import Mapping, Sequence
from math import inf
from typing import Any

from gear_damping.reporting.numbers import NOTHING, number, pretty_unit
from gear_damping.reporting.page.picture import Picture
from gear_damping.reporting.page.table import Table
from gear_damping.reporting.run_report.report_schema import DOUBTFUL, FINE, Left, RunReport, Section

AXES = {"speed_rpm": "speed / rpm", "torque_nm": "torque / N·m", "amplitude_m": "amplitude / m"}
OWN = "amplitude"  # of a rig whose displacement is in no metres
PERCENT, EXPONENT = "half_interval95_percent_of_ratio", "half_interval95_exponent"
MOST_TESTS = 24  # rows of the table of tests; plan.txt has all


def report_of(left: Left) -> RunReport:
    """What a plan has come to."""
    content = left.read("plan.json")
    lead = [f"{one[0].upper()}{one[1:]}." for one in content["sentences"]]
    chosen = content["cheapest"] or content["best"]
    sections = [
        Section("The tests to make", (), [_chosen(content, chosen)], _map(left, content)),
        Section("What more money buys", (), [_sets(content)]),
        Section("Test by test", _not_listed(content), [_tests(content)]),
        Section("Sensors", (), [_sensors(content)]),
    ]
    state = DOUBTFUL if content["cheapest"] is None else FINE
    return RunReport("Test plan", f"Test plan of {left.name}", lead, state, sections)


def _axes(content: Mapping[str, Any]) -> list[str]:
    return [key for key in (*AXES, OWN) if key in content["best"]["tests"][0]]


def _where(content: Mapping[str, Any], test: Mapping[str, Any]) -> list[str]:
    return [*(number(test[key]) for key in _axes(content)), number(test["duration_s"])]


def _headings(content: Mapping[str, Any]) -> list[str]:
    return [*(_axis(content, key) for key in _axes(content)), "length / s"]


def _axis(content: Mapping[str, Any], key: str) -> str:
    """What stands above a column; without a unit where nobody knows it."""
    unit = pretty_unit(content.get("rig", {}).get("unit"))
    return AXES.get(key) or (f"{OWN} / {unit}" if unit else OWN)


def _precision(content: Mapping[str, Any]) -> list[str]:
    if content["best"]["exponent_unknown"] is None:
        return ["± %"]
    return ["± %, exponent known", "± %, exponent unknown", "± exponent"]


def _told(one: Mapping[str, Any]) -> list[str]:
    free = one["exponent_unknown"]
    found = [number(one["exponent_known"][PERCENT], 3)]
    return found if free is None else [*found, number(free[PERCENT], 3), number(free[EXPONENT], 3)]


def _wanted(content: Mapping[str, Any], one: Mapping[str, Any]) -> float | None:
    """What the plan is about, in % of the ratio: with the exponent of the law unknown, where it is."""
    free = one["exponent_unknown"] if content["wanted"]["exponent_unknown"] else None
    return (free or one["exponent_known"])[PERCENT]


def _mounted(content: Mapping[str, Any], one: Mapping[str, Any]) -> str:
    """Its sensors; of several that could be mounted, `all` where it has all."""
    return "all" if 1 < len(one["sensors"]) == len(content["sensors"]) else ", ".join(one["sensors"])


def _chosen(content: Mapping[str, Any], chosen: Mapping[str, Any]) -> Table:
    which = "The cheapest set that tells enough" if content["cheapest"] else "The set that tells most"
    rows = [(str(n), *_where(content, test)) for n, test in enumerate(chosen["tests"], start=1)]
    caption = f"{which}, with {', '.join(chosen['sensors'])}; cost {number(chosen['cost'])}."
    return Table(caption, ("test", *_headings(content)), rows)


def _sets(content: Mapping[str, Any]) -> Table:
    rows = [
        (number(one["cost"]), str(len(one["tests"])), *_told(one), _mounted(content, one)) for one in content["front"]
    ]
    precision = _precision(content)
    caption = "Sets none of which is both dearer and worse than another; ± is half of the 95 % interval in %."
    return Table(caption, ("cost", "tests", *precision, "sensors"), rows, range(2 + len(precision)))


def _listed(content: Mapping[str, Any]) -> Sequence[Mapping[str, Any]]:
    return sorted(content["tests"], key=lambda one: inf if (wanted := _wanted(content, one)) is None else wanted)


def _tests(content: Mapping[str, Any]) -> Table:
    rows = [
        (_mounted(content, one), *_where(content, one["tests"][0]), *_told(one), number(one["cost"]))
        for one in _listed(content)[:MOST_TESTS]
    ]
    headings = ("sensors", *_headings(content), *_precision(content), "cost")
    return Table("What each test tells by itself, those first that tell most.", headings, rows)


def _not_listed(content: Mapping[str, Any]) -> list[str]:
    left = len(content["tests"]) - MOST_TESTS
    return [f"{left} more stand in `plan.txt`."] if left > 0 else []


def _sensors(content: Mapping[str, Any]) -> Table:
    rows = [
        (
            f"`{one['name']}`",
            f"`{one['channel']}`",
            NOTHING if one["noise"] is None else f"{number(one['noise'])} {one['unit']}",
            NOTHING if one["snr_db"] is None else number(one["snr_db"]),
            "unknown" if one["offset_unknown"] else "none",
            number(one["cost"]),
        )
        for one in content["sensors"]
    ]
    headings = ("sensor", "channel", "noise", "SNR / dB", "offset", "cost")
    return Table("What could be mounted.", headings, rows, [2, 3, 5])


def _map(left: Left, content: Mapping[str, Any]) -> list[Picture]:
    values = [_wanted(content, one) for one in content["tests"]]
    known = [value for value in values if value is not None]
    ends = f"from {number(min(known), 3)} to {number(max(known), 3)} %" if known else "nowhere known"
    axes = [key for key in _axes(content) if len({one["tests"][0][key] for one in content["tests"]}) > 1]
    over = " and ".join(_axis(content, key).split(" /")[0] for key in axes)
    kind = f"Map over {over}" if len(axes) > 1 else "Line chart over the length of a record"
    alt = f"{kind}: half of the 95 % interval of the damping ratio, {ends} of it for the tests, which are marked."
    caption = "How well the damping would be known between the tests. The chosen ones are filled."
    return left.picture("plan_map.png", caption, alt)
