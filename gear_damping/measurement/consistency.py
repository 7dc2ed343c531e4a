"""What the keys of a measurement.yaml must be together: within a record, and among all records."""

from collections.abc import Callable, Collection, Iterator

from gear_damping.errors import Problem
from gear_damping.measurement import layout
from gear_damping.measurement.angular_error import GEOMETRY, NEEDED
from gear_damping.schema.mappings import names

_OSCILLATOR_RESPONSES = ("displacement", "velocity", "acceleration")
_SHARED_BY_TRIALS = ("time", "force", "base_acceleration", "pinion_torque", "gear_torque", "pinion_angle")
_OF_A_RESPONSE = ("lowpass", "highpass", "coupling", "noise", "datum")
Found = Iterator[Problem]


def inconsistencies(file: layout.AnyFile, wrong: Collection[int]) -> list[Problem]:
    """What does not hold together, without a source.

    Args:
        file: What is declared.
        wrong: Records with problems of their own, which are not looked at: a part of them is not known.
    """
    gear = isinstance(file, layout.GearFile)
    records = [(k, record) for k, record in enumerate(file.records) if record is not None and k not in wrong]
    problems = []
    for k, record in records:
        rules = _GEAR if gear else _OSCILLATOR
        problems += [problem for rule in rules for problem in rule(_Seen(file, record, f"records[{k}]"))]
    if not wrong and not problems:
        problems += [problem for rule in (_GEARS if gear else _OSCILLATORS) for problem in rule(file, records)]
    return problems


class _Seen:
    """A record with what it has, by name."""

    def __init__(self, file: layout.AnyFile, record: layout.AnyRecord, key: str) -> None:
        self.file, self.record, self.key = file, record, key
        self.channels = given(record.channels)
        self.conditions = given(record.conditions)
        self.encoders = given(getattr(record, "encoders", None))

    @property
    def both_encoders(self) -> bool:
        return {"pinion", "gear"} <= {*self.encoders}

    @property
    def error(self) -> bool:
        """Whether a transmission error is measured."""
        return "transmission_error" in self.channels or self.both_encoders

    @property
    def on_a_shaft(self) -> list[str]:
        """Responses of one shaft alone."""
        found = [name for name in ("pinion_speed", "gear_speed") if name in self.channels]
        found = [name for name in found if name != "pinion_speed" or not self.error]
        mounted = self.channels.get("acceleration")
        return [*found, *(["acceleration"] if mounted and mounted.mounting == "tangential" else [])]

    @property
    def casing(self) -> bool:
        mounted = self.channels.get("acceleration")
        return mounted is not None and mounted.mounting == "casing"

    def problem(self, at: str, rule: str, remedy: str) -> Problem:
        """A problem of the record's `at`."""
        return Problem(f"{self.key}.{at}", rule, None, remedy)


def _something_measured(seen: _Seen) -> Found:
    if "channels" not in seen.record.model_fields_set and not seen.encoders:
        known = ", ".join(name for name in names(layout.GearChannels if _is_gear(seen) else layout.OscillatorChannels))
        yield Problem(f"{seen.key}.channels", "is missing", None, f"declare at least one of {known}")


def _is_gear(seen: _Seen) -> bool:
    return isinstance(seen.file, layout.GearFile)


def _gear_response(seen: _Seen) -> Found:
    """Something that a simulation, or the orders of a casing, can be compared with."""
    if not (seen.error or seen.on_a_shaft or seen.casing):
        if "gear" in seen.encoders and ({"pinion_angle"} & {*seen.channels} or "tacho" in seen.encoders):
            return  # said of the encoder
        if "gear" in seen.encoders:
            rule, remedy = "the gear's encoder alone is no response", "declare encoders.pinion beside it, or a channel"
            yield seen.problem("encoders", rule, remedy)
            return
        rule = "the record lacks a transmission_error or another response"
        remedy = "declare a transmission_error, pinion_speed, gear_speed, acceleration, or two encoders"
        yield seen.problem("channels", rule, remedy)


def _gear_angle(seen: _Seen) -> Found:
    have = {*seen.channels, *seen.conditions}
    if not have & {"pinion_angle", "pinion_speed"} and not seen.encoders:
        needed = "pinion_speed under conditions, or a pinion_angle"
        yield seen.problem("channels", f"the record lacks {needed}", f"declare {needed}, or encoders.tacho")


