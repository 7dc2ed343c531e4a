"""Our fixed-step method as a method of torchdiffeq's `odeint`.

torchdiffeq keeps its methods in a private table; the entry is added here, once, for the version that
is known to have it.
"""

import importlib
from collections.abc import Callable
from functools import cache

import torch
import torchdiffeq
from torch import Tensor
from torchdiffeq._impl.solvers import FixedGridODESolver

from gear_damping.simulation.stepper import Stepper

METHOD = "active_branch_tsit5"
KNOWN_VERSIONS = ("0.2.5",)
OPTIONS = ("stepper", "substeps", "progress")


class ActiveBranchTsit5(FixedGridODESolver):
    """Walks the output grid 0, 1, 2, … with a `Stepper`.

    Options of `odeint`: `stepper`, `substeps` per output interval, `progress(done, total)` or None.
    torchdiffeq only warns of an unknown option; here it is an error.
    """

    order = 5  # of the method of Tsitouras, as torchdiffeq asks it

    def __init__(self, func: Callable, y0: Tensor, **options: object) -> None:
        own = {name: options.pop(name, None) for name in OPTIONS}
        unknown = set(options) - {"rtol", "atol", "norm"}
        if unknown:
            raise ValueError(f"{METHOD} has no option {sorted(unknown)}; it knows {', '.join(OPTIONS)}")
        super().__init__(func, y0, atol=options.get("atol"))
        self.stepper: Stepper = own["stepper"]
        self.substeps, self.progress = own["substeps"], own["progress"]

    def integrate(self, t: Tensor) -> Tensor:
        """States at every output, (time, n_state, batch); in memory each member's time runs on."""
        if not torch.equal(t, torch.arange(len(t), dtype=t.dtype, device=t.device)):
            raise ValueError(f"{METHOD} counts time in output intervals: t must be 0, 1, 2, …")
        rows = torch.empty(*self.y0.shape, len(t), dtype=self.y0.dtype, device=self.y0.device)
        solution = rows.permute(2, 0, 1)
        solution[0] = self.y0
        self.stepper.start(self.y0)
        report = self.progress or (lambda done, total: None)
        self.stepper.run(self.y0, solution[1:], self.substeps, lambda done: report(done, len(t) - 1))
        return solution

    def _step_func(self, func: Callable, t0: Tensor, dt: Tensor, t1: Tensor, y0: Tensor) -> tuple:
        raise NotImplementedError(f"{METHOD} walks output intervals in integrate()")


@cache
def register() -> None:
    """Make the method known to `odeint`, the first time that it is wanted.

    Raises:
        RuntimeError: this version of torchdiffeq is not one that was tested.
    """
    if torchdiffeq.__version__ not in KNOWN_VERSIONS:
        wanted = " or ".join(KNOWN_VERSIONS)
        raise RuntimeError(f"torchdiffeq {torchdiffeq.__version__} was never tested here; install {wanted}")
    importlib.import_module("torchdiffeq._impl.odeint").SOLVERS[METHOD] = ActiveBranchTsit5
