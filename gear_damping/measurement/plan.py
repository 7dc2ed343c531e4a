"""What measurement.yaml declares, checked, before any measured file is opened."""

from collections.abc import Mapping
from dataclasses import dataclass

from gear_damping.measurement.record import Quantity


@dataclass(frozen=True)
class TimePlan:
    """Where the time comes from: a column in `unit`, or a rate in Hz."""

    column: str | int | None = None
    unit: str | None = None
    sampling_rate: float | None = None


@dataclass(frozen=True)
class ChannelPlan:
    """A declared channel; `unit` None asks the file, `limits` are range and noise as declared."""

    name: str
    key: str
    column: str | int
    unit: str | None
    sensor: Mapping[str, object]
    limits: Mapping[str, Quantity]
    timing: TimePlan | None


@dataclass(frozen=True)
class EncoderPlan:
    """A shaft encoder or tacho: counts or a pulse train per sample, or the times of the pulses.

    `unit` None asks the file.
    """

    name: str
    key: str
    column: str | int
    timestamps: bool
    unit: str | None
    per_revolution: float
    index: str | int | None = None
    direction: int = 1
    threshold: Quantity | None = None


@dataclass(frozen=True)
class RecordPlan:
    """A declared record; `conditions` are SI for a gear pair and as declared for an oscillator.

    `window` is begin and end in s on the record's own clock, `resample` the rate in Hz that it is to have.
    """

    key: str
    name: str | None
    file: str
    role: str | None
    rows: tuple[int, int] | None
    timing: TimePlan
    channels: tuple[ChannelPlan, ...]
    encoders: tuple[EncoderPlan, ...]
    conditions: Mapping[str, Quantity]
    gear_torque_mode: str | None
    mesh_index: bool
    window: tuple[float, float] | None = None
    resample: float | None = None


@dataclass(frozen=True)
class Plan:
    """A declared measurement; `own` parameters are in units still to be compared with the channels'."""

    system: str
    parameters: Mapping[str, Quantity]
    own: Mapping[str, Quantity]
    records: tuple[RecordPlan, ...]
    segment_s: float | None = None
