"""The native counterpart of `Stepper`: the same walk, many intervals at a time, on every core."""

import ctypes
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache, partial
from itertools import pairwise

import torch
from torch import Tensor

from gear_damping.simulation.series import SharedSeries
from gear_damping.simulation.stepper import Stepper

BLOCK = 128  # output intervals between two reports of progress


class NativeStepper(Stepper):
    """Walks a batch with a compiled kernel; members are shared out over PyTorch's number of threads."""

    def __init__(self, kernel: object, fixed: Tensor, series: SharedSeries, library: ctypes.CDLL, group: int) -> None:
        """Prepare a batch; arguments as for `Stepper`, and the kernel's library with the members it steps together."""
        super().__init__(kernel, fixed, series)
        self.kernel_library, self.group = library, group

    def run(self, state: Tensor, out: Tensor, substeps: int, report: Callable[[int], None]) -> None:
        """Fill `out` (intervals, n_state, batch), contiguous in time, with the state after each interval."""
        state, fixed, active_branch = (
            state.clone().contiguous(),
            self.fixed.contiguous(),
            self.active_branch.contiguous(),
        )
        coefficients, source = self.series.coefficients.contiguous(), self.series.source.contiguous()
        driven, sources = (coefficients, source, self.series.factor.contiguous()), coefficients.shape[2]
        batch, total, length = fixed.shape[1], out.shape[0], out.stride(2)
        if out.stride() != (1, batch * length, length):
            raise ValueError("out must be a view of (n_state, batch, time) in memory: permute it")
        rates = self._acceleration_rows(length)
        shares = self._shares(batch)
        for first in range(0, total, BLOCK):
            count = min(BLOCK, total - first)
            now = None if rates is None else rates[:, first + 1 :]  # the first column is the start
            tensors = (fixed, *driven, state, active_branch, out[first : first + count], now)
            numbers = (first, count, substeps, length, sources)
            in_parallel(partial(self._walk, batch, numbers, tensors), shares)
            report(first + count)

    def _acceleration_rows(self, length: int) -> Tensor | None:
        """Where the kernel writes the acceleration, in rows as long as those of the states; None: it is not asked."""
        if self.acceleration is not None and self.acceleration.stride() != (length, 1):
            raise ValueError("acceleration must lie in memory as one of the states does, (batch, time)")
        return self.acceleration

    def _walk(
        self, batch: int, numbers: tuple[int, ...], tensors: tuple[Tensor | None, ...], share: tuple[int, int]
    ) -> None:
        pointers = (ctypes.c_void_p(None if tensor is None else tensor.data_ptr()) for tensor in tensors)
        self.kernel_library.walk(*(ctypes.c_long(n) for n in (batch, *share, *numbers)), *pointers)

    def _shares(self, batch: int) -> list[tuple[int, int]]:
        """Ranges of members, whole groups each, one for each thread that has something to do."""
        blocks = -(-batch // self.group)
        threads = max(1, min(torch.get_num_threads(), blocks))
        edges = [min(batch, self.group * round(blocks * i / threads)) for i in range(threads + 1)]
        return [(a, b) for a, b in pairwise(edges) if b > a]


def in_parallel(work: Callable[[tuple[int, int]], None], shares: list[tuple[int, int]]) -> None:
    """Do the first share here and the others on threads of their own."""
    others = [_threads(os.getpid(), len(shares) - 1).submit(work, share) for share in shares[1:]]
    work(shares[0])
    for other in others:
        other.result()


@cache
def _threads(process: int, count: int) -> ThreadPoolExecutor:
    """Threads that are kept from call to call; a forked process does not have its parent's."""
    return ThreadPoolExecutor(count, thread_name_prefix=f"kernel-{process}")
