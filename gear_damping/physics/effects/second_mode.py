"""A second mode of the structure."""

from collections.abc import Mapping
from math import hypot, inf, pi
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Mode, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import ExtraStates, Load, Values

PLACE, RATE = "second_mode.displacement", "second_mode.velocity"
RATIOS = (0.01, 0.1)  # of the masses, that fits begin from: a light part and a heavy one
BEATS = (3e-4, 1e-3, 3e-3, 1e-2)  # the same at the first mode's own frequency, where they part the two by its root
HEAVY = 10.0  # of a mass behind one that no spring holds: a motor that carries a beam is the smaller one
ABOUT = 2.0  # of its frequency, which the load of short records tells to so much
LOW, HIGH = 1e-4, 1.0  # of the ratio that is fitted: beyond, the other mass is the first one
NEAR = 1.15  # of the line that it is sought at: farther, it would take the place of the first mode
DAMPED = (1e-5, 0.3)  # damping ratios of what shows as a line


def _at_the_lines(rig: Rig) -> tuple[Recipe, ...]:
    """One variant for every frequency that stands out of what is left, and each of several masses.

    Where a free motion grows again its own frequency stands for two that beat.
    """
    sought = [(frequency, ratio) for frequency in rig.frequencies for ratio in RATIOS]
    sought += [(rig.values["natural_frequency"] / (2 * pi), ratio) for ratio in BEATS if rig.swells]
    found = tuple(_begun(Mode(frequency, ratio, 0.01), HIGH, NEAR) for frequency, ratio in sought)
    return found if rig.mode is None else (*found, _begun(rig.mode, HEAVY, ABOUT))


def _begun(mode: Mode, most: float, near: float) -> Recipe:
    """One variant that fits begin from, with the largest ratio of the masses and the range of its frequency."""
    return Recipe(
        {"mass_ratio": min(max(mode.mass_ratio, 2 * LOW), most / 2)},
        non_nested=True,
        scanned={"frequency": mode.frequency, "damping_ratio": mode.damping_ratio},
        within={
            "second_mode.mass_ratio": (LOW, most),
            "second_mode.frequency": (mode.frequency / near, mode.frequency * near),
            "second_mode.damping_ratio": DAMPED,
        },
        in_si=True,
    )


class SecondMode(ExtraStates, Load):
    """Another mass on a spring, on the one that is measured: what a second mode of a structure looks like there.

    The two together have two modes; any two that a sensor sees at the driven place can be written so.
    """

    name = "second_mode"
    equation = "x'' ... + mu (w^2 (x - z) + 2 zeta w (x' - z')), z'' = w^2 (x - z) + 2 zeta w (x' - z') - a_b"
    reference = "Den Hartog (1956), Mechanical Vibrations, ch. 3"
    parameters: ClassVar = (
        Parameter("mass_ratio", "1", 0.05, "mu, of the second mass over the first", 1e-9, 1e6),
        Parameter("frequency", "Hz", 1.0, "w / 2 pi, of the second mass on its spring alone", 1e-9, 1e9),
        Parameter("damping_ratio", "1", 0.01, "zeta, of the second mass on its spring alone", 0, 10),
    )
    needs: ClassVar = (Trait.REST,)
    states: ClassVar = {"displacement": "m", "velocity": "m/s"}
    cause: ClassVar = Cause("a second mode of the structure", _at_the_lines, separated_by="amplitude")

    def decay_time(self, values: Mapping[str, float]) -> float:
        """1 / (zeta w), of the second mass alone."""
        rate = 2 * pi * values["frequency"] * values["damping_ratio"]
        return 1 / rate if rate > 0 else inf

    def exchange_time(self, values: Mapping[str, float], natural_frequency_hz: float) -> float:
        """One over the beat, where the two are coupled by more than they are apart."""
        apart = abs(values["frequency"] - natural_frequency_hz)
        coupled = natural_frequency_hz * values["mass_ratio"] ** 0.5
        return 1 / hypot(apart, coupled) if coupled > apart else inf

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """Coefficients of spring and damper, and a bound on the fastest rate of both masses."""
        rate = 2 * pi * values["frequency"]
        fastest = torch.sqrt(base["mean_stiffness"] + (1 + values["mass_ratio"]) * rate.square())
        found = {"mass_ratio": values["mass_ratio"], "stiffness": rate.square()}
        return found | {"damping": 2 * values["damping_ratio"] * rate, "slowest_rate": rate, "fastest_rate": fastest}

    def load_force(self, at: Kinematics, p: Values) -> Tensor:
        """What the second mass pulls at the first."""
        return p["mass_ratio"] * self._pull(at, p)

    def state_rates(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """The second mass on its spring, on a base that may move."""
        rate = -self._pull(at, p)
        if "base_acceleration" in at.inputs:
            rate = rate - at.inputs["base_acceleration"]
        return {"displacement": at.extra[RATE], "velocity": rate}

    def _pull(self, at: Kinematics, p: Values) -> Tensor:
        apart, rate = at.extra[PLACE] - at.displacement, at.extra[RATE] - at.velocity
        return p["stiffness"] * apart + p["damping"] * rate
