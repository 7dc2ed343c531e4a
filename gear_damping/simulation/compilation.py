"""How a model is stepped on this machine: by a native kernel, or eagerly in PyTorch."""

import ctypes
import logging
from dataclasses import dataclass
from subprocess import SubprocessError
from typing import get_args

import torch
from torch import Tensor

from gear_damping.simulation.kernel import Batch, Kernel, holds_weights
from gear_damping.simulation.native import build
from gear_damping.simulation.native.source import MOST_VECTORS, kernel_source
from gear_damping.simulation.native.stepper import NativeStepper
from gear_damping.simulation.native.structure import structure_of
from gear_damping.simulation.native.trace import UntraceableError
from gear_damping.simulation.series import SharedSeries
from gear_damping.simulation.solver_settings import Engine
from gear_damping.simulation.stepper import Stepper

log = logging.getLogger(__name__)
_said: set[str] = set()
_libraries: dict[int, ctypes.CDLL | None] = {}


@dataclass(frozen=True)
class Choice:
    """The engine that was chosen: a native library with the members that it steps together, or eager."""

    kernel_library: ctypes.CDLL | None = None
    group: int = 1

    def stepper(self, kernel: Kernel, fixed: Tensor, series: SharedSeries) -> Stepper:
        """A stepper for one batch."""
        if self.kernel_library is not None:
            return NativeStepper(kernel, fixed, series, self.kernel_library, self.group)
        return Stepper(kernel, fixed, series)


def choose(wish: Engine, kernel: Kernel, batch: Batch, state: Tensor) -> Choice:
    """The engine for a model: what was asked for, or the fastest that this machine has.

    That is the native kernel where there is a C++ compiler. torch.compile is no choice: on a CPU it needs the compiler
    too and takes some 200 times as long, and on a GPU longer than the native kernel on one core (docs/speed.md).

    Raises:
        RuntimeError: an engine was asked for that this machine does not have.
        ValueError: there is no such engine.
    """
    if wish not in get_args(Engine):
        raise ValueError(f"engine must be one of {', '.join(get_args(Engine))}, not {wish!r}")
    if wish == "eager":
        return Choice()
    library = _native(kernel, batch, state)
    if library is None and wish == "native":
        raise RuntimeError("simulator.solver.engine=native needs a C++ compiler and terms with a native form")
    return Choice(library, _group(library))


def _group(library: ctypes.CDLL | None) -> int:
    """Members that a kernel steps together at most."""
    return 1 if library is None else build.width_and_options()[0] * MOST_VECTORS


def _native(kernel: Kernel, batch: Batch, state: Tensor) -> ctypes.CDLL | None:
    if id(kernel) not in _libraries:
        _libraries[id(kernel)] = _build(kernel, batch, state)
    return _libraries[id(kernel)]


def _build(kernel: Kernel, batch: Batch, state: Tensor) -> ctypes.CDLL | None:
    if any(holds_weights(part) for part in kernel.parts):
        log_once("an effect that holds a network runs in plain PyTorch, slower than a compiled kernel")
        return None
    if build.compiler() is None:
        log_once("no C++ compiler found: simulation runs without native kernels, slower, with the same results")
        return None
    try:
        structure = structure_of(kernel)
        found = build.known(structure) if structure else None
        if found is not None:
            return found
        with torch.no_grad():
            source = kernel_source(kernel, batch, state, build.width_and_options()[0])
        return build.compiled(source, structure)
    except (UntraceableError, RuntimeError, OSError, SubprocessError) as problem:
        log_once(f"no native kernel for this model, it runs slower with the same results ({problem})")
        return None


def log_once(message: str) -> None:
    """Log a message the first time it comes up in this process."""
    if message not in _said:
        _said.add(message)
        log.warning(message)
