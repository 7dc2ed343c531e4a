"""What the keys of a measurement.yaml must be together, beyond what one mapping can say by itself."""

from collections.abc import Callable, Collection, Iterator

from gear_damping.errors import Problem
from gear_damping.measurement import layout
from gear_damping.measurement.all_records import given, inconsistencies_of_all
from gear_damping.measurement.structure import names

_OSCILLATOR_RESPONSES = ("displacement", "velocity", "acceleration")
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
        problems += inconsistencies_of_all(file, records)
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
    if "gear" in seen.encoders and "pinion" not in seen.encoders:
        yield seen.problem("encoders", "the gear's encoder needs the pinion's beside it", "declare encoders.pinion")
    elif not (seen.error or seen.on_a_shaft or seen.casing):
        rule = "the record lacks a transmission_error or another response"
        remedy = "declare a transmission_error, pinion_speed, gear_speed, acceleration, or two encoders"
        yield seen.problem("channels", rule, remedy)


def _gear_angle(seen: _Seen) -> Found:
    have = {*seen.channels, *seen.conditions}
    if not have & {"pinion_angle", "pinion_speed"} and not {*seen.encoders} & {"pinion", "tacho"}:
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
        remedy = "leave it out; a speed that is known to so much is conditions.pinion_speed with its uncertainty"
        yield seen.problem("channels.pinion_speed.uncertainty", rule, remedy)


def _encoder_beside_a_channel(seen: _Seen) -> Found:
    if "gear" in seen.encoders and "transmission_error" in seen.channels:
        rule = "has no meaning beside channels.transmission_error, which it would give"
        yield seen.problem("encoders.gear", rule, "keep one of the two")


def _reference(seen: _Seen) -> Found:
    if seen.record.role == "reference" and not (_is_gear(seen) and seen.casing):
        rule = "a reference is a sound casing to compare with, and this record has no casing's acceleration"
        yield Problem(f"{seen.key}.role", rule, "reference", "write fit or holdout, or declare the acceleration")


def _oscillator_response(seen: _Seen) -> Found:
    if not {*seen.channels} & {*_OSCILLATOR_RESPONSES}:
        needed = "a displacement, velocity or acceleration"
        yield seen.problem("channels", f"the record lacks {needed}", f"declare {needed}")


def _frame_without_base(seen: _Seen) -> Found:
    for name in _OSCILLATOR_RESPONSES if "base_acceleration" not in seen.channels else ():
        if name in seen.channels and seen.channels[name].given("frame"):
            rule = "has no meaning without a base_acceleration in the record"
            yield seen.problem(f"channels.{name}.frame", rule, "declare base_acceleration, or leave it out")


_GEAR: tuple[Callable[[_Seen], Found], ...] = (
    _something_measured, _gear_response, _gear_angle, _gear_load, _shaft_needs_inertia, _speed_as_an_angle,
    _speed_has_its_mean, _encoder_beside_a_channel, _angle_twice, _speed_of_known_gain, _reference,
)  # fmt: skip
_OSCILLATOR: tuple[Callable[[_Seen], Found], ...] = (
    _something_measured, _oscillator_response, _frame_without_base, _reference,
)  # fmt: skip
