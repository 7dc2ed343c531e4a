"""Made-up measurements of a second rig: another hand, another stiffness law, other sensors and files.

Nothing here imports the package that has to explain them. Every case can be written alone: it knows where its random
numbers begin in the stream of its set.
"""

from pathlib import Path
from typing import Any

from .case import Case, write
from .cases import CASES, SETS
from .drawn import drawn

DRAWN = "r"  # begins the name of a case that is drawn by the number behind it
__all__ = ["CASES", "DRAWN", "SETS", "Case", "drawn", "write_case"]


def write_case(name: str, folder: str | Path) -> dict[str, Any]:
    """Write measurement.yaml and the files of a case into a new folder, and return the truth about it."""
    case = drawn(int(name.removeprefix(DRAWN))) if name.startswith(DRAWN) else CASES[name]
    return write(case, folder)