def _gear_load(seen: _Seen) -> Found:
    have = {*seen.channels, *seen.conditions}
    if (seen.error or seen.on_a_shaft) and "pinion_torque" not in have:
        needed = "pinion_torque under conditions, or its channel"
        yield seen.problem("channels", f"the record lacks {needed}", f"declare {needed}")
    word = isinstance(seen.channels.get("gear_torque"), str), isinstance(seen.conditions.get("gear_torque"), str)
    if {"gear_torque"} <= {*seen.channels} & {*seen.conditions} and any(word):
        rule = "gear_torque is given under channels too, and one of the two is a word"
        yield seen.problem("conditions.gear_torque", rule, "keep the one that is right")


def _angle_needs_teeth(seen: _Seen) -> Found:
    """What makes a length of a transmission error that is an angle."""
    shaft = getattr(seen.channels.get("transmission_error"), "shaft", None)
    known = given(seen.file.parameters)
    missing = [name for name in (GEOMETRY[shaft], *NEEDED) if name not in known] if shaft else []
    if missing:
        rule = "a transmission error in a unit of an angle needs the base radius of its shaft"
        yield seen.problem("channels.transmission_error.shaft", rule, f"give {', '.join(missing)} under parameters")


def _shaft_needs_inertia(seen: _Seen) -> Found:
    parameters = seen.file.parameters
    if seen.on_a_shaft and parameters is not None and parameters.equivalent_mass is not None:
        rule = f"has no meaning beside {seen.key}.channels.{seen.on_a_shaft[0]}: the mass along the line of action "
        rule += "does not say how one shaft moves"
        remedy = "give inertia_pinion and inertia_gear instead"
        yield Problem("parameters.equivalent_mass", rule, parameters.equivalent_mass.value, remedy)


def _speed_as_an_angle(seen: _Seen) -> Found:
    speed = seen.channels.get("pinion_speed")
    for name in _OF_A_RESPONSE if speed is not None and seen.error else ():
        if speed.given(name):
            rule = "has no meaning beside a transmission error: the pinion's speed gives the angle and is no response"
            yield seen.problem(f"channels.pinion_speed.{name}", rule, "leave it out")


def _speed_has_its_mean(seen: _Seen) -> Found:
    """The mean of the pinion's speed gives the angle, where nothing else does."""
    speed = seen.channels.get("pinion_speed")
    if speed is None or seen.error or not (speed.highpass or speed.coupling == "AC"):
        return
    if not ({"pinion_angle"} & {*seen.channels} or "pinion_speed" in seen.conditions or seen.encoders):
        at = "coupling" if speed.coupling == "AC" else "highpass"
        rule = "the mean of the pinion's speed gives its angle, and this channel has lost it"
        yield seen.problem(f"channels.pinion_speed.{at}", rule, "give the mean as conditions.pinion_speed")


def _angle_twice(seen: _Seen) -> Found:
    """An encoder or tacho of the pinion that would give nothing but the angle that a channel gives."""
    for name in ("pinion", "tacho"):
        if name in seen.encoders and "pinion_angle" in seen.channels and not (name == "pinion" and seen.both_encoders):
            rule = "has no meaning beside channels.pinion_angle, which it would give"
            yield seen.problem(f"encoders.{name}", rule, "keep one of the two")


def _speed_of_known_gain(seen: _Seen) -> Found:
    """A speed that is no response gives the angle, whose scale is not fitted."""
    speed = seen.channels.get("pinion_speed")
    if speed is not None and seen.error and speed.given("uncertainty"):
        rule = "has no meaning beside a transmission error: the pinion's speed gives the angle, as it was read"
        remedy = "leave it out, or state conditions.pinion_speed with its uncertainty instead of this channel"
        yield seen.problem("channels.pinion_speed.uncertainty", rule, remedy)


def _encoder_beside_a_channel(seen: _Seen) -> Found:
    """The gear's encoder where it gives neither a transmission error nor the angle."""
    if seen.both_encoders and "transmission_error" in seen.channels:
        rule = "has no meaning beside channels.transmission_error, which it would give"
        yield seen.problem("encoders.gear", rule, "keep one of the two")
    angles = [("pinion_angle", seen.channels, "channels"), ("tacho", seen.encoders, "encoders")]
    others = [f"{place}.{name}" for name, there, place in angles if name in there]
    if "gear" in seen.encoders and not seen.both_encoders and others:
        rule = f"has no meaning without encoders.pinion beside {others[0]}, which gives the angle"
        remedy = f"declare encoders.pinion in the place of {others[0]}"
        remedy += ", with counts_per_revolution: 360 of an angle in deg" if "pinion_angle" in others[0] else ""
        yield seen.problem("encoders.gear", rule, f"{remedy}, or leave this one out")


