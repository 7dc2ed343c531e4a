"""What the records of a measurement.yaml must be beside each other."""

from collections.abc import Callable, Iterator

from gear_damping.errors import Problem
from gear_damping.measurement import layout
from gear_damping.measurement.structure import names

Found = Iterator[Problem]
Numbered = list[tuple[int, layout.AnyRecord]]


def inconsistencies_of_all(file: layout.AnyFile, records: Numbered) -> list[Problem]:
    """What does not hold together among the records, which are given with their places in the file."""
    rules = _OF_GEARS if isinstance(file, layout.GearFile) else _OF_OSCILLATORS
    return [problem for rule in rules for problem in rule(file, records)]


def given(model: object) -> dict[str, object]:
    """What a mapping of the file holds, by key."""
    return {} if model is None else {name: getattr(model, name) for name in names(type(model)) if model.given(name)}


def _compared(file: layout.AnyFile, records: Numbered) -> Found:
    if records and all(record.role == "reference" for _, record in records):
        rule = "every record is a reference, and none is there to be compared with them"
        yield Problem("records", rule, None, "leave out the role of the others")


def _held_out_apart(file: layout.AnyFile, records: Numbered) -> Found:
    """What is held out is never fitted: the same rows of the same columns, or the same time."""
    for k, held in records:
        others = ((i, one) for i, one in records if held.role == "holdout" and one.role in ("fit", None))
        for i, one in others:
            if one.file == held.file and _columns(one) & _columns(held) and (what := _both(one, held)):
                rule = f"is held out, and {what} of it are fitted in records[{i}]"
                yield Problem(f"records[{k}]", rule, None, "let the two end and begin at the same place")


def _columns(record: layout.AnyRecord) -> set[object]:
    """The columns of its channels that are no time."""
    columns = (getattr(channel, "column", None) for channel in given(record.channels).values())
    return {column for column in columns if column is not None}


def _both(one: layout.AnyRecord, other: layout.AnyRecord) -> str:
    """What two records of a file have in common; "" where that is nothing, or not known before it is read."""
    for words, spans in (("rows {} to {}", (one.slice, other.slice)),
                         ("{:g} s to {:g} s", [w.window and w.window.seconds for w in (one, other)])):  # fmt: skip
        known = [span for span in spans if span]
        if len(known) == 2:
            first, stop = max(span[0] for span in known), min(span[1] for span in known)
            return words.format(first, stop) if first < stop else ""
    parts = [record.slice or record.window for record in (one, other)]
    return "" if all(parts) else "rows" if any(parts) else "all rows"  # a slice beside a window is not compared


def _inputs_of_all(file: layout.AnyFile, records: Numbered) -> Found:
    """An input that some records have and others lack was there and not measured, or is zero and not said."""
    for name in ("force", "base_acceleration"):
        have = [name in given(record.channels) or name in given(record.conditions) for _, record in records]
        if not any(have):
            continue
        first = records[have.index(True)][0]
        for (k, _), has in zip(records, have, strict=True):
            if not has:
                rule = f"the record lacks the {name} that records[{first}] has"
                remedy = f"declare its {name}, or leave the record out"
                if name == "force":
                    remedy = "declare its force; where there was none, conditions: {force: {value: 0, unit: …}}"
                yield Problem(f"records[{k}].channels", rule, None, remedy)


def _force_that_tells(file: layout.AnyFile, records: Numbered) -> Found:
    """One constant force in all records shifts the place of rest, which is not known without it either."""
    unmeasured = [record for _, record in records if "force" not in given(record.channels)]
    forces = [given(record.conditions).get("force") for record in unmeasured]
    if not records or len(forces) < len(records) or None in forces:
        return
    if len({(force.value, force.unit) for force in forces}) == 1 and forces[0].value != 0:
        rule = "a force that is the same in every record shifts the place of rest, and tells nothing more"
        yield Problem(f"records[{records[0][0]}].conditions.force", rule, forces[0].value, "leave it out")


def _gain_of_nothing(file: layout.AnyFile, records: Numbered) -> Found:
    gain = getattr(file.parameters, "force_gain", None)
    driven = any("force" in {*given(record.channels), *given(record.conditions)} for _, record in records)
    if records and not driven and gain is not None:
        rule, remedy = "has no meaning where no record has a force", "declare the force, or leave it out"
        yield Problem("parameters.force_gain", rule, gain.value, remedy)


def _gain_of_the_force(file: layout.AnyFile, records: Numbered) -> Found:
    for k, record in records:
        force = given(record.channels).get("force")
        if force is not None and force.uncertainty and getattr(file.parameters, "force_gain", None) is None:
            rule = "has no meaning without parameters.force_gain: the gain of an unknown force is fitted freely"
            remedy = "state force_gain, or leave it out"
            yield Problem(f"records[{k}].channels.force.uncertainty", rule, force.uncertainty, remedy)


def _one_gear_torque(file: layout.AnyFile, records: Numbered) -> Found:
    """What the gear's torque does is one in all records that have a load."""
    said = {}
    for k, record in records:
        found = given(record.channels).get("gear_torque", given(record.conditions).get("gear_torque", "balanced"))
        if record.role != "reference":
            said.setdefault(found if isinstance(found, str) else "given as a torque", k)
    (first, at), *others = said.items() if said else [("", 0)]
    for word, k in others:
        rule = f"gear_torque is {word} here and {first} in records[{at}], and a model knows one of the two"
        yield Problem(f"records[{k}]", rule, None, "declare it alike in all records, or explain them apart")


def _one_mesh_index(file: layout.AnyFile, records: Numbered) -> Found:
    told = [record.mesh_index for _, record in records if record.role != "reference"]
    if any(told) and not all(told):
        k = next(k for k, record in records if not record.mesh_index and record.role != "reference")
        rule = "is not true here and in other records it is: the zero of the mesh is one of all records"
        yield Problem(f"records[{k}].mesh_index", rule, None, "state it in all records, or in none")


_Rule = Callable[[layout.AnyFile, Numbered], Found]
_OF_GEARS: tuple[_Rule, ...] = (_compared, _held_out_apart, _one_gear_torque, _one_mesh_index)
_OF_OSCILLATORS: tuple[_Rule, ...] = (
    _compared, _held_out_apart, _inputs_of_all, _force_that_tells, _gain_of_nothing, _gain_of_the_force,
)  # fmt: skip
