"""Compiles a kernel's source once and keeps it between processes."""

import ctypes
import hashlib
import logging
import os
import platform
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

log = logging.getLogger(__name__)
HERE = Path(__file__).resolve().parent
FLAGS = ("-O3", "-march=native", "-ffp-contract=fast", "-fno-math-errno", "-std=c++17", "-shared", "-fPIC", "-w")
COMPILE_SECONDS = 300


@cache
def compiler() -> str | None:
    """The C++ compiler of this machine, or None."""
    return next((found for name in ("g++", "clang++") if (found := shutil.which(name))), None)


@cache
def _machine() -> str:
    """What a compiled kernel depends on beside its source."""
    said = subprocess.run([compiler(), "--version"], capture_output=True, text=True, check=True).stdout
    cpu = Path("/proc/cpuinfo")
    flags = [line for line in cpu.read_text().splitlines() if line.startswith("flags")][:1] if cpu.exists() else []
    return "\n".join([said, platform.machine(), *flags])


@cache
def width_and_options() -> tuple[int, tuple[str, ...]]:
    """Lanes of a vector and compiler options that fit this machine."""
    has_library = _compiles("-lmvec")
    options = ("-DHAVE_LIBMVEC", "-lmvec", "-lm") if has_library else ("-lm",)
    wide = "avx512f" in _machine()
    return (8 if wide else 4), options


def _compiles(*options: str) -> bool:
    probe = 'extern "C" double cos(double); double f(double a) { return cos(a); }'
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "probe.cpp"
        source.write_text(probe)
        command = [compiler(), str(source), "-shared", "-fPIC", "-o", str(source.with_suffix(".so")), *options]
        return subprocess.run(command, capture_output=True, check=False).returncode == 0


def cache_folder() -> Path:
    """Where compiled kernels are kept: GEAR_DAMPING_CACHE, or the user's cache folder."""
    own = os.environ.get("GEAR_DAMPING_CACHE")
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(own) if own else Path(home) / "gear_damping"


def compiled(source: str) -> ctypes.CDLL:
    """The library of a kernel; compiled on first use, which is logged, and found again after that.

    Raises:
        RuntimeError: the compiler refused the source.
    """
    _, options = width_and_options()
    key = hashlib.sha256("\n".join([source, *FLAGS, *options, _machine()]).encode()).hexdigest()[:32]
    target = cache_folder() / "kernels" / f"{key}.so"
    if not target.exists():
        log.info("compiling the simulation of this model (once, a few seconds)")
        _compile(source, options, target)
    return ctypes.CDLL(str(target))


def _compile(source: str, options: tuple[str, ...], target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent) as folder:
        text, made = Path(folder) / "kernel.cpp", Path(folder) / "kernel.so"
        text.write_text(source)
        command = [compiler(), *FLAGS, str(text), "-o", str(made), *options]
        said = subprocess.run(command, capture_output=True, text=True, check=False, timeout=COMPILE_SECONDS)
        if said.returncode:
            raise RuntimeError(f"the compiler refused a kernel:\n{said.stderr[:2000]}")
        made.replace(target)  # whole or not at all, also when two processes compile at once
