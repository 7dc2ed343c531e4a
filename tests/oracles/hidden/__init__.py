"""Measurements with hidden effects and the truth about them, made without the package that has to find them."""

from collections.abc import Sequence
from pathlib import Path

from .case import HiddenCase, draw_case, draw_cases
from .catalogue import EFFECTS, FAULTS, FOREIGN, STRATA
from .instruments import HiddenRecord
from .limit import Limit, amplitude_of, limits, power_of_size
from .oscillator import OSCILLATOR_EFFECTS, OscillatorCase, draw_oscillator, write_oscillator
from .setup import PLANS as SENSORS
from .write import write_case as _write_gears

__all__ = [
    "EFFECTS", "FAULTS", "FOREIGN", "OSCILLATOR_EFFECTS", "SENSORS", "STRATA", "HiddenCase", "HiddenRecord", "Limit",
    "OscillatorCase", "amplitude_of", "draw_case", "draw_cases", "draw_oscillator", "limits", "power_of_size",
    "write_case",
]  # fmt: skip


def write_case(case: HiddenCase | OscillatorCase, folder: str | Path, records: Sequence | None = None) -> Path:
    """Write the records (all where None) of a case and return the path of its measurement.yaml."""
    if isinstance(case, OscillatorCase):
        return write_oscillator(case, folder, records)
    return _write_gears(case, folder, records)
