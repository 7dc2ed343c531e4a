"""The hum of the mains in a sensor."""

from math import pi
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, Rig
from gear_damping.physics.mains import MAINS, STRAYS
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import Recording, Sensor, Values

FEWEST_CYCLES = 4  # in a record: fewer are an arc, or a swing that dies away
BEGUN = 0.1  # of the deflection, or of the amplitude of an oscillator, which a linear step finds the size from


def _of_either_grid(rig: Rig) -> tuple[Recipe, ...]:
    """One variant for each frequency that grids have, where the records show it."""
    size = BEGUN * (rig.values.get("amplitude") or rig.values["mean_load"] / rig.values["mean_stiffness"])
    return tuple(
        Recipe(
            {"amplitude": abs(size)},
            {"amplitude": "phase"},
            scanned={"frequency": mains},
            within={"mains_hum.frequency": (mains - STRAYS, mains + STRAYS)},
            in_si=True,
        )
        for mains in MAINS
        if mains + STRAYS < rig.band and mains * rig.longest >= FEWEST_CYCLES
    )


class MainsHum(Sensor):
    """What a cable picks up of the grid: a sine that knows nothing of the motion, of another phase in every record."""

    name = "mains_hum"
    equation = "y + A sin(2 pi f t + phi)"
    reference = "Morrison (2016), Grounding and Shielding, ch. 4"
    parameters: ClassVar = (
        Parameter("amplitude", "m", 1e-6, "A", 0, 1e9),
        Parameter("frequency", "Hz", 50.0, "f", 0, 1e6),
        Parameter("phase", "rad", 0.0, "phi, at the beginning of a record"),
    )
    position = 35  # in the chain, on the cable behind the sensor and before the filter
    cause: ClassVar = Cause(
        "the hum of the mains in the sensor",
        _of_either_grid,
        separated_by="ring_down",
        turns_with="clock",
    )

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The record with the hum in it."""
        wave = torch.sin(
            2 * pi * values["frequency"].unsqueeze(1) * recording.times(signal) + values["phase"].unsqueeze(1)
        )
        return signal + values["amplitude"].unsqueeze(1) * wave
