"""The multiplier of a run against the oracle's, and against the closed form without a modulation."""

import floquet
import numpy as np
import pytest
from cases import bench, rpm

from gear_damping.simulation.floquet import floquet_multiplier
from gear_damping.simulation.simulate import simulate


@pytest.mark.parametrize("speed", [4600.0, 4680.0, 3000.0])
def test_multiplier_agrees_with_the_oracle(assemble, speed):
    case = bench(pinion_speed=rpm(speed), power_alpha=0.0, viscous=64.5)
    model, given = assemble(case)
    runs = simulate(model, model.values(1, **given), sampling_rate=40e3, n_samples=3)
    ratio = float(runs.damping_ratio_percent[0]) / 100
    expected = np.abs(floquet.mesh_multipliers(case, ratio)).max()
    assert floquet_multiplier(runs) == pytest.approx(expected, abs=2e-6)
