"""What a user may say about the solver."""

from dataclasses import dataclass
from typing import Literal

Engine = Literal["auto", "native", "fused", "eager"]


@dataclass(frozen=True)
class Solver:
    """Settings of the fixed-step solver.

    Args:
        accuracy: Relative L2 error asked of a trajectory with smooth contact; sub-steps follow from it.
        substeps: Sub-steps per output interval for every member; None: chosen from `accuracy`.
        most_substeps: Of those that are chosen from `accuracy`; what would need more is less accurate.
        engine: `native`: the model's terms written as C++ and compiled once; `fused`: each sub-step one
            torch.compile kernel (what a GPU runs); `eager`: plain PyTorch; `auto`: the fastest there is.
        chunk: Members integrated together; bounds the memory.
    """

    accuracy: float = 1e-5
    substeps: int | None = None
    most_substeps: int = 256
    engine: Engine = "auto"
    chunk: int = 4096
