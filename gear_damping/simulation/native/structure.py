"""What decides the source of a kernel, so that a compiled one is found without tracing the model again.

Tracing takes a good second for a model; an explanation walks through dozens of models in one process.
"""

import hashlib
import inspect
from functools import cache
from pathlib import Path

import torch

from gear_damping.simulation.kernel import Kernel

PACKAGE = Path(__file__).resolve().parents[2]
ROOMS = ("physics", "simulation")
SUFFIXES = (".py", ".cpp", ".h")


def structure_of(kernel: Kernel) -> str | None:
    """Everything that the kernel's source follows from; None where a part's own file is not known."""
    parts = [(type(part).__module__, type(part).__qualname__, sorted(part.chosen.items())) for part in kernel.parts]
    try:
        files = {Path(inspect.getfile(type(part))) for part in kernel.parts}
    except (TypeError, OSError):
        return None  # typed in by hand
    own = [_content(path) for path in files if PACKAGE not in path.parents]  # effect files of a user
    described = repr((parts, kernel.layout.entries, kernel.series.names))
    return "\n".join([described, torch.__version__, _package(), *sorted(own)])


@cache
def _package() -> str:
    paths = [path for room in ROOMS for path in sorted((PACKAGE / room).rglob("*")) if path.suffix in SUFFIXES]
    return hashlib.sha256("".join(map(_content, paths)).encode()).hexdigest()


def _content(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
