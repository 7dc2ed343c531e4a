"""Memory that a training step frees serves the next one."""

import ctypes
import json
import statistics
import subprocess
import sys

import pytest

# In a process of its own: the setting cannot be taken back. Six blocks at once are more than glibc keeps of itself;
# each is small enough for the heap.
PROGRAM = """
import json, resource, torch
from gear_damping.identification.kept_memory import keep_memory
keep_memory()
def page_faults():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt
def step():
    before = page_faults()
    [torch.ones(6 << 20) for _ in range(6)]
    return page_faults() - before
print(json.dumps([step() for _ in range(25)]))
"""


@pytest.mark.skipif(
    sys.platform != "linux" or not hasattr(ctypes.CDLL(None), "mallopt"), reason="only glibc can be told"
)
def test_repeated_steps_touch_no_new_pages():
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True)
    first, *others = json.loads(done.stdout)
    # The heap may grow once more, whenever its free blocks happen to lie badly: the step in the middle counts.
    assert statistics.median(others) < 0.02 * first
