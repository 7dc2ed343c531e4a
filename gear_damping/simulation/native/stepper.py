"""The native counterpart of `Stepper`: the same walk, many intervals at a time, on every core."""

import ctypes
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import pairwise

import torch
from torch import Tensor

from gear_damping.simulation.stepper import Stepper

BLOCK = 128  # output intervals between two reports of progress


class NativeStepper(Stepper):
    """Walks a batch with a compiled kernel; lanes are shared out over PyTorch's number of threads."""

    def __init__(self, kernel: object, fixed: Tensor, series: Tensor, library: ctypes.CDLL, lanes: int) -> None:
        """Prepare a batch; arguments as for `Stepper`, and the kernel's library with the lanes it steps together."""
        super().__init__(kernel, fixed, series, compiled=False)
        self.kernel_library, self.group = library, lanes

    def run(self, state: Tensor, out: Tensor, substeps: int, report: Callable[[int], None]) -> None:
        """Fill `out` (intervals, n_state, batch), contiguous in time, with the state after each interval."""
        state, series = state.clone().contiguous(), self.series.contiguous()
        fixed, locked = self.fixed.contiguous(), self.locked.contiguous()
        lanes, total, length = fixed.shape[1], out.shape[0], out.stride(2)
        if out.stride() != (1, lanes * length, length):
            raise ValueError("out must be a view of (n_state, batch, time) in memory: permute it")
        rates = self._acceleration_rows(length)
        shares = self._shares(lanes)
        with ThreadPoolExecutor(len(shares)) as pool:
            for first in range(0, total, BLOCK):
                count = min(BLOCK, total - first)
                now = None if rates is None else rates[:, first + 1 :]  # the first column is the start
                tensors = (fixed, series, state, locked, out[first : first + count], now)
                numbers = (first, count, substeps, length)
                list(pool.map(partial(self._walk, lanes, numbers, tensors), shares))
                report(first + count)

    def _acceleration_rows(self, length: int) -> Tensor | None:
        """Where the kernel writes the acceleration, in rows as long as those of the states; None: it is not asked."""
        if self.acceleration is not None and self.acceleration.stride() != (length, 1):
            raise ValueError("acceleration must lie in memory as one of the states does, (batch, time)")
        return self.acceleration

    def _walk(
        self, lanes: int, numbers: tuple[int, ...], tensors: tuple[Tensor | None, ...], share: tuple[int, int]
    ) -> None:
        pointers = (ctypes.c_void_p(None if tensor is None else tensor.data_ptr()) for tensor in tensors)
        self.kernel_library.walk(*(ctypes.c_long(n) for n in (lanes, *share, *numbers)), *pointers)

    def _shares(self, lanes: int) -> list[tuple[int, int]]:
        """Ranges of lanes, whole groups each, one for each thread that has something to do."""
        blocks = -(-lanes // self.group)
        threads = max(1, min(torch.get_num_threads(), blocks))
        edges = [min(lanes, self.group * round(blocks * i / threads)) for i in range(threads + 1)]
        return [(a, b) for a, b in pairwise(edges) if b > a]
