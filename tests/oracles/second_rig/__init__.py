"""Made-up measurements of a second rig: another hand, another stiffness law, other sensors and files.

Nothing here imports the package that has to explain them. Every case can be written alone: it knows where its random
numbers begin in the stream of its set.
"""

from pathlib import Path
from typing import Any

from .case import Case, write
from .cases import CASES, SETS

__all__ = ["CASES", "SETS", "Case", "write_case"]


def write_case(name: str, folder: str | Path) -> dict[str, Any]:
    """Write measurement.yaml and the files of a case into a new folder, and return the truth about it."""
    return write(CASES[name], folder)
