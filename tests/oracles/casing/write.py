"""A case as the folder that a user would hand over."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import yaml

from .case import CasingCase

WIDTH = 0.1  # of a pulse, share of the distance between pulses


def write_case(
    cases: CasingCase | Sequence[tuple[CasingCase, str]], folder: str | Path, kind: str = "npz", train: bool = False
) -> Path:
    """Write records and measurement.yaml; returns its path. The truth stays out of the folder.

    Args:
        cases: One case, or several with their roles.
        folder: Made here.
        kind: npz or csv.
        train: The tacho as a sampled pulse train instead of the times of its pulses (csv: always).
    """
    folder = Path(folder)
    folder.mkdir(parents=True)
    given = [(cases, None)] if isinstance(cases, CasingCase) else cases
    records = [_record(folder, i, case, role, kind, train) for i, (case, role) in enumerate(given, start=1)]
    teeth = given[0][0].gears.teeth
    names = ("n_teeth_pinion", "n_teeth_gear")
    parameters = {name: {"value": int(z), "unit": "1"} for name, z in zip(names, teeth, strict=True)}
    path = folder / "measurement.yaml"
    content = {"system": "gear_pair", "parameters": parameters, "records": records}
    path.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")
    return path


def _record(folder: Path, number: int, case: CasingCase, role: str | None, kind: str, train: bool) -> dict[str, object]:
    name = f"run_{number}.{kind}"
    columns = {"casing": case.acceleration}
    if train or kind == "csv":
        columns["tacho"] = _train(case)
        tacho = {"column": "tacho"}
    else:
        columns["pulses"] = case.pulses
        tacho = {"timestamps": "pulses", "unit": "s"}
    if kind == "npz":
        np.savez(folder / name, **columns)
    else:
        table = np.column_stack(list(columns.values()))
        np.savetxt(folder / name, table, delimiter=",", header=",".join(columns), comments="", fmt="%.6g")
    declared = {
        "file": name,
        "sampling_rate": {"value": case.rate, "unit": "Hz"},
        "channels": {"acceleration": {"column": "casing", "unit": "m/s^2", "mounting": "casing"}},
        "encoders": {"tacho": tacho | {"pulses_per_revolution": case.per_turn}},
    }
    return declared | ({"role": role} if role else {})


def _train(case: CasingCase) -> np.ndarray:
    """(n,) V: 5 V during a pulse, 0 V between."""
    time = np.arange(len(case.acceleration)) / case.rate
    last = np.searchsorted(case.pulses, time, side="right") - 1
    since = np.where(last >= 0, time - case.pulses[np.maximum(last, 0)], np.inf)
    return 5.0 * (since < max(WIDTH * np.median(np.diff(case.pulses)), 1.5 / case.rate))
