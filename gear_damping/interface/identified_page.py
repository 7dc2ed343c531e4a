"""What the pages of both kinds of identification show alike: rows of a table, panels of a figure."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gear_damping.identification.output_error.records import FitRecord

MOST_PANELS = 3  # records of each role shown in the figure
Row = tuple[str, str, str, str]


def estimate_rows(estimates: Mapping[str, Mapping[str, Any] | None]) -> list[Row]:
    """Name, value, 95 % interval and unit of every estimate that there is."""
    found = []
    for name, estimate in estimates.items():
        if estimate is not None:
            low, high = estimate["interval95"]
            found.append((name, f"{estimate['value']:.6g}", f"{low:.6g} … {high:.6g}", estimate["unit"]))
    return found


def residual_rows(records: Mapping[str, Mapping[str, Any]]) -> list[Row]:
    """What is left of every record."""
    return [
        (f"residual of {name} ({found['role']})", f"{found['rmse']:.4g}", "", found["unit"])
        for name, found in records.items()
    ]


def panel(record: FitRecord, role: str, simulated: NDArray[np.float64], factor: float) -> dict[str, Any]:
    """The first channel of a record beside what the simulation makes of it.

    Args:
        record: As it was measured.
        role: Of the record.
        simulated: Its first channel, as far as it was compared, (time,).
        factor: From the declared unit to that of the record.
    """
    samples = len(simulated)
    return {
        "name": record.name,
        "role": role,
        "time": np.arange(samples) / record.sampling_rate,
        "measured": record.response[:samples].numpy() / factor,
        "simulated": simulated / factor,
    }
