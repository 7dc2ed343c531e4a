"""What a measurement is inside the program: arrays in SI (or in the rig's own unit) with their story."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from gear_damping.physics.systems.base import System

ROLES = ("fit", "holdout", "reference")
SEVERITIES = ("data_problem", "note")


@dataclass(frozen=True)
class Quantity:
    """A value with its unit; `uncertainty` is relative, and 0 means known.

    Args:
        value: The value, in SI unless `unit` names the rig's own unit.
        unit: The unit of `value`.
        uncertainty: Relative standard uncertainty, >= 0.
    """

    value: float
    unit: str
    uncertainty: float = 0.0


@dataclass(frozen=True)
class Finding:
    """Something suspicious in data that could be read.

    Args:
        kind: What it is, for example `clipped` or `dropped_samples`.
        message: A sentence with the remedy.
        record: The record's name.
        channel: The channel, or "" where it concerns the whole record.
        sample: The first sample of the record that shows it, or None.
        severity: `data_problem` (no physical cause may be named before it is cured) or `note`.
    """

    kind: str
    message: str
    record: str = ""
    channel: str = ""
    sample: int | None = None
    severity: str = "data_problem"


@dataclass(frozen=True, eq=False)
class Channel:
    """One measured signal and what is declared about its sensor.

    Args:
        name: The quantity, for example `transmission_error` or `displacement`.
        values: (n,) float64 in `unit`; polarity is applied, delay and filters are not undone.
        unit: SI for a gear pair; an oscillator stays in the unit that it was measured in.
        declared_unit: The unit in the file; residuals are reported in it.
        declared_factor: One `declared_unit` in `unit`.
        lowpass: Corner of the sensor's low-pass in Hz.
        lowpass_order: Poles of that Butterworth filter.
        highpass: Corner of its high-pass in Hz.
        highpass_order: Poles of that Butterworth filter.
        coupling: `DC` or `AC`; an AC channel knows nothing of the mean.
        delay: How late the channel is, in s.
        range: Full scale, in `unit`.
        mean_added: What was added to values that had lost their mean, in `unit`; the sensor never saw it.
        noise: Standard deviation of the sensor noise, in `unit`.
        uncertainty: Relative uncertainty of the gain; 0 means known.
        polarity: The sign that the file's values were multiplied by.
        gain: What the sensor multiplies by; the file's values were divided by it.
        datum: `absolute`, or `arbitrary` where the zero means nothing; resolved, never "by default".
        mounting: `tangential` or `casing`, for the acceleration of a gear pair.
        radius: Radius in m at which a tangential acceleration is measured.
        shaft: `pinion` or `gear`, on which a tangential accelerometer sits.
        frame: Of an oscillator on a base whose acceleration is measured: `absolute`, or `relative` to the base.
        hold: Of an input, whether it stays at each sample's value until the next one.
        timing_error: Standard deviation in s by which a pinion's angle may be late, whose edges are known to a sample.
        rounding: Standard deviation of what the steps of a converter left of values that were taken to a lower rate
            afterwards, in `unit`; 0 where the steps are still to be seen, or noise had spread the values over them.
    """

    name: str
    values: NDArray[np.float64]
    unit: str
    declared_unit: str = ""
    declared_factor: float = 1.0
    lowpass: float | None = None
    lowpass_order: int = 2
    highpass: float | None = None
    highpass_order: int = 1
    coupling: str = "DC"
    delay: float = 0.0
    range: float | None = None
    mean_added: float = 0.0
    noise: float | None = None
    uncertainty: float = 0.0
    polarity: int = 1
    gain: float = 1.0
    datum: str = "absolute"
    mounting: str | None = None
    radius: float | None = None
    shaft: str | None = None
    frame: str | None = None
    hold: bool = False
    timing_error: float = 0.0
    rounding: float = 0.0

    def __post_init__(self) -> None:
        if np.ndim(self.values) != 1:
            rule = f"values of channel '{self.name}' must be one-dimensional, not {np.shape(self.values)}"
            raise ValueError(f"{rule}; ravel them")
        if not self.declared_unit:
            object.__setattr__(self, "declared_unit", self.unit)

    def __str__(self) -> str:
        low, high = (float(end) / self.declared_factor for end in (self.values.min(), self.values.max()))
        return f"{self.name}: {low:.6g} to {high:.6g} {self.declared_unit}"


@dataclass(frozen=True, eq=False)
class Record:
    """Signals that were measured together.

    Args:
        name: Unique within the measurement.
        file: The file that the values come from.
        sha256: The digest of that file in hexadecimal.
        role: `fit`, `holdout`, `reference` (a healthy record of a casing, to compare with), or None where the
            program holds out operating conditions itself.
        sampling_rate: In Hz; for uneven stamps one over their median step.
        time: (n,) float64, the stamps of the samples in s.
        channels: Channel by name, all of n samples.
        conditions: Constant operating conditions by name, in SI.
        gear_torque_mode: `balanced`, where the gear torque follows the pinion's; one that is held has a value.
        mesh_index: True where the zero of the pinion angle is the zero of the mesh.
        uniform: False where the stamps are too uneven to be put on a grid.
        notes: What was done to the values on their way in.
        findings: What is suspicious in them.
    """

    name: str
    file: Path
    sha256: str
    role: str | None
    sampling_rate: float
    time: NDArray[np.float64]
    channels: Mapping[str, Channel]
    conditions: Mapping[str, Quantity] = field(default_factory=dict)
    gear_torque_mode: str | None = None
    mesh_index: bool = False
    uniform: bool = True
    notes: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()

    def __post_init__(self) -> None:
        if self.gear_torque_mode not in ("balanced", None):
            rule = f"gear_torque_mode must be 'balanced' or None, not {self.gear_torque_mode!r}"
            raise ValueError(f"{rule}; give a gear torque that is held under conditions")
        if self.role not in (*ROLES, None):
            raise ValueError(f"role must be one of {ROLES} or None, not {self.role!r}")
        if not self.sampling_rate > 0:
            raise ValueError(f"sampling_rate must be positive, not {self.sampling_rate}")
        for name, channel in self.channels.items():
            if channel.values.shape != self.time.shape:
                rule = f"channel '{name}' has {channel.values.shape} samples and time {self.time.shape}"
                raise ValueError(f"{rule}; all channels of a record share its time")

    def __str__(self) -> str:
        role = f" ({self.role})" if self.role else ""
        head = f"{self.name}{role}: {len(self.time)} samples at {self.sampling_rate:.6g} Hz, {self.duration:.6g} s"
        stated = ", ".join(f"{name} {quantity.value:.6g}" for name, quantity in self.conditions.items())
        said = [f"{finding.severity}: {finding.message}" for finding in self.findings]
        lines = [*map(str, self.channels.values()), *([f"conditions in SI: {stated}"] if stated else [])]
        return "\n  ".join([head, *lines, *(f"note: {note}" for note in self.notes), *said])

    @property
    def duration(self) -> float:
        """Time from the first to the last sample, in s."""
        return float(self.time[-1] - self.time[0])

    @property
    def on_casing(self) -> bool:
        """Whether an accelerometer on a casing is among its channels."""
        acceleration = self.channels.get("acceleration")
        return acceleration is not None and acceleration.mounting == "casing"


@dataclass(frozen=True, eq=False)
class Measurement:
    """A rig and what was recorded on it.

    Args:
        system: The name of the system.
        parameters: Nominal values of the rig by name, in SI or the rig's own units.
        records: The records in the order of the file.
        source: The measurement.yaml that they were declared in.
        segment_s: Length in s of the segments that records are fitted and scored in; None where the file says none.
        own_system: The declaration of the system, where it is of a file of one's own.
    """

    system: str
    parameters: Mapping[str, Quantity]
    records: tuple[Record, ...]
    source: Path
    segment_s: float | None = None
    own_system: "type[System] | None" = field(default=None, repr=False)

    def __str__(self) -> str:
        many = f"{len(self.records)} record{'s' if len(self.records) > 1 else ''}"
        return "\n".join([f"{self.system}, {many} of {self.source}", *map(str, self.records)])

    @property
    def base(self) -> "type[System]":
        """The declaration of the system."""
        from gear_damping.physics.systems.known import system_class

        return self.own_system or system_class(self.system)

    @property
    def files(self) -> tuple[Path, ...]:
        """The declaration and the files of the records, each once."""
        return tuple(dict.fromkeys([self.source, *(record.file for record in self.records)]))

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Everything suspicious, over all records."""
        return tuple(finding for record in self.records for finding in record.findings)

    def with_role(self, role: str | None) -> tuple[Record, ...]:
        """The records of one role: `fit`, `holdout`, `reference` or None (not said)."""
        return tuple(record for record in self.records if record.role == role)
