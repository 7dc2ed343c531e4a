"""Where a second mass may swing alone, of masses whose modes an eigenvalue solver gives."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from gear_damping.physics.effects.second_mode import SecondMode


@pytest.mark.parametrize("held", [0.0, 900.0, 9000.0])
@pytest.mark.parametrize("ratio", [0.02, 0.2, 0.6])
def test_the_second_mass_alone_lies_within_what_is_fitted(held, ratio):
    """A mass of .6 of the first swings alone at 7.4 Hz where its line is at 9.9 Hz."""
    between = 1300.0
    stiffness = np.array([[held + between, -between], [-between, between]])
    scale = np.diag([1.0, ratio**-0.5])
    modes = np.sqrt(np.linalg.eigvalsh(scale @ stiffness @ scale).clip(0))
    alone = math.sqrt(between / ratio)
    line, other = sorted(modes, key=lambda mode: abs(mode - alone))
    rig = SimpleNamespace(
        frequencies=[line / (2 * math.pi)],
        values={"natural_frequency": other},
        swells=False,
        mode=None,
        swings_freely=False,
    )
    for variant in SecondMode.cause.recipes_for(rig):
        low, high = variant.within["second_mode.frequency"]
        assert low < alone / (2 * math.pi) < high
        assert low < variant.scanned["frequency"] < high
