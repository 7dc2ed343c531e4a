"""What is left of a displacement is told in its unit, whatever else was measured beside it."""

import numpy as np
import pytest

import gear_damping as gd

DECLARED = """
system: oscillator
records:
  - {name: ring, file: ring.csv, channels: {sampling_rate: 500 Hz,
     displacement: {column: x, unit: mm}, acceleration: {column: a, unit: m/s^2}}}
"""


def test_the_residual_is_that_of_the_first_channel(tmp_path):
    rate, noise = 2 * np.pi * 7.0, 0.004
    time = np.arange(3000) / 500.0
    pole = -0.02 * rate + 1j * rate * np.sqrt(1 - 0.02**2)
    swing, bent = (np.real(factor * np.exp(pole * time)) for factor in (5.0, 5e-3 * pole**2))
    left = np.random.default_rng(2).standard_normal((2, time.size))
    bent += 6.0 * np.sin(2 * np.pi * 90.0 * time)  # a plate under the accelerometer, which is no motion of the mass
    rows = zip(swing + noise * left[0], bent + 0.3 * left[1], strict=True)
    (tmp_path / "ring.csv").write_text("x,a\n" + "\n".join(f"{x:.7g},{a:.7g}" for x, a in rows))
    (tmp_path / "measurement.yaml").write_text(DECLARED)
    found = gd.identify(gd.load(tmp_path / "measurement.yaml")).content
    assert found["damping_ratio_percent"]["value"] == pytest.approx(2.0, rel=0.01)
    for told in (found["residual"]["fit"], found["records"]["ring"]):
        assert told["unit"] == "mm"
        assert told["rmse"] == pytest.approx(noise, rel=0.05)
