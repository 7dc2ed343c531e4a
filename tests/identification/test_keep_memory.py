"""Memory that a training step frees serves the next one."""

import ctypes
import subprocess
import sys

import pytest

# In a process of its own: the setting cannot be taken back.
PROGRAM = """
import resource, sys, torch
from gear_damping.identification.lightning_support import keep_memory
if sys.argv[1] == "keep":
    keep_memory()
def step():
    return [torch.ones(6 << 20).sum(), torch.cat([torch.ones(6 << 20), torch.ones(1 << 20)]).sum()]
step(); step()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(4):
    step()
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


def page_faults(what):
    done = subprocess.run([sys.executable, "-c", PROGRAM, what], capture_output=True, text=True, check=True)
    return int(done.stdout)


@pytest.mark.skipif(
    sys.platform != "linux" or not hasattr(ctypes.CDLL(None), "mallopt"), reason="only glibc can be told"
)
def test_repeated_steps_touch_no_new_pages():
    assert page_faults("keep") < 0.02 * page_faults("leave")
