"""What a user may say about the solver."""

from collections.abc import Callable
from dataclasses import dataclass, field
from numbers import Integral, Real
from typing import Any, Literal

Progress = Callable[[int, int], None]  # told (done, total)
Engine = Literal["auto", "native", "eager"]


@dataclass(frozen=True)
class Solver:
    """Settings of the fixed-step solver.

    Args:
        accuracy: Relative L2 error asked of a trajectory with smooth contact; sub-steps follow from it.
        substeps: Sub-steps per output interval for every member; None: chosen from `accuracy`.
        most_substeps: Of those that are chosen from `accuracy`; what would need more is less accurate.
        engine: `native`: the model's terms written as C++ and compiled once; `eager`: plain PyTorch; `auto`:
            native where there is a C++ compiler. Values on a GPU are stepped on the CPU and come back there.
        chunk: Members integrated together; bounds the memory.
        block: Output intervals whose graph is kept together in backpropagation; bounds the memory.
        acceleration: Whether it keeps the acceleration too: the right-hand side of the equation of motion at the output
            instants. Where it jumps at an output (a tooth pair, a held load), it is the value before the jump, but for
            the first one.
        progress: Told (done, total) as the work proceeds.
    """

    accuracy: float = 1e-5
    substeps: int | None = None
    most_substeps: int = 256
    engine: Engine = "auto"
    chunk: int = 4096
    block: int = 16
    acceleration: bool = False
    progress: Progress | None = field(default=None, compare=False, repr=False)

    def __getstate__(self) -> dict[str, Any]:
        """What is kept in a file: who is told of the progress goes on in its own process alone."""
        return vars(self) | {"progress": None}

    def __post_init__(self) -> None:
        """Numbers of numpy become plain ones; what is none stays, and is refused where it is used."""
        for name in ("accuracy", "substeps", "most_substeps", "chunk", "block"):
            value = getattr(self, name)
            if isinstance(value, Real) and not isinstance(value, bool):
                object.__setattr__(self, name, int(value) if isinstance(value, Integral) else float(value))
