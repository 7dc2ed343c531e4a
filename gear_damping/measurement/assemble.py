"""From raw values to a record: units, sign, unwrapped angles, one time base, checks."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.angular_error import GEOMETRY, NEEDED, base_radius, turn_in
from gear_damping.measurement.cutting import is_faster, moved
from gear_damping.measurement.declaration import ChannelPlan, Plan
from gear_damping.measurement.declared_units import Conversion, UnitSystem, written
from gear_damping.measurement.encoders import (
    FROM_ENCODERS,
    ShaftAngle,
    mean_rotation,
    transmission_error,
)
from gear_damping.measurement.gaps import borne_out
from gear_damping.measurement.held_together import check_together
from gear_damping.measurement.raw import RawChannel, RawRecord
from gear_damping.measurement.record import Channel, Finding, Quantity, Record
from gear_damping.measurement.record_checks import check_record
from gear_damping.measurement.resolution import rounding_of
from gear_damping.measurement.shaft_checks import mesh_beyond_band, other_side, tooth_ratio
from gear_damping.measurement.staircase import is_staircase
from gear_damping.measurement.timebase import TimeBase
from gear_damping.measurement.unit_conflicts import other_motion, unit_conflict
from gear_damping.measurement.vocabulary import HOLDABLE, SHAFT_SPEEDS
from gear_damping.measurement.wraps import begins_again, refuse_other_turn, run_over, unwrapped
from gear_damping.schema.values import Problems

LOST = 0.1  # of a channel's variance, from which it is said that resampling took it
ALL = 0.9  # of it, above which what is left is no motion
_ENDS = 2  # samples of a lower rate, which depend on how the signal is thought to go on beyond the record
_TEETH = tuple(GEOMETRY.values())
_GEOMETRY = (*_TEETH, *NEEDED)
_STANDS = 0.1  # of the largest speed: what a vibration's mean is below and that of a shaft that turns is not
LONG_BEHIND = 0.1  # of a record: clocks that are stopped by hand, one after the other, differ by less
MORE_STAMPS = 2.0  # times the rate of a record: what stamps then hold between two samples is lost
_OTHERWISE = 0.1  # of a condition: no two instruments differ by so much
_INERTIAS = ("inertia_pinion", "inertia_gear")


class Assembler:
    """Makes records out of raw ones; what is wrong goes to `problems`."""

    def __init__(self, plan: Plan, units: UnitSystem, problems: Problems, source: str) -> None:
        self.plan, self.units, self.problems, self.source = plan, units, problems, source

    def record(self, raw: RawRecord, name: str) -> Record | None:
        """The record, or None where something in it is wrong."""
        before = len(self.problems)
        notes, findings = list(raw.base.notes), list(raw.base.findings)
        channels = {}
        for channel in raw.channels:
            with self.problems.collecting():
                channels[channel.plan.name] = self._channel(channel, raw, notes, findings)
        with self.problems.collecting():
            self._from_encoders(raw, channels, notes, findings)
        self._give_mean(raw, channels, notes)
        conditions = self._conditions(raw, channels, findings)
        if raw.complete and len(self.problems) == before:
            self._torque_settled(raw, channels, conditions)
            self._hold_gear(raw, channels, conditions, notes)
        if not raw.complete or len(self.problems) > before:
            return None
        plan, base = raw.plan, raw.base
        record = Record(
            name, raw.table.path, raw.sha256, plan.role, base.sampling_rate, base.time, channels, conditions,
            "balanced" if plan.gear_torque_mode == "balanced" else None, plan.mesh_index, base.uniform,
            (*raw.table.notes, *notes),
        )  # fmt: skip
        named = tuple(replace(finding, record=name) for finding in findings)
        record = borne_out(replace(record, findings=named))
        together = (replace(one, record=name) for one in check_together(record, self.plan.parameters))
        return replace(record, findings=(*record.findings, *check_record(record), *together, *self._mesh(record)))

    def _mesh(self, record: Record) -> list[Finding]:
        pinion, gear = (self.plan.parameters.get(name) for name in _TEETH)
        if pinion is None:
            return []
        found = [mesh_beyond_band(record, pinion.value), gear and other_side(record, (pinion.value, gear.value))]
        return [one for one in found if one]

    def _channel(self, raw: RawChannel, record: RawRecord, notes: list[str], findings: list[Finding]) -> Channel:
        plan = raw.plan
        conversion = self._conversion(plan, raw.unit, f"{plan.key}.unit")
        said = (unit_conflict(raw, record, conversion), other_motion(raw), _scale_beside(raw, record))
        findings += [found for found in said if found]
        limits = {
            name: quantity.value * self._conversion(plan, quantity.unit, f"{plan.key}.{name}", written(quantity)).factor
            for name, quantity in plan.limits.items()
        }
        factor = conversion.factor
        if record.table.full_scale is not None:
            factor = self._of_full_scale(plan, limits, factor)
            notes.append(_full_scale(plan, factor / plan.sensor["gain"], conversion, raw.unit))
        values = raw.values * (factor * plan.sensor["polarity"] / plan.sensor["gain"])
        turn = turn_in(conversion.unit)
        is_turned = plan.name == "pinion_angle" or (bool(turn) and begins_again(values, turn))
        if not is_turned and (found := run_over(raw.values, plan.name, plan.column)):
            findings.append(found)
        if is_turned:
            refuse_other_turn(raw.values / plan.sensor["gain"], raw.unit, f"{plan.key}.unit", self.source)
            values = unwrapped(values, turn, plan.name, notes)
        rounding = rounding_of(values) if record.plan.resample else 0.0
        switches = plan.name in HOLDABLE and _switches(raw, record)
        if raw.own_time is None:
            recorded, values = values, values if switches else record.base.resample(values)
            was = getattr(record.base, "recorded", None) or record.base
            findings += _lost(recorded, was, values, record.base, plan.name) if record.plan.resample else []
        else:
            recorded, own = values, raw.own_time
            findings += [found for found in own.findings if found.kind in ("rate_conflict", "two_clocks")]
            values = moved(record.base, own, values, plan.key, str(record.table.path))
            evenly = own.resample(recorded) if is_faster(own, record.base) else None
            findings += [] if evenly is None else _lost(evenly, own, values, record.base, plan.name)
            done = "filtered and taken" if is_faster(own, record.base) else "interpolated"
            notes.append(f"{plan.name}: {done} from {own.sampling_rate:.6g} Hz to the record's time")
        sensor = plan.sensor | ({"hold": self._held(raw, record, switches, notes)} if plan.name in HOLDABLE else {})
        if plan.name in SHAFT_SPEEDS:
            sensor.pop("radius", None)  # the values are divided by it
        return Channel(
            plan.name, values, conversion.unit, raw.unit, conversion.factor, rounding=rounding, **limits, **sensor
        )

    def _of_full_scale(self, plan: ChannelPlan, limits: Mapping[str, float], factor: float) -> float:
        """What ±1 of a WAV file is before the gain: the range, or one of the unit."""
        if "range" not in limits:
            return factor
        if plan.sensor["gain"] != plan.lever:
            rule = "stands beside range, which says already what ±1 of a WAV file is"
            stated = plan.sensor["gain"] / plan.lever
            raise InputError(Problem(f"{plan.key}.gain", rule, stated, "leave one of the two out", self.source))
        return limits["range"] * plan.lever

    def _conversion(self, plan: ChannelPlan, unit: str, key: str, said: str = "") -> Conversion:
        return self.units.conversion(plan.name, unit, key, self.source, plan.shaft_radius, said)

    def _held(self, raw: RawChannel, record: RawRecord, switches: bool, notes: list[str]) -> bool:
        """Whether an input stays at each value: as stated, or as it looks."""
        stated, is_filtered = raw.plan.sensor.get("hold"), bool(record.plan.resample) and raw.own_time is None
        if stated and _is_moved(raw, record):
            rule = "cannot be held where its samples are moved to other instants"
            remedy = "leave out resample, or hold" if is_filtered else "leave out hold"
            remedy += "; where each value of the file lasts one of its sampling intervals T, give a delay of -T/2"
            raise InputError(Problem(f"{raw.plan.key}.hold", rule, True, remedy, self.source))
        if is_filtered and stated is None and is_staircase(raw.values):
            text = "comes in steps, which the filter of resample rounds and lets ring; without it each value would stay"
            notes.append(f"{raw.plan.name}: {text} until the next")
        if switches and stated is None:
            notes.append(f"{raw.plan.name}: comes in steps, and stays at each value until the next (else hold: false)")
        return switches

    def _from_encoders(
        self, raw: RawRecord, channels: dict[str, Channel], notes: list[str], findings: list[Finding]
    ) -> None:
        """The pinion angle, and the transmission error where both shafts are measured."""
        for name, one in raw.angles.items():
            if one.lost:
                message = f"{one.lost} pulses are missing between others, the first after {one.lost_after:.6g} s; "
                message += "the turn of the shaft there is counted as if they were there"
                findings.append(Finding("lost_pulses", message, channel=name, severity="note"))
            notes += [*_folded_back(name, one, raw.base), *_going_on(name, one, raw)]
        told = raw.angles.get("pinion", raw.angles.get("tacho"))
        if told is None and "pinion_angle" not in channels and "gear" in raw.angles:
            told = self._behind_the_gear(raw.angles["gear"], f"{raw.plan.key}.encoders.gear", notes)
        shaft = None if told is None else told.values
        if {"pinion", "gear"} <= {*raw.angles} and "transmission_error" not in channels:
            angles = {name: one.values for name, one in raw.angles.items()}
            error, shaft = self._error(angles, f"{raw.plan.key}.encoders", findings)
            channels["transmission_error"] = Channel(
                "transmission_error", raw.base.resample(error), "m", datum="arbitrary"
            )
            notes.append(FROM_ENCODERS)
        if shaft is not None and "pinion_angle" not in channels:
            datum = "absolute" if raw.plan.mesh_index else "arbitrary"
            values, late = raw.base.resample(shaft), told.timing_error
            channels["pinion_angle"] = Channel("pinion_angle", values, "rad", datum=datum, timing_error=late)

    def _behind_the_gear(self, gear: ShaftAngle, key: str, notes: list[str]) -> ShaftAngle:
        """The pinion's angle where the gear's alone is measured: the teeth that have passed, over the pinion's."""
        missing = [name for name in _TEETH if name not in self.plan.parameters]
        if missing:
            rule = "the angle of the pinion from the gear's encoder needs the teeth of both"
            raise InputError(Problem(key, rule, None, f"give {', '.join(missing)} under parameters", self.source))
        teeth_1, teeth_2 = (self.plan.parameters[name].value for name in _TEETH)
        notes.append("pinion_angle: from the gear's encoder by the ratio of the teeth")
        return replace(gear, values=gear.values * teeth_2 / teeth_1)

    def _error(
        self, angles: dict[str, NDArray], key: str, findings: list[Finding]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The transmission error, and the pinion's mean rotation where both inertias are known, else its angle."""
        missing = [name for name in _GEOMETRY if name not in self.plan.parameters]
        if missing:
            rule = "the transmission error from encoders needs the base radii"
            remedy = f"give {', '.join(missing)} under parameters"
            raise InputError(Problem(key, rule, None, remedy, self.source))
        teeth_1, teeth_2, module, pressure = (self.plan.parameters[name].value for name in _GEOMETRY)
        radii = base_radius(teeth_1, module, pressure), base_radius(teeth_2, module, pressure)
        values = transmission_error(angles["pinion"], angles["gear"], *radii)
        found = tooth_ratio(angles["pinion"], angles["gear"], (teeth_1, teeth_2), radii[0])
        if found:  # one of them is wrong: what is made of both would be nobody's rotation
            findings.append(replace(found, channel="transmission_error"))
            return values, angles["pinion"]
        known = [self.plan.parameters[name].value for name in _INERTIAS if name in self.plan.parameters]
        if len(known) < len(_INERTIAS):
            return values, angles["pinion"]
        return values, mean_rotation(angles["pinion"], values, radii, (known[0], known[1]))

    def _give_mean(self, raw: RawRecord, channels: dict[str, Channel], notes: list[str]) -> None:
        """A speed that has lost its mean gets the one under conditions."""
        speed, stated = channels.get("pinion_speed"), raw.plan.conditions.get("pinion_speed")
        if speed is not None and stated is not None and _mean_lost(speed):
            added = stated.value - float(speed.values.mean())
            channels["pinion_speed"] = replace(speed, values=speed.values + added, mean_added=added)
            notes.append("pinion_speed: its mean is the one under conditions")

    def _conditions(self, raw: RawRecord, channels: dict[str, Channel], findings: list[Finding]) -> dict[str, Quantity]:
        """A channel beats a condition of the same name, which is said."""
        kept = {}
        for name, quantity in raw.plan.conditions.items():
            if name in channels and not _mean_lost(channels[name]) and not _stands(channels[name], quantity):
                findings.append(_beside_condition(channels[name], quantity))
                continue
            kept[name] = quantity
            with self.problems.collecting():
                unit = self.units.conversion(name, quantity.unit, f"{raw.plan.key}.conditions.{name}", self.source)
                kept[name] = Quantity(quantity.value * unit.factor, unit.unit, quantity.uncertainty)
        return kept

    def _torque_settled(self, raw: RawRecord, channels: dict[str, Channel], conditions: dict[str, Quantity]) -> None:
        """Where the pinion's torque varies, what the gear's does must be said."""
        torque = channels.get("pinion_torque")
        settled = "gear_torque" in {*channels, *conditions} or raw.plan.gear_torque_mode
        if torque is not None and np.ptp(torque.values) > 0 and not settled:
            rule = "the pinion torque varies and nothing says what the gear torque does"
            remedy = "write gear_torque: balanced (or held) beside pinion_torque, or its channel"
            self.problems.append(Problem(f"{raw.plan.key}.channels", rule, None, remedy, self.source))

    def _hold_gear(
        self, raw: RawRecord, channels: dict[str, Channel], conditions: dict[str, Quantity], notes: list[str]
    ) -> None:
        """A gear torque that is held stays at what balances the mean torque on the pinion."""
        drive, stated = channels.get("pinion_torque"), conditions.get("pinion_torque")
        if raw.plan.gear_torque_mode != "held" or (drive is None and stated is None):
            return
        values = {name: quantity.value for name, quantity in self.plan.parameters.items()}
        missing = [name for name in _TEETH if name not in values]
        if missing:
            rule = "held at what balances the pinion's needs the teeth"
            remedy = f"give {', '.join(missing)} under parameters, or a value"
            self.problems.append(Problem(f"{raw.plan.key}.gear_torque", rule, "held", remedy, self.source))
            return
        mean = stated.value if drive is None else float(drive.values.mean())
        true = values.get("torque_gain", 1.0) * mean + values.get("torque_offset", 0.0)
        held = true * values["n_teeth_gear"] / values["n_teeth_pinion"]
        conditions["gear_torque"] = Quantity(held, "N*m")
        notes.append(f"gear_torque: held at {held:.6g} N*m, which balances the mean of pinion_torque")


def _switches(raw: RawChannel, record: RawRecord) -> bool:
    """Whether an input jumps between values, as stated or as it looks: a spline would swing about each jump."""
    stated = raw.plan.sensor.get("hold")
    if _is_moved(raw, record):
        return False
    return is_staircase(raw.values) if stated is None else bool(stated)


def _is_moved(raw: RawChannel, record: RawRecord) -> bool:
    """Whether the samples of a channel are taken at other instants than they were recorded."""
    return bool(record.plan.resample or raw.own_time)


def _lost(
    recorded: NDArray[np.float64], was: TimeBase, kept: NDArray[np.float64], base: TimeBase, name: str
) -> list[Finding]:
    """What a filter before a lower rate has taken of a channel, where that is much; uneven samples by their time.

    Args:
        recorded: (n,) as recorded, at the times of `was`, some of which lie beside the record.
        was: Their time base.
        kept: (m,) at the lower rate.
        base: The time base of the record.
        name: Of the channel.
    """
    inside = (was.time >= base.time[0]) & (was.time <= base.time[-1])
    recorded = recorded[inside]
    if not recorded.size or np.ptp(recorded) == 0:
        return []
    weights = None if was.uniform else np.gradient(was.time[inside])
    mean = np.average(recorded, weights=weights)
    before = float(np.average((recorded - mean) ** 2, weights=weights))
    share = 1 - float(np.var(kept[_ENDS:-_ENDS])) / max(before, 1e-300)
    if share < LOST:
        return []
    message = (
        f"the lower rate takes {100 * share:.0f} % of the variance of {name} away, which lies above half of it; "
        "where that is the motion, give a higher rate"
    )
    severity = "data_problem" if share > ALL else "note"
    return [Finding("resampled_away", message, channel=name, severity=severity)]


def _mean_lost(channel: Channel) -> bool:
    return channel.coupling == "AC" or channel.highpass is not None


def _stands(channel: Channel, stated: Quantity) -> bool:
    """Whether a shaft that is said to stand does: what its speed shows is the vibration alone."""
    largest = float(np.abs(channel.values).max())
    return channel.name == "pinion_speed" and stated.value == 0 and abs(channel.values.mean()) < _STANDS * largest


def _beside_condition(channel: Channel, stated: Quantity) -> Finding:
    """What is said of a condition beside the channel of its name: that is used, and must go through its value."""
    factor, unit = (30 / np.pi, "rpm") if stated.unit == "rad/s" else (1.0, stated.unit)
    message = f"the channel {channel.name} is used, not the {stated.value * factor:.6g} {unit} under conditions"
    low, high, apart = channel.values.min(), channel.values.max(), _OTHERWISE * abs(stated.value)
    if low - apart <= stated.value <= high + apart:
        return Finding("not_used", message, channel=channel.name, severity="note")
    reached = f"{low * factor:.6g} to {high * factor:.6g} {unit}"
    message += f", which it never reaches ({reached}); correct the one that is wrong"
    severity = "data_problem" if channel.name in SHAFT_SPEEDS else "note"  # a torque meter may be off by as much
    return Finding("condition_mismatch", message, channel=channel.name, severity=severity)


def _full_scale(plan: ChannelPlan, factor: float, conversion: Conversion, unit: str) -> str:
    """What is said of the full scale of a WAV file: that it is a guess where neither a range nor a gain stands."""
    if "range" in plan.limits or plan.sensor["gain"] != plan.lever:
        return f"{plan.name}: full scale is taken as {factor:.6g} {conversion.unit}"
    one = factor / conversion.factor
    return (
        f"{plan.name}: no range is stated, and full scale is taken as {one:.6g} {unit}, a guess: write "
        f"`range: 50 {unit}` with what the sensor gives at full scale, or the figures count in shares of it"
    )


def _folded_back(name: str, shaft: ShaftAngle, base: TimeBase) -> list[str]:
    """What is said of stamps that hold more than the rate at which the angle of their shaft is taken."""
    rate = (shaft.values.size - 1) / float(base.time[-1] - base.time[0])  # before a lower one was asked for
    if shaft.stamped_rate <= MORE_STAMPS * rate:
        return []
    return [
        f"{name}: its stamps come {shaft.stamped_rate:.3g} times a second, and the angle is taken at {rate:.6g} Hz, so "
        f"that motions above {rate / 2:.6g} Hz are folded back onto lower ones: give a sampling_rate near that of the "
        "stamps, and resample for a lower one"
    ]


def _going_on(name: str, shaft: ShaftAngle, raw: RawRecord) -> list[str]:
    """What is said of stamps that go on long behind the end of a record that is taken whole."""
    first, last = float(raw.base.time[0]), float(raw.base.time[-1])
    is_whole = raw.plan.rows is None and raw.plan.window is None
    if not is_whole or shaft.stamps_end - last <= LONG_BEHIND * (last - first):
        return []
    rate = (shaft.values.size - 1) / (shaft.stamps_end - first)
    return [
        f"{name}: its stamps go on until {shaft.stamps_end:.6g} s, and the samples end at {last:.6g} s: check the "
        f"sampling rate and the unit of the stamps; at {rate:.6g} Hz both end together"
    ]


def _scale_beside(raw: RawChannel, record: RawRecord) -> Finding | None:
    """A factor or a zero that the file states beside the column, where the YAML says nothing of a gain."""
    table = record.table
    scales = table.scales(table.index(raw.plan.column, raw.plan.key))
    if raw.plan.is_scaled or not scales:
        return None
    stated = " and ".join(f"{name} = {value}" for name, value in scales.items())
    message = (
        f"column '{raw.plan.column}' has an attribute {stated}, which is not applied; values are divided by gain: "
        "where it is a factor that multiplies them, write gain: one over it, and gain: 1 where they are right so"
    )
    return Finding("not_applied", message, channel=raw.plan.name, severity="note")
