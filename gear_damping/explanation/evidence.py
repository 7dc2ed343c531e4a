"""Step 1: what was measured, as the fits see it: records to fit, records held out, what is known of the rig."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import pi

import torch
from torch import Tensor

from gear_damping.errors import InputError, Problem
from gear_damping.identification.output_error.pieces import part
from gear_damping.identification.output_error.problem import FitRecord
from gear_damping.measurement.record import Channel, Measurement, Record
from gear_damping.physics.catalogue import builtin_effects
from gear_damping.physics.terms import Effect

RESPONSES = {"gear_pair": "transmission_error", "oscillator": "displacement"}
INPUTS = {"gear_pair": ("pinion_torque", "gear_torque", "pinion_angle"), "oscillator": ("force",)}
HELD_OUT = 4  # every so many operating conditions one is held out where the file does not say
SPLIT = 2 / 3  # of a single record: fitted before, held out behind


@dataclass(frozen=True)
class Evidence:
    """Records in the roles that the explanation gives them.

    Args:
        system: `gear_pair` or `oscillator`.
        fit: Records to fit.
        holdout: Records that decide what is accepted.
        parameters: Nominal values of the rig that the file states, by the file's names.
        channel: The response channel of the first record, for units.
        one_record: Whether there was but one record, cut in two.
        gear_torque_mode: What holds the gear.
        noise: Standard deviation of the noise over all records, once it is known.
        library: Effects that may be causes, by name.
        piece: Samples after which the state of a record is found anew, because it cannot be predicted for longer;
            0 where it can.
    """

    system: str
    fit: tuple[FitRecord, ...]
    holdout: tuple[FitRecord, ...]
    parameters: Mapping[str, float]
    channel: Channel
    one_record: bool
    gear_torque_mode: str = "balanced"
    noise: float = 0.0
    library: Mapping[str, type[Effect]] = field(default_factory=builtin_effects)
    piece: int = 0

    @property
    def sampling_rate(self) -> float:
        """Hz, that of every record."""
        return self.fit[0].sampling_rate

    @property
    def duration(self) -> float:
        """Length of the longest record in s."""
        return max(len(record.response) for record in (*self.fit, *self.holdout)) / self.sampling_rate

    @property
    def piece_ms(self) -> float:
        """Length of a piece in ms."""
        return 1e3 * self.piece / self.sampling_rate

    @property
    def conditions(self) -> int:
        """How many operating conditions the records hold."""
        return len({_condition(record) for record in (*self.fit, *self.holdout)})


def evidence_of(measurement: Measurement) -> Evidence:
    """The records of a measurement in their roles.

    Raises:
        InputError: a record lacks its response, or rates differ.
    """
    name = RESPONSES[measurement.system]
    problems = [
        Problem(
            f"{record.name}.{name}", f"a {measurement.system} is explained from this channel", source=str(record.file)
        )
        for record in measurement.records
        if name not in record.channels
    ]
    if len({round(record.sampling_rate, 3) for record in measurement.records}) > 1:
        rule, remedy = "records of different sampling rates", "resample them to one rate"
        problems.append(Problem("records", rule, remedy=remedy, source=str(measurement.source)))
    if problems:
        raise InputError(problems)
    records = [(_fit_record(record, measurement.system), record.role) for record in measurement.records]
    fit, holdout = _roles(records)
    one = not holdout
    if one:
        fit, holdout = _cut(fit)
    modes = {record.gear_torque_mode for record in measurement.records} - {None}
    return Evidence(
        system=measurement.system,
        fit=tuple(fit),
        holdout=tuple(holdout),
        parameters={key: quantity.value for key, quantity in measurement.parameters.items()},
        channel=measurement.records[0].channels[name],
        one_record=one and len(measurement.records) == 1,
        gear_torque_mode="held" if any("gear_torque" in r.inputs for r in fit) else next(iter(modes), "balanced"),
    )


def _fit_record(record: Record, system: str) -> FitRecord:
    response = torch.as_tensor(record.channels[RESPONSES[system]].values, dtype=torch.float64)
    inputs = {
        name: torch.as_tensor(record.channels[name].values, dtype=torch.float64)
        for name in INPUTS[system]
        if name in record.channels
    }
    known = {name: quantity.value for name, quantity in record.conditions.items() if name not in inputs}
    return FitRecord(record.name, response, record.sampling_rate, inputs, known | _means(inputs, record.sampling_rate))


def _means(inputs: dict[str, Tensor], sampling_rate: float) -> dict[str, float]:
    """Mean load and speed of a record: what hangs on the operating condition follows them."""
    found = {name: float(inputs[name].mean()) for name in ("pinion_torque", "gear_torque") if name in inputs}
    if "pinion_angle" in inputs:
        angle = inputs["pinion_angle"]
        found["pinion_speed"] = float(angle[-1] - angle[0]) / (len(angle) - 1) * sampling_rate
    return found


def _roles(records: Sequence[tuple[FitRecord, str | None]]) -> tuple[list[FitRecord], list[FitRecord]]:
    """Roles as the file says; where it says none, whole operating conditions are held out."""
    said = [role for _, role in records if role]
    if said:
        return [r for r, role in records if role != "holdout"], [r for r, role in records if role == "holdout"]
    found = sorted({_condition(record) for record, _ in records})
    held = set(found[HELD_OUT // 2 :: HELD_OUT]) if len(found) > 1 else set()
    fit = [record for record, _ in records if _condition(record) not in held]
    return fit, [record for record, _ in records if _condition(record) in held]


def _condition(record: FitRecord) -> tuple[float, float]:
    """Speed and torque of a record, rounded so that repetitions fall together."""
    speed, torque = record.conditions.get("pinion_speed", 0.0), record.conditions.get("pinion_torque", 0.0)
    if "pinion_angle" in record.inputs:
        angle = record.inputs["pinion_angle"]
        speed = float(angle[-1] - angle[0]) / (len(angle) - 1) * record.sampling_rate
    if "pinion_torque" in record.inputs:
        torque = float(record.inputs["pinion_torque"].mean())
    return round(speed * 30 / pi, -1), round(torque, -int(torch.tensor(max(abs(torque), 1e-9)).log10().floor()) + 1)


def _cut(records: Sequence[FitRecord]) -> tuple[list[FitRecord], list[FitRecord]]:
    """Every record in two: the first part is fitted, the rest held out."""
    fit, holdout = [], []
    for record in records:
        at = round(SPLIT * len(record.response))
        fit.append(part(record, slice(None, at), " (first part)"))
        holdout.append(part(record, slice(at, None), " (last part)"))
    return fit, holdout


def stacked(series: Sequence[Tensor]) -> Tensor:
    """All samples of several records one after another."""
    return torch.cat(list(series))
