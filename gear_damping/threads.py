"""How the threads of PyTorch behave, which OpenMP reads once, when PyTorch is loaded."""

import os
import sys
from collections.abc import Iterator, MutableMapping
from contextlib import contextmanager
from math import ceil
from pathlib import Path

spins = "torch" in sys.modules and not os.environ.get("OMP_WAIT_POLICY")  # then it is too late to say otherwise
GROUP = Path("/sys/fs/cgroup")  # of this process, as a container sees its own (Linux, cgroups v2 and v1)


def settle_threads(environment: MutableMapping[str, str] = os.environ, group: Path = GROUP) -> None:
    """Threads that wait for each other sleep, and are no more than the cores that may be used.

    OpenMP lets them spin, which takes the cores from whoever they wait for: of two explanations side by side on two
    cores each took ten times as long. A container is often given fewer cores than it sees, and one thread is made for
    each that is seen. What the user has set stays.

    Args:
        environment: Of this process.
        group: Where the limits of this process stand.
    """
    environment.setdefault("OMP_WAIT_POLICY", "passive")
    allowed, seen = _allowed(group), os.cpu_count() or 1
    if allowed is not None and allowed < seen:
        environment.setdefault("OMP_NUM_THREADS", str(allowed))


@contextmanager
def no_spinning() -> Iterator[None]:
    """One thread for as long as this lasts, where PyTorch was loaded before and its threads spin while they wait."""
    torch = sys.modules.get("torch")
    if torch is None or not spins:
        yield
        return
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


def _allowed(group: Path) -> int | None:
    """Whole cores that the group's quota allows, at least 1; None where there is no quota."""
    try:
        quota, period = (group / "cpu.max").read_text().split()
    except (OSError, ValueError):
        try:
            quota, period = ((group / "cpu" / f"cpu.cfs_{part}_us").read_text().strip() for part in ("quota", "period"))
        except OSError:
            return None
    try:
        cores = int(quota) / int(period)
    except (ValueError, ZeroDivisionError):
        return None  # `max`
    return max(1, ceil(cores)) if cores > 0 else None  # -1: none
