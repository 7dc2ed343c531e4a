"""Records as another laboratory keeps them: csv, mat, npz, wav or counters of encoders, and measurement.yaml."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from scipy.io import savemat, wavfile

from .motion import Motion, Run
from .pair import PRESSURE_ANGLE, Rig
from .sensors import FACTORS, Sensor

FULL_SCALE = 32767  # steps of a wav file of 16 bit
DIGITS = 6  # of an angle / rad
FORMATS = {"t": "%.7f", "phi1": "%.7f", "M1": "%.3f"}  # of csv columns that every sensor has beside its own


@dataclass(frozen=True)
class Record:
    """One record with what was measured, in the unit of the sensor."""

    run: Run
    motion: Motion
    measured: np.ndarray


class _PlainDumper(yaml.SafeDumper):
    """Writes every value out, also where two are the same object."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


@dataclass(frozen=True)
class Table:
    """Columns in csv, mat or npz files.

    column: of the sensor; form: of its numbers in csv. time, angle: whether a time column and the pinion's angle are
    there. digits: of that angle, all where None. name: of the records, by their number.
    """

    kind: str
    column: str
    form: str = "%.8g"
    time: bool = False
    angle: bool = False
    digits: int | None = DIGITS
    name: str = "run{}"

    def states_speed(self, sensor: Sensor) -> bool:
        """Whether the speed is a condition: only where no column tells it."""
        return not self.angle and not sensor.whole

    def write(self, folder: Path, number: int, record: Record, rig: Rig, sensor: Sensor) -> dict[str, Any]:
        """Write a record and return what is declared of its file."""
        columns, name = self._columns(record, rig), self.name.format(number)
        path = folder / f"{name}.{self.kind}"
        if self.kind == "csv":
            forms = [FORMATS.get(key, self.form) for key in columns]
            write_csv(path, columns, forms)
        elif self.kind == "npz":
            np.savez(path, **columns)
        else:
            savemat(path, columns)
        return {"name": name, "file": path.name, "channels": self._channels(record.run, sensor)}

    def _columns(self, record: Record, rig: Rig) -> dict[str, np.ndarray]:
        columns = {"t": np.arange(record.run.samples) / record.run.rate} if self.time else {}
        columns[self.column] = record.measured
        if self.angle:
            angle = np.mod(shaft_angle(rig, record.motion, record.motion.x), 2 * math.pi)
            columns["phi1"] = angle if self.digits is None else np.round(angle, self.digits)
        if callable(record.run.torque):
            columns["M1"] = np.round(record.motion.torque, 3)
        return columns

    def _channels(self, run: Run, sensor: Sensor) -> dict[str, Any]:
        timed = {"time": {"column": "t", "unit": "s"}} if self.time else {"sampling_rate": _rate(run)}
        channels = timed | {sensor.channel: {"column": self.column, "unit": sensor.unit} | mounting(sensor)}
        if self.angle:
            channels["pinion_angle"] = {"column": "phi1", "unit": "rad"}
        if callable(run.torque):
            channels["pinion_torque"] = {"column": "M1", "unit": "Nm"}
        return channels


@dataclass(frozen=True)
class Wav:
    """One channel of 16 bit; full: what the largest number stands for, in the unit of the sensor."""

    full: float

    def states_speed(self, sensor: Sensor) -> bool:
        """No column tells the speed."""
        return True

    def write(self, folder: Path, number: int, record: Record, rig: Rig, sensor: Sensor) -> dict[str, Any]:
        """Write a record and return what is declared of its file."""
        if np.abs(record.measured).max() >= self.full:
            raise ValueError(f"the record goes beyond the range of {self.full} {sensor.unit}")
        name = f"take{number - 1}"
        steps = np.round(record.measured / self.full * FULL_SCALE).astype("<i2")
        wavfile.write(folder / f"{name}.wav", int(record.run.rate), steps)
        channel = {"column": 0, "unit": sensor.unit, "range": quantity(self.full, sensor.unit)} | mounting(sensor)
        return {"name": name, "file": f"{name}.wav", "channels": {sensor.channel: channel}}


