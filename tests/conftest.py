"""What holds for every test: no hidden randomness, and no skipped check that goes unsaid."""

from collections import Counter

import numpy as np
import pytest
import torch


@pytest.fixture(autouse=True)
def _no_global_randomness(request):
    """Tests and package draw from their own generators: the global ones must stay as they were.

    Except where a test of identification builds a network itself: its weights come from torch's own.
    """
    torch.default_generator.manual_seed(0)  # torch.manual_seed keeps a stack of every call for a GPU to come
    np.random.seed(0)  # noqa: NPY002 - the very state that is guarded
    before = torch.random.get_rng_state(), np.random.get_state()[1].copy()  # noqa: NPY002
    yield
    builds_networks = "identification" in request.path.parts
    assert builds_networks or torch.equal(torch.random.get_rng_state(), before[0]), "torch's global generator was used"
    assert (np.random.get_state()[1] == before[1]).all(), "numpy's global generator was used"  # noqa: NPY002


def pytest_terminal_summary(terminalreporter):
    """Say what did not run and why."""
    skipped = terminalreporter.stats.get("skipped", [])
    reasons = Counter(str(report.longrepr[2]).removeprefix("Skipped: ") for report in skipped)
    real = sum("real_record" in report.keywords for report in skipped)
    for reason, count in reasons.items():
        terminalreporter.write_line(f"{count} tests did not run: {reason}")
    if real:
        terminalreporter.write_line(f"{real} real-record tests did not run: GEAR_DAMPING_DATA points to no records")
