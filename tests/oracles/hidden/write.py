"""A case as the folder that a user would hand over: one CSV file per record and measurement.yaml beside them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import yaml

from .case import HiddenCase, HiddenRecord
from .faults import Sheet, spoilt
from .setup import FACTORS, SPEED_UNCERTAINTY, Setup

COLUMNS = {"transmission_error": "dte", "pinion_torque": "T1", "gear_torque": "T2", "pinion_angle": "theta1",
           "pinion_speed": "n1", "gear_speed": "n2", "acceleration": "acc"}  # fmt: skip


def write_case(case: HiddenCase, folder: str | Path, records: Sequence[HiddenRecord] | None = None) -> Path:
    """Write the records (all where None) and return the path of the measurement.yaml.

    The truth stays out of the folder. A gear torque that follows the pinion's is declared `balanced`, one that
    stands is given as a channel; every other case wraps its angle, as encoders do.
    """
    folder = Path(folder)
    folder.mkdir(parents=True)
    records = case.records if records is None else records
    sheets = [_sheet(case, record, len(records) == 1) for record in records]
    content = {"system": "gear_pair", "parameters": {name: dict(value) for name, value in case.nominal.items()}}
    if case.fault:
        spoilt(case.fault, sheets, content, np.random.default_rng([case.seed, 99]))
    for sheet in sheets:
        _write_csv(folder / sheet.declared["file"], sheet)
    path = folder / "measurement.yaml"
    text = yaml.safe_dump(content | {"records": [sheet.declared for sheet in sheets]}, sort_keys=False)
    path.write_text(text, encoding="utf-8")
    return path


def _sheet(case: HiddenCase, record: HiddenRecord, alone: bool) -> Sheet:
    unit = case.setup.units
    known = [name for name in record.channels if name in COLUMNS]
    shown = [name for name in known if name != "gear_torque" or case.gear_torque == "held"]
    columns = {"t": record.time} | {COLUMNS[name]: record.channels[name] * FACTORS[unit[name]] for name in shown}
    if case.seed % 2 and "theta1" in columns:
        columns["theta1"] = np.mod(columns["theta1"], 2.0 * np.pi * FACTORS[unit["pinion_angle"]])
    channels: dict[str, object] = {"time": {"column": "t", "unit": "s"}}
    channels |= {name: {"column": COLUMNS[name], "unit": unit[name]} for name in shown}
    if case.gear_torque == "balanced" and "pinion_torque" in channels:
        channels["gear_torque"] = "balanced"
    declared: dict[str, object] = {"file": f"{record.name}.csv"}
    if not alone:
        declared["role"] = record.condition.role
    sheet = Sheet(columns, declared | {"channels": channels})
    _declare(case.setup, record, sheet)
    return sheet


def _declare(setup: Setup, record: HiddenRecord, sheet: Sheet) -> None:
    """What is said of the sensors beside column and unit."""
    said, channels = sheet.declared, sheet.declared["channels"]
    response = channels.get(setup.response, {})
    if setup.corner is not None:
        response |= {"coupling": "AC", "highpass": {"value": setup.corner, "unit": "Hz"}}
    elif setup.datum == "arbitrary":
        response["datum"] = "arbitrary"
    if setup.response == "acceleration":
        radius = {"value": round(setup.radius * 1e3, 6), "unit": "mm"}
        response |= {"mounting": "tangential", "radius": radius, "shaft": setup.shaft}
    if setup.counts is not None:
        for shaft in ("pinion", "gear"):
            sheet.columns[f"count_{shaft}"] = record.channels[f"{shaft}_counts"]
        said["encoders"] = {shaft: {"column": f"count_{shaft}", "counts_per_revolution": count}
                            for shaft, count in zip(("pinion", "gear"), setup.counts, strict=True)}  # fmt: skip
    conditions = {name: {"value": value * FACTORS[setup.units[name]], "unit": setup.units[name]}
                  for name, value in record.stated.items()}  # fmt: skip
    if setup.speed == "uncertain":
        conditions["pinion_speed"]["uncertainty"] = SPEED_UNCERTAINTY
    if "pinion_torque" in conditions:
        conditions["gear_torque"] = "balanced"
    if conditions:
        said["conditions"] = conditions


def _write_csv(path: Path, sheet: Sheet) -> None:
    with path.open("x", encoding="utf-8") as file:
        if sheet.columns:
            file.write(",".join(sheet.columns) + "\n")
            np.savetxt(file, np.column_stack(list(sheet.columns.values())), delimiter=",", fmt="%.12g")