@dataclass(frozen=True)
class Encoders:
    """Counters of both shafts, which run on from record to record; counts: of pinion and gear in a revolution.

    The measured transmission error, with its noise, is laid on both shafts by the shares of their inertias.
    """

    kind: str
    counts: tuple[int, int]

    def states_speed(self, sensor: Sensor) -> bool:
        """The counters tell the speed."""
        return False

    def write(self, folder: Path, number: int, record: Record, rig: Rig, sensor: Sensor) -> dict[str, Any]:
        """Write a record and return what is declared of its file."""
        pinion = shaft_angle(rig, record.motion, record.measured)
        gear = record.motion.gear_angle - rig.shares[1] * record.measured / rig.radii[1]
        turned = {"enc_in": pinion, "enc_out": gear}
        counted = {
            name: np.floor(angle / (2 * math.pi) * count).astype(int)
            for (name, angle), count in zip(turned.items(), self.counts, strict=True)
        }
        path = folder / f"m{number:02d}.{self.kind}"
        if self.kind == "csv":
            write_csv(path, counted, "%d")
        else:
            savemat(path, {name: values.astype("int32") for name, values in counted.items()})
        encoders = {
            shaft: {"column": name, "counts_per_revolution": count}
            for shaft, name, count in zip(("pinion", "gear"), counted, self.counts, strict=True)
        }
        return {"name": path.stem, "file": path.name, "sampling_rate": _rate(record.run), "encoders": encoders}


Writer = Table | Wav | Encoders


def shaft_angle(rig: Rig, motion: Motion, x: np.ndarray) -> np.ndarray:
    """Of the pinion / rad, with its share of the relative motion x / m."""
    return motion.pinion_angle + rig.shares[0] * x / rig.radii[0]


def mounting(sensor: Sensor) -> dict[str, Any]:
    """What a declaration says of a sensor beside column and unit."""
    said: dict[str, Any] = dict(sensor.said)
    if sensor.radius is not None:
        radius = quantity(sensor.radius * FACTORS[sensor.radius_unit], sensor.radius_unit)
        said |= {"mounting": "tangential", "shaft": sensor.shaft, "radius": radius}
    return said


def conditions(rig: Rig, run: Run, gear_torque: str, speed: bool) -> dict[str, Any]:
    """What stands during a record.

    gear_torque: "balanced", "held", or "stated": both torques as numbers, with those of the inertias in a run-up.
    """
    stated: dict[str, Any] = {"pinion_speed": quantity(run.speed, "rpm")} if speed else {}
    if callable(run.torque):
        return stated | {"gear_torque": gear_torque}
    if gear_torque != "stated":
        return stated | {"pinion_torque": quantity(run.torque, "Nm"), "gear_torque": gear_torque}
    (r1, r2), (i1, i2) = rig.radii, rig.inertias
    pinion = run.torque + i1 * run.acceleration
    gear = r2 * run.torque / r1 - i2 * run.acceleration * r1 / r2
    return stated | {"pinion_torque": quantity(pinion, "Nm"), "gear_torque": quantity(gear, "Nm")}


def parameters(rig: Rig) -> dict[str, Any]:
    """What is known of the gears."""
    return {
        "n_teeth_pinion": rig.teeth[0],
        "n_teeth_gear": rig.teeth[1],
        "module": quantity(rig.module * 1e3, "mm"),
        "pressure_angle": quantity(PRESSURE_ANGLE, "deg"),
        "inertia_pinion": quantity(rig.inertias[0], "kg*m^2"),
        "inertia_gear": quantity(rig.inertias[1], "kg*m^2"),
        "mesh_stiffness_max": quantity(rig.two_pairs, "N/m"),
        "mesh_stiffness_min": quantity(rig.one_pair, "N/m"),
        "contact_ratio": rig.contact_ratio,
        "damping_ratio": quantity(100 * rig.damping_ratio, "%"),
    }


def write_declaration(folder: Path, known: dict[str, Any], records: Sequence[dict[str, Any]]) -> Path:
    """Write measurement.yaml and return its path."""
    path = folder / "measurement.yaml"
    content = {"system": "gear_pair", "parameters": known, "records": list(records)}
    path.write_text(yaml.dump(content, sort_keys=False, Dumper=_PlainDumper), encoding="utf-8")
    return path


def write_csv(path: Path, columns: dict[str, np.ndarray], form: str | list[str]) -> None:
    """Write columns below a line of their names."""
    values = np.column_stack(list(columns.values()))
    np.savetxt(path, values, delimiter=",", header=",".join(columns), comments="", fmt=form)


def quantity(value: float, unit: str) -> dict[str, Any]:
    """A value of six digits with its unit."""
    return {"value": float(f"{value:.6g}"), "unit": unit}


def _rate(run: Run) -> dict[str, Any]:
    return quantity(run.rate / 1e3, "kHz")
