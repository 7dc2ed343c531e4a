"""An oscillator as the folder that a user would hand over."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import yaml

from .case import OscillatorCase, OscillatorRecord

COLUMNS = {"displacement": "pos", "velocity": "vel", "acceleration": "acc"}


def write_oscillator(case: OscillatorCase, folder: str | Path, records: Sequence[OscillatorRecord] | None = None):
    """Write the records (all where None) and return the path of the measurement.yaml; the truth stays out of it."""
    folder = Path(folder)
    folder.mkdir(parents=True)
    declared = [_record(case, record, folder) for record in (case.records if records is None else records)]
    content: dict[str, object] = {"system": "oscillator"}
    if case.nominal:
        content["parameters"] = {name: dict(value) for name, value in case.nominal.items()}
    path = folder / "measurement.yaml"
    path.write_text(yaml.safe_dump(content | {"records": declared}, sort_keys=False), encoding="utf-8")
    return path


def _record(case: OscillatorCase, record: OscillatorRecord, folder: Path) -> dict[str, object]:
    response: dict[str, object] = {"column": COLUMNS[case.channel], "unit": case.unit}
    if case.arbitrary and (case.channel != "displacement" or case.seed % 2):  # a displacement's is arbitrary anyway
        response["datum"] = "arbitrary"
    columns = {COLUMNS[case.channel]: record.response}
    channels: dict[str, object] = {case.channel: response}
    if record.force is not None:
        columns["drive"] = record.force
        channels["force"] = {"column": "drive", "unit": case.force_unit}
    if record.even and case.seed % 2:
        channels["sampling_rate"] = {"value": record.rate, "unit": "Hz"}
    else:
        columns = {"t": record.time} | columns
        channels["time"] = {"column": "t", "unit": "s"}
    file = f"{record.name}.csv"
    with (folder / file).open("x", encoding="utf-8") as out:
        out.write(",".join(columns) + "\n")
        np.savetxt(out, np.column_stack(list(columns.values())), delimiter=",", fmt="%.12g")
    return {"name": record.name, "file": file, "role": record.role, "channels": channels}
