"""RK4 that knows nothing of contact, compiled as the package compiles its own method (see the .cpp beside)."""

import ctypes
from pathlib import Path

import numpy as np
import torch

from benchmarks.engines.own import Run, assembled
from benchmarks.members import SAMPLING_RATE, draw
from gear_damping.simulation.integrate import initial_states
from gear_damping.simulation.kernel import Batch, Kernel
from gear_damping.simulation.layout import Layout
from gear_damping.simulation.native import build, source
from gear_damping.simulation.series import Series


def rk4_unaware(batch: int, n_samples: int, substeps: int, keep: int = 64) -> Run:
    members = draw(batch, backlash=True)
    model, values = assembled(members)
    prepared = model.prepare(values)
    interval = 1 / (SAMPLING_RATE * prepared.scales.time)
    layout, series = Layout(prepared), Series(())
    fixed, start = layout.pack(prepared, interval).contiguous(), initial_states(model, prepared).contiguous()
    example = Batch(fixed, fixed[:0], fixed.new_zeros(()))
    kernel = Kernel(model, layout, series, example, start)
    library = _library(source.kernel_source(kernel, example, start, build.width_and_options()[0]))

    def run() -> np.ndarray:
        out = torch.empty(*start.shape, n_samples, dtype=torch.float64)
        out[..., 0] = start
        numbers = (ctypes.c_long(n) for n in (batch, n_samples - 1, substeps, n_samples))
        library.walk(*numbers, *(ctypes.c_void_p(t.data_ptr()) for t in (fixed, start, out[..., 1:])))
        return out[0, :keep].numpy()

    return run


def _library(text: str) -> ctypes.CDLL:
    driver = (source.HERE / "driver.cpp").read_text()
    return build.compiled(text.replace(driver, Path(__file__).with_name("rk4_unaware.cpp").read_text()))
