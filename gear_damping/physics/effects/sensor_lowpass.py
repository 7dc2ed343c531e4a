"""Limited bandwidth of the sensor."""

from math import inf, pi
from typing import ClassVar

from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, Rig
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.record_filter import butterworth_modes, butterworth_response, filtered
from gear_damping.physics.terms import Recording, Sensor, Values

SIZES = (0.5, 1.5, 4.0)  # of the unit of frequency; a mode lies at 1 / (2 pi)
COASTING = (2.0, 6.0)  # of a rig without a spring, whose motion has no frequency
SLOWEST = 1.0  # of that unit: a sensor slower than the motion itself would show whatever its filter makes of it


def _switched_on(rig: Rig) -> tuple[Recipe, ...]:
    """None of a free swing: one frequency shows no filter, and its start would take what dies away.

    What drives a rig or turns its shafts makes it move at several.
    """
    if rig.swings_freely:
        return ()
    slowest = SLOWEST / (rig.values.get("characteristic_time", 0.0) or 1.0)
    within = {"sensor_lowpass.cutoff": (slowest, inf)} if rig.coasts else {}
    return tuple(
        Recipe({"cutoff": size}, non_nested=True, options={"order": order}, within=within)
        for order in (1, 2)
        for size in (COASTING if rig.coasts else SIZES)
    )


class SensorLowpass(Sensor):
    """A Butterworth low-pass in the sensor or its amplifier; taken for damping, it biases the estimate."""

    name = "sensor_lowpass"
    equation = "H(f) = prod_k 1 / (i f / f_c - p_k), p_k the Butterworth poles"
    reference = "Butterworth (1930), Exp. Wirel. Wirel. Eng. 7"
    parameters: ClassVar = (Parameter("cutoff", "Hz", 1e4, "f_c, where half the power is left", 1e-6, 1e12),)
    options: ClassVar = (Option("order", (1, 2, 4), 2, "number of poles"),)
    position = 40  # in the chain, behind what the sensor itself does
    cause: ClassVar = Cause("the low-pass of the sensor", _switched_on, separated_by="speed")

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The filtered record."""
        response, cutoff = butterworth_response(self.chosen["order"]), values["cutoff"].unsqueeze(1)
        return filtered(signal, recording.sampling_rate, lambda frequency: response(frequency / cutoff))

    @property
    def start_modes(self) -> int:
        """One state a pole."""
        return self.chosen["order"]

    def left_of_start(self, values: Values, time: Tensor) -> Tensor:
        """Decaying oscillations at the poles."""
        return butterworth_modes(self.chosen["order"], 2 * pi * values["cutoff"].unsqueeze(1) * time)
