"""A case as the folder that a user would hand over: one CSV file per record and measurement.yaml beside them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import yaml

from .case import HiddenCase, HiddenRecord
from .faults import Sheet, spoilt

UNITS = {"transmission_error": ("um", 1e6), "pinion_torque": ("N*m", 1.0), "gear_torque": ("N*m", 1.0),
         "pinion_angle": ("rad", 1.0)}  # fmt: skip
COLUMNS = {"transmission_error": "dte", "pinion_torque": "T1", "gear_torque": "T2", "pinion_angle": "theta1"}


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
    shown = [name for name in record.channels if name != "gear_torque" or case.gear_torque == "held"]
    columns = {"t": record.time} | {COLUMNS[name]: record.channels[name] * UNITS[name][1] for name in shown}
    if case.seed % 2:
        columns["theta1"] = np.mod(columns["theta1"], 2.0 * np.pi)
    channels: dict[str, object] = {"time": {"column": "t", "unit": "s"}}
    channels |= {name: {"column": COLUMNS[name], "unit": UNITS[name][0]} for name in shown}
    if case.gear_torque == "balanced":
        channels["gear_torque"] = "balanced"
    declared: dict[str, object] = {"file": f"{record.name}.csv"}
    if not alone:
        declared["role"] = record.condition.role
    return Sheet(columns, declared | {"channels": channels})


def _write_csv(path: Path, sheet: Sheet) -> None:
    with path.open("x", encoding="utf-8") as file:
        if sheet.columns:
            file.write(",".join(sheet.columns) + "\n")
            np.savetxt(file, np.column_stack(list(sheet.columns.values())), delimiter=",", fmt="%.12g")
