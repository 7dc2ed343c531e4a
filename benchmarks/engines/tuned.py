"""The benchmark's equation in C++ written by hand (see the .cpp beside): the limit of the processor."""

import ctypes
from pathlib import Path

import numpy as np

from benchmarks.engines.own import Run
from benchmarks.engines.simulation_peers import cosine_powers
from benchmarks.members import draw
from gear_damping.simulation.native import build, source

LANES = 32  # of a group, as in the .cpp


def tuned_cpp(batch: int, substeps: int, cosines: bool = False, exact_power: bool = False, keep: int = 64) -> Run:
    """Written for this equation alone; or with the package's cosines, or its power in double precision."""
    p = draw(batch).natural()
    library = _library(cosines, exact_power)
    lanes = -(-batch // LANES) * LANES
    rows = np.stack([np.log2(p["a"]), *(p[name] for name in ("n", "y0", "w", "phase"))])
    rows = np.ascontiguousarray(np.pad(rows, ((0, 0), (0, lanes - batch)), mode="edge"))
    powers, count = np.ascontiguousarray(cosine_powers(p["c"])), len(p["t"]) - 1

    def run() -> np.ndarray:
        out = np.empty((lanes, count + 1))
        pointers = (ctypes.c_void_p(array.ctypes.data) for array in (rows, powers, out))
        numbers = (ctypes.c_long(n) for n in (lanes, count, substeps))
        library.walk(*numbers, ctypes.c_double(p["t"][1]), *pointers)
        return out[:keep]

    return run


def _library(cosines: bool, exact_power: bool) -> ctypes.CDLL:
    if build.width_and_options()[0] != 8:
        raise RuntimeError("it is written for AVX-512, which this processor does not have")
    chosen = {"WIDTH 8": True, "COSINES": cosines, "EXACT_POWER": exact_power}
    defined = [f"#define {name}" for name, wanted in chosen.items() if wanted]
    own = Path(__file__).with_name("tuned.cpp").read_text()
    return build.compiled("\n".join([*defined, (source.HERE / "vectors.h").read_text(), source.tableau(), own]))