def _reference(seen: _Seen) -> Found:
    if seen.record.role == "reference" and not (_is_gear(seen) and seen.casing):
        rule = "a reference is a sound casing to compare with, and this record has no casing's acceleration"
        yield Problem(f"{seen.key}.role", rule, "reference", "write fit or holdout, or declare the acceleration")


def _oscillator_response(seen: _Seen) -> Found:
    if not {*seen.channels} & {*_OSCILLATOR_RESPONSES}:
        needed = "a displacement, velocity or acceleration"
        yield seen.problem("channels", f"the record lacks {needed}", f"declare {needed}")


def _force_twice(seen: _Seen) -> Found:
    if "force" in seen.channels and "force" in seen.conditions:
        rule = "the force is given under channels too, and that is used"
        yield seen.problem("conditions.force", rule, "leave it out, or leave the channel out")


def _driven_by_itself(seen: _Seen) -> Found:
    """One column cannot be the force on a rig and how that moves."""
    columns = {name: getattr(channel, "column", None) for name, channel in seen.channels.items()}
    for name in _OSCILLATOR_RESPONSES if "force" in columns else ():
        if columns.get(name) == columns["force"]:
            rule = "is the column of channels.force too, which drives it"
            yield seen.problem(f"channels.{name}.column", rule, "name the column that each was recorded in")


def _frame_without_base(seen: _Seen) -> Found:
    for name in _OSCILLATOR_RESPONSES if "base_acceleration" not in seen.channels else ():
        if name in seen.channels and seen.channels[name].given("frame"):
            rule = "has no meaning without a base_acceleration in the record"
            yield seen.problem(f"channels.{name}.frame", rule, "declare base_acceleration, or leave it out")


_GEAR: tuple[Callable[[_Seen], Found], ...] = (
    _something_measured, _gear_response, _gear_angle, _gear_load, _shaft_needs_inertia, _speed_as_an_angle,
    _angle_needs_teeth, _speed_has_its_mean, _encoder_beside_a_channel, _angle_twice,
    _speed_of_known_gain, _reference,
)  # fmt: skip
_OSCILLATOR: tuple[Callable[[_Seen], Found], ...] = (
    _something_measured, _oscillator_response, _force_twice, _driven_by_itself, _frame_without_base, _reference,
)  # fmt: skip


Numbered = list[tuple[int, layout.AnyRecord]]


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
    """The columns of its responses: trials side by side may share the time, and what drives them."""
    channels = given(record.channels).items()
    columns = (getattr(channel, "column", None) for name, channel in channels if name not in _SHARED_BY_TRIALS)
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
    """One constant force in all records shifts the place of rest, which is not known without it either.

    On what has no spring it is left out with a note once the records are read, where its gain is not stated either.
    """
    unmeasured = [record for _, record in records if "force" not in given(record.channels)]
    forces = [given(record.conditions).get("force") for record in unmeasured]
    if not records or len(forces) < len(records) or None in forces:
        return
    if len({(force.value, force.unit) for force in forces}) == 1 and forces[0].value != 0:
        rule = "a force that is the same in every record shifts the place of rest, and tells nothing more"
        stiffness = getattr(file.parameters, "stiffness", None)
        if stiffness is not None and stiffness.value == 0:
            if getattr(file.parameters, "force_gain", None) is None:
                return
            rule = "a constant force on what has no spring is fitted by itself, and its size tells nothing more"
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


def _reference_beside_responses(file: layout.AnyFile, records: Numbered) -> Found:
    """A reference is what casings are compared with; where shafts are simulated nothing is."""
    seen = [(k, record, _Seen(file, record, f"records[{k}]")) for k, record in records]
    simulated = [k for k, record, one in seen if record.role != "reference" and (one.error or one.on_a_shaft)]
    for k, record, _ in seen:
        if record.role == "reference" and simulated:
            rule = f"records[{simulated[0]}] is compared with a simulation, and a reference only with other casings"
            remedy = "write fit or holdout, leave the record out, or explain the casings in a file of their own"
            yield Problem(f"records[{k}].role", rule, "reference", remedy)


_Rule = Callable[[layout.AnyFile, Numbered], Found]
_GEARS: tuple[_Rule, ...] = (
    _compared, _held_out_apart, _one_gear_torque, _one_mesh_index, _reference_beside_responses,
)  # fmt: skip
_OSCILLATORS: tuple[_Rule, ...] = (
    _compared, _held_out_apart, _inputs_of_all, _force_that_tells, _gain_of_nothing, _gain_of_the_force,
)  # fmt: skip
