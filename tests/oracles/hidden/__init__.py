"""Measurements with hidden effects and the truth about them, made without the package that has to find them."""

from .case import HiddenCase, HiddenRecord, draw_case, draw_cases
from .catalogue import EFFECTS, FAULTS, FOREIGN, STRATA
from .write import write_case

__all__ = [
    "EFFECTS", "FAULTS", "FOREIGN", "STRATA", "HiddenCase", "HiddenRecord", "draw_case", "draw_cases", "write_case",
]  # fmt: skip
