"""A wrong tooth count, which only the orders tell, ends an identification in a message too."""

import numpy as np
import pytest

import gear_damping as gd
from gear_damping.errors import InputError


def test_a_mesh_order_that_is_absent_is_said(tmp_path):
    random, time = np.random.default_rng(3), np.arange(3000) / 20e3
    records = ""
    for name, speed in (("a", 150.0), ("b", 190.0)):
        angle = speed * time
        waves = sum(size * np.cos(order * angle) for order, size in ((25, 1.0), (50, 0.4), (75, 0.1)))
        table = np.stack([angle, 1e-6 * (waves + 0.02 * random.standard_normal(len(time)))], 1)
        np.savetxt(tmp_path / f"{name}.csv", table, "%.12g", ",", header="angle,te", comments="")
        channels = "{pinion_angle: {column: angle, unit: rad}, transmission_error: {column: te, unit: m}}"
        conditions = "{pinion_torque: {value: 90, unit: N*m}, gear_torque: balanced}"
        told = f"file: {name}.csv, sampling_rate: 20 kHz, channels: {channels}, conditions: {conditions}"
        records += f"- {{{told}}}\n"
    (tmp_path / "measurement.yaml").write_text(
        f"system: gear_pair\nparameters: {{n_teeth_pinion: 17}}\nrecords:\n{records}"
    )
    with pytest.raises(InputError, match="mesh order 17 is absent, while order 25 stands out"):
        gd.identify(gd.load(tmp_path / "measurement.yaml"))
