"""Writing records as files that load_measurement reads back to the same numbers."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import yaml

from gear_damping.errors import InputError, Problem
from gear_damping.measurement import layout
from gear_damping.measurement.declaration import declared_plan
from gear_damping.measurement.record import Channel, Quantity, Record
from gear_damping.measurement.staircase import is_staircase
from gear_damping.measurement.vocabulary import CHANNEL_MODELS, CHANNELS, SYSTEMS
from gear_damping.schema.mappings import names
from gear_damping.schema.values import Problems
from gear_damping.units import DIGITS

if TYPE_CHECKING:
    from gear_damping.physics.systems.base import System

YAML_NAME = "measurement.yaml"
_FILE_NAME = re.compile(r"^[A-Za-z0-9][\w.-]*$")


def write_measurement(
    folder: str | Path,
    system: str,
    records: Sequence[Record],
    parameters: Mapping[str, Quantity] | None = None,
    segment_s: float | None = None,
    own: "type[System] | None" = None,
) -> Path:
    """Write one CSV file per record and a measurement.yaml beside them.

    Args:
        folder: Is made where it does not exist.
        system: The name of the system.
        records: Each with a unique name that can be a file name; `file` and `sha256` are not used.
        parameters: Nominal values of the rig, in SI or the oscillator's own units.
        segment_s: Length of the segments that records are fitted and scored in, in s.
        own: Its declaration, where it is one of one's own; the file is read with `plugins` then.

    Returns:
        The path of the measurement.yaml.

    Raises:
        InputError: one of the files exists already, or the records are none that could be read back: a response
            or an input is missing, or a sensor is stated that its channel cannot have. Nothing is written then.
        ValueError: an unknown system or channel, or names that repeat or cannot be file names.
    """
    _refuse_names(system, records, own)
    folder = Path(folder)
    files = {record.name: folder / f"{record.name}.csv" for record in records}
    taken = [path for path in (*files.values(), folder / YAML_NAME) if path.exists()]
    if taken:
        remedy = "choose another folder, or remove it"
        raise InputError([Problem("folder", "the file exists already", str(path), remedy) for path in taken])
    content = {
        "system": system,
        "segments": {"value": float(segment_s), "unit": "s"} if segment_s else None,
        "parameters": {name: _quantity(quantity) for name, quantity in (parameters or {}).items()},
        "records": [_declaration(system, record) for record in records],
    }
    content = {key: value for key, value in content.items() if value}
    problems = Problems()
    declared_plan(content, problems, str(folder / YAML_NAME), {} if own is None else {system: own})
    problems.raise_any()
    folder.mkdir(parents=True, exist_ok=True)
    for record in records:
        _write_csv(files[record.name], record)
    with (folder / YAML_NAME).open("x", encoding="utf-8") as file:
        file.write(yaml.safe_dump(content, sort_keys=False))
    return folder / YAML_NAME


def _refuse_names(system: str, records: Sequence[Record], own: "type[System] | None") -> None:
    if own is None and system not in SYSTEMS:
        raise ValueError(f"system must be one of {SYSTEMS}, not {system!r}")
    names = [record.name for record in records]
    if not names or len(set(names)) < len(names):
        raise ValueError(f"records must be at least one, each with its own name, not {names}; rename them")
    for record in records:
        if not _FILE_NAME.match(record.name):
            rule = f"the record name {record.name!r} is no file name"
            raise ValueError(f"{rule}; use letters, digits, '_', '-', '.'")
        unknown = set(record.channels) - set(CHANNELS[system] if own is None else (*own.responses, *own.inputs))
        if unknown:
            rule = f"record '{record.name}' has channels {sorted(unknown)} that no {system} has"
            raise ValueError(f"{rule}; drop them")


def _write_csv(path: Path, record: Record) -> None:
    """Seventeen digits bring every float64 back exactly, where the file holds the quantity itself."""
    columns = [record.time]
    for channel in record.channels.values():
        seen = channel.values - channel.mean_added
        columns.append(seen * (channel.polarity * channel.gain / channel.declared_factor))
    with path.open("x", encoding="utf-8") as file:
        file.write(",".join(["time", *record.channels]) + "\n")
        np.savetxt(file, np.column_stack(columns), delimiter=",", fmt="%.17g")


def _declaration(system: str, record: Record) -> dict[str, object]:
    models = CHANNEL_MODELS.get(system, CHANNEL_MODELS[layout.OWN_AS])
    channels: dict[str, object] = {"time": {"column": "time", "unit": "s"}}
    channels |= {name: _channel(channel, tuple(names(models[name]))) for name, channel in record.channels.items()}
    conditions: dict[str, object] = {name: _quantity(value) for name, value in record.conditions.items()}
    if record.gear_torque_mode:
        conditions["gear_torque"] = record.gear_torque_mode
    declaration = {
        "name": record.name,
        "file": f"{record.name}.csv",
        "role": record.role,
        "channels": channels,
        "conditions": conditions,
        "mesh_index": record.mesh_index,
    }
    return {key: value for key, value in declaration.items() if value}


def _channel(channel: Channel, keys: Sequence[str]) -> dict[str, object]:
    """The column, its unit and what differs from the defaults of a sensor; `keys` are those that it may have."""
    declared: dict[str, object] = {"column": channel.name, "unit": channel.declared_unit}
    for name, unit in (
        ("lowpass", "Hz"), ("highpass", "Hz"), ("delay", "s"), ("timing_error", "s"),
        ("radius", "m"),
        ("range", channel.unit), ("noise", channel.unit),
    ):  # fmt: skip
        value = getattr(channel, name)
        if value:
            declared[name] = {"value": float(value), "unit": unit}
        if value and name in ("lowpass", "highpass"):
            declared[name]["order"] = getattr(channel, f"{name}_order")
    for name, default in (
        ("coupling", "DC"), ("uncertainty", 0.0), ("polarity", 1), ("gain", 1.0), ("mounting", None),
        ("shaft", None), ("frame", None),
    ):  # fmt: skip
        value = getattr(channel, name)
        if value != default:
            declared[name] = _share(value) if name == "uncertainty" else value
    if "datum" in keys and channel.mounting != "casing" and ("mounting" not in keys or channel.mounting):
        declared["datum"] = channel.datum
    if "hold" in keys and channel.hold != is_staircase(channel.values):
        declared["hold"] = channel.hold
    return declared


def _quantity(quantity: Quantity) -> dict[str, object]:
    written: dict[str, object] = {"value": float(quantity.value)}
    if quantity.unit != "own":
        written["unit"] = quantity.unit
    if quantity.uncertainty:
        written["uncertainty"] = _share(float(quantity.uncertainty))
    return written


def _share(uncertainty: float) -> float | str:
    """A relative uncertainty as it is declared: one above 1 in per cent."""
    return uncertainty if uncertainty <= 1 else f"{100 * uncertainty:.{DIGITS}g} %"
