"""Memory that a process frees is kept by it: trainings and fits need the same blocks again at every step."""

import ctypes
import sys
from functools import cache

# Of glibc's mallopt: up to which size of the free memory at the end, and from which size of a block on, memory
# goes back to the kernel.
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
KEPT_BYTES = 1 << 30  # that freed memory is kept up to, instead of being given back and asked for at every step
LARGEST_OF_OLD_GLIBC = 32 << 20  # which refuses larger blocks


@cache
def keep_memory() -> None:
    """Let the process keep what it frees.

    Otherwise glibc returns them and the kernel clears new pages at every step: of a training at batch 1024 these are
    17 000 page faults a step and a third of its time, of a fit to long records a fifth. Other C libraries are left
    alone.
    """
    if sys.platform == "linux" and hasattr(library := ctypes.CDLL(None), "mallopt"):
        library.mallopt(M_TRIM_THRESHOLD, KEPT_BYTES)
        if not library.mallopt(M_MMAP_THRESHOLD, KEPT_BYTES):
            library.mallopt(M_MMAP_THRESHOLD, LARGEST_OF_OLD_GLIBC)
