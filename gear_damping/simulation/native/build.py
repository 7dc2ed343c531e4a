"""Compiles a kernel's source once and keeps it between processes."""

import atexit
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
COMPILE_SECONDS = 300  # s; a kernel takes some seconds
_said: list[Path] = []


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


def compiled(source: str, structure: str | None = None) -> ctypes.CDLL:
    """The library of a kernel; compiled on first use and found again after that. The first of a process is logged.

    Args:
        source: C++ of the kernel.
        structure: The key under which `known` shall find the library without its source.

    Raises:
        RuntimeError: the compiler refused the source.
    """
    _, options = width_and_options()
    target = _kept(_digest(source, *FLAGS, *options, _machine()))
    if not target.exists():
        log.log(logging.DEBUG if _said else logging.INFO, "compiling simulations (once for each model, a few seconds)")
        _said.append(target)
        _compile(source, options, target)
    if structure is not None:
        _note(_place(structure), target.name)
    return ctypes.CDLL(str(target))


def known(structure: str) -> ctypes.CDLL | None:
    """The library that an earlier process made for a structure, or None.

    Args:
        structure: Everything that decides the kernel's source.
    """
    place = _place(structure)
    target = place.parent / place.read_text() if place.exists() else None
    return ctypes.CDLL(str(target)) if target is not None and target.is_file() else None


def _place(structure: str) -> Path:
    return _kept(_digest(structure, *FLAGS, *width_and_options()[1], _machine())).with_suffix(".structure")


def _kept(key: str) -> Path:
    return kernels_folder() / f"{key}.so"


def kernels_folder() -> Path:
    """Where this process has its kernels: in the cache, or in a folder of its own where that cannot be written to."""
    return _usable(*map(os.environ.get, ("GEAR_DAMPING_CACHE", "XDG_CACHE_HOME", "HOME")))


@cache
def _usable(*named: str | None) -> Path:
    """The folder by what the environment names; said once where it is not kept."""
    try:
        folder = cache_folder() / "kernels"
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except (OSError, RuntimeError) as error:  # RuntimeError: there is no home
        why = f"{error.filename}: {error.strerror}" if isinstance(error, OSError) else str(error)
        log.warning(
            "compiled simulations cannot be kept (%s), so that each process compiles them anew; "
            "GEAR_DAMPING_CACHE=FOLDER names another place", why
        )  # fmt: skip
        own = tempfile.TemporaryDirectory(prefix="gear_damping_")
        atexit.register(own.cleanup)
        return Path(own.name)


def _digest(*parts: str) -> str:
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:32]


def _note(place: Path, name: str) -> None:
    """Write a short file whole, also when two processes write it at once."""
    with tempfile.NamedTemporaryFile("w", dir=place.parent, delete=False) as unfinished:
        unfinished.write(name)
    Path(unfinished.name).replace(place)


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
