"""What explanation.json holds of a casing: findings and families, no cause."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from gear_damping.errors import InputError, Problem
from gear_damping.explanation.casing import findings
from gear_damping.explanation.casing.heard import NAMES, heard_of
from gear_damping.explanation.casing.localised import DRAWS
from gear_damping.explanation.casing.study import Study, study
from gear_damping.explanation.steps.judge import CONSISTENT, UNEXPLAINED
from gear_damping.measurement.record import Measurement

REFERENCE = "reference"
MOST_DRAWS = 20_000  # enough for a chance of 1 in 10 000, in a second
UNSTEADY = 0.1  # relative range of the speed: beyond, mesh lines cross whole resonances of the path
SENSOR = (
    "Measure the transmission error with an encoder on each shaft, or the acceleration tangentially on a shaft: "
    "a casing is heard through a path that nobody knows, so that no size and no cause can be read from it."
)
NOTHING = "No cause is established: a casing is heard through an unknown path."
Content = dict[str, Any]


@dataclass(frozen=True)
class CasingStudy:
    """The studies behind the content, for the figures.

    Args:
        records: Those that were judged.
        references: Those of `role: reference`.
    """

    records: tuple[Study, ...]
    references: tuple[Study, ...]


def explain_casing(measurement: Measurement, log: Callable[[str], None]) -> tuple[Content, CasingStudy]:
    """The parts of the content that a casing fills, and the studies.

    Raises:
        InputError: a record has no shaft angle, cannot be read, or all are references.
    """
    heard = heard_of(measurement)
    judged = [one for one in heard if one.role != REFERENCE]
    if not judged:
        rule, remedy = "every record is a reference", "declare the record that is to be judged without role: reference"
        raise InputError(Problem("records", rule, None, remedy, str(measurement.source)))
    with_reference = len(judged) < len(heard)
    limit = findings.limit_of(len(judged), with_reference)
    draws = min(MOST_DRAWS, max(DRAWS, int(2 / limit)))
    made = [study(one, draws) for one in heard]
    for one in made:
        log(f"{one.heard.name}: {one.heard.turns:.4g} turns of the pinion at {60 * one.heard.speed:.4g} rpm")
    records = tuple(one for one in made if one.heard.role != REFERENCE)
    references = tuple(one for one in made if one.heard.role == REFERENCE)
    return _content(measurement, records, references, limit), CasingStudy(records, references)


def _content(measurement: Measurement, records: Sequence[Study], references: Sequence[Study], limit: float) -> Content:
    found = [entry for one in records for entry in findings.of_record(one, limit)]
    changed = None
    if references:
        changed = [entry for one in records for entry in findings.what_changed(one, references, limit)]
    families = [_family(name, found, changed or ()) for name in findings.FAMILIES]
    flagged = [family for family in families if family["flagged"]]
    said = [family["sentence"] for family in flagged] or ["Nothing stands out that sound gears do not show."]
    said += [] if references else ["There is no record of role: reference, so that slow wear would not be seen."]
    said += [_unsteady(one) for one in records if one.heard.fluctuation > UNSTEADY]
    missing = [name for name in NAMES if name not in measurement.parameters]
    if missing:
        teeth = dict(zip(NAMES, records[0].heard.teeth, strict=True))
        said.append(f"Not stated and taken from the default: {', '.join(f'{n} = {teeth[n]}' for n in missing)}.")
    if unused := _unused(measurement):
        said.append(f"A casing needs the teeth and the angle alone; declared and not used: {', '.join(unused)}.")
    return {
        "verdict": UNEXPLAINED if flagged else CONSISTENT,
        "sentences": [*said, NOTHING],
        "next_experiment": {"what": SENSOR, "separates": [], "predicted_separation": None},
        "casing": {
            "families": families,
            "findings": found,
            "what_changed": changed,
            "records": {one.heard.name: _record(one) for one in (*records, *references)},
            "family_wise_error": findings.ALPHA,
            "sensor": SENSOR,
        },
    }


def _unused(measurement: Measurement) -> list[str]:
    """What the file declares that says nothing of a casing."""
    found = [name for name in measurement.parameters if name not in NAMES]
    found += ["segments"] if measurement.segment_s else []
    roles = {record.role for record in measurement.records} - {REFERENCE, None}
    found += [f"role: {role}" for role in sorted(roles)]
    given = (name for record in measurement.records for name in record.conditions)
    return [*found, *dict.fromkeys(name for name in given if name.endswith("torque"))]


def _unsteady(one: Study) -> str:
    return (
        f"{one.heard.name}: the speed varies by {100 * one.heard.fluctuation:.2g} %, and the path with it: "
        "cut out a steadier stretch with slice."
    )


def _family(name: str, found: Sequence[Content], changed: Sequence[Content]) -> Content:
    """A family over all records: flagged where any of its tests is."""
    own = [entry for entry in (*found, *changed) if entry["family"] == name]
    tested = [entry for entry in own if entry["p"] is not None and entry.get("statistic") != "pattern_of_the_turn"]
    flagged = [entry for entry in tested if entry["flagged"]]
    least = min(tested, key=lambda entry: entry["p"], default=None)
    several = len({entry["record"] for entry in own}) > 1
    said = [f"{entry['record']}: {entry['sentence']}" if several else entry["sentence"] for entry in flagged]
    return {
        "name": name,
        "flagged": bool(flagged),
        "p": least["p"] if least else None,
        "limit": least["limit"] if least else None,
        "records": list(dict.fromkeys(entry["record"] for entry in flagged)),
        "sentence": f"{name[0].upper()}{name[1:]}: {' '.join(said)}" if flagged else "",
    }


def _record(one: Study) -> Content:
    heard = one.heard
    return {
        "role": heard.role,
        "turns": heard.turns,
        "speed_rpm": 60 * heard.speed,
        "teeth": {"pinion": heard.teeth[0], "gear": heard.teeth[1]},
        "orders": heard.orders,
        "lines": [
            asdict(line) | {"unit": heard.unit} for line in one.lines
        ],
        "kurtosis_by_revolution": {"values": one.kurtosis.tolist(), "limit": one.kurtosis_limit},
        "modulation": {
            shaft: {
                "mesh_harmonic": found.harmonic, "amplitude": float(abs(found.amplitude).max()),
                "phase_rad": float(abs(found.phase).max()),
            }
            for shaft, found in one.modulation.items()
        },
        "envelope_at_shaft_order": one.envelope,
    }  # fmt: skip
