"""What was found, as entries of `casing.findings`: statistic, probability or limit, order, shaft, sentence.

Tests that can raise a flag share one family-wise error: each is held to `ALPHA` over their number.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from gear_damping.explanation.casing.compare import (
    ASYNCHRONOUS,
    AT_MESH,
    FACTOR,
    GEAR,
    PINION,
    Change,
    at_one_speed,
    changes,
    na4,
)
from gear_damping.explanation.casing.cycles import SHAFTS
from gear_damping.explanation.casing.orders import mesh_elsewhere
from gear_damping.explanation.casing.study import Study

ALPHA = 0.01  # of any false flag in a measurement
FAMILIES = (PINION, GEAR, AT_MESH, ASYNCHRONOUS)
ONCE = {"pinion": PINION, "gear": GEAR}
TESTS = 3  # a record: one tooth of either shaft, one line at no shaft's order
PART_OF_MESH = 2e-3  # of an order: lines are known to a part of their width
COMPARED = 5  # tests a record beside references
Entry = dict[str, Any]


def limit_of(records: int, compared: bool) -> float:
    """The probability below which a test raises a flag."""
    return ALPHA / (records * (TESTS + COMPARED * compared))


def of_record(study: Study, limit: float) -> list[Entry]:
    """The findings of one record."""
    found = [entry for shaft in SHAFTS for entry in _of_shaft(study, shaft, limit)]
    return [*found, _at_the_mesh(study), _asynchronous(study, limit)]


def _of_shaft(study: Study, shaft: str, limit: float) -> list[Entry]:
    common = {"record": study.heard.name, "family": ONCE[shaft], "shaft": shaft, "order": study.heard.orders[shaft]}
    found = [_one_tooth(study, shaft, common, limit)]
    there, average = study.presence[shaft], study.averages[shaft]
    if there is not None:
        repeats = there.p <= limit
        said = f"The {there.turns} turns of the {shaft} {'share a' if repeats else 'show no common'} pattern "
        said += (
            "beside the mesh; sound gears have one too, of runout and pitch errors." if repeats else "beside the mesh."
        )
        found.append(_Tested("pattern_of_the_turn", there.ratio, there.p, limit).said(common, said))
    said = f"FM4 of the {shaft}'s average is {average.fm4:.3g}; "
    said += f"99 % of sound gears with this spectrum stay below {average.fm4_limit:.3g}."
    found.append(_Tested("fm4", average.fm4, None, average.fm4_limit).said(common, said))
    return found


def _one_tooth(study: Study, shaft: str, common: Entry, limit: float) -> Entry:
    one = study.one_tooth[shaft]
    if one is None:
        said = f"The record holds too few turns of the {shaft}, or its turns repeat with the other shaft: one tooth "
        said += "cannot be told from the others."
        return _Tested("one_tooth_stands_out", limit=limit).said(common, said)
    flagged = one.p <= limit
    said = f"A window of {one.window:g} mesh periods holds {100 * one.share:.2g} % of the energy of the {shaft}'s "
    said += f"pattern ({100 * one.usual:.2g} % is usual in sound gears)"
    burst = f": a burst once per turn of the {shaft}, {one.tooth:.3g} teeth after the zero of its angle."
    tested = _Tested("one_tooth_stands_out", one.share, one.p, limit, flagged)
    found = tested.said(common, said + (burst if flagged else "."))
    return found | {"usual": one.usual, "tooth": one.tooth, "window_mesh_periods": one.window}


@dataclass(frozen=True)
class _Tested:
    """A statistic with what is held against it.

    Args:
        statistic: Its name.
        value: Its value; None: it could not be worked out.
        p: Its probability in a sound gear; None where only a limit is known.
        limit: Of the probability, or of the value.
        flagged: Whether it raises a flag.
    """

    statistic: str
    value: float | None = None
    p: float | None = None
    limit: float | None = None
    flagged: bool = False

    def said(self, common: Entry, sentence: str) -> Entry:
        """The entry of it."""
        return common | asdict(self) | {"sentence": sentence}


def _at_the_mesh(study: Study) -> Entry:
    whole = float((study.plain.cut**2).mean())
    share = float((study.plain.mesh**2).mean()) / whole if whole else 0.0
    order = study.heard.orders["mesh"]
    common = {"record": study.heard.name, "family": AT_MESH, "shaft": None, "order": order}
    said = f"The mesh (order {order:g} and its harmonics) holds {100 * share:.3g} % of the signal; every pair has it."
    if teeth := mesh_elsewhere(study.heard, study.orders, study.amplitude):
        said = f"The mesh (order {order:g}) hardly stands out, and orders {teeth}, {2 * teeth} and {3 * teeth} do: "
        said += "check n_teeth_pinion, which shaft the angle is of, and its pulses a turn."
    return _Tested("share_of_energy", share).said(common, said)


def _asynchronous(study: Study, limit: float) -> Entry:
    line = study.asynchronous
    common = {"record": study.heard.name, "family": ASYNCHRONOUS, "shaft": None}
    if line is None:
        said = "No line stands out that belongs to neither shaft."
        return _Tested("line_over_floor", limit=limit).said(common | {"order": None}, said)
    flagged = line.p <= limit
    hertz = line.order * study.heard.speed
    said = f"A line at order {line.order:.4g} ({hertz:.4g} Hz), which is no order of either shaft, "
    said += "stands out: a bearing, a belt, another machine or the mains" if flagged else "is no more than chance"
    times = study.heard.orders["mesh"] / line.order
    if flagged and round(times) > 1 and abs(times / round(times) - 1) < PART_OF_MESH:
        said += f"; or the mesh, where a turn of the pinion has {round(times)} times as many pulses as are declared"
    said += "."
    tested = _Tested("line_over_floor", line.ratio, line.p, limit, flagged)
    return tested.said(common | {"order": line.order}, said)


def what_changed(study: Study, references: Sequence[Study], limit: float) -> list[Entry]:
    """The levels of a record beside its references; flagged from a factor of two on, at one speed."""
    same = at_one_speed(study, references)
    levels = changes(study, references)
    found = [_changed(change, limit, same) for change in levels]
    grown = max((change.factor for change in levels if change.family != ASYNCHRONOUS), default=0.0)
    for entry in found:  # a burst is never quite alike in all turns: what it leaves is no sign of its own
        entry["flagged"] &= entry["family"] != ASYNCHRONOUS or entry["factor"] > grown
    for shaft in SHAFTS:
        value, top = na4(study, references, shaft), study.averages[shaft].fm4_limit
        said = f"NA4 of the {shaft}'s residual over its reference is {value:.3g}; "
        said += f"a sound pattern that has not grown stays below {top:.3g}."
        found.append(
            {"record": study.heard.name, "what": f"NA4 of the {shaft}", "family": ONCE[shaft], "reference": None}
            | {"now": value, "unit": "1", "factor": None, "p": None, "limit": top, "flagged": False, "sentence": said}
        )
    return found


def _changed(change: Change, limit: float, same_speed: bool) -> Entry:
    grown = change.factor >= FACTOR or (change.family == AT_MESH and change.factor <= 1 / FACTOR)
    flagged = bool(change.p <= limit and grown and same_speed and change.unit != "1")
    said = f"{change.what[0].upper()}{change.what[1:]}: {change.factor:.3g} times the reference"
    said += "." if change.p <= limit else ", within the scatter between turns."
    if change.p <= limit and not same_speed:
        said += " The speed is another one than in the reference, and so is the path: compare at one speed."
    return {
        "record": change.record, "what": change.what, "family": change.family, "reference": change.reference,
        "now": change.now, "unit": change.unit, "factor": change.factor, "p": change.p, "limit": limit,
        "flagged": flagged, "sentence": said,
    }  # fmt: skip
