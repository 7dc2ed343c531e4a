"""A second mode of the structure."""

from collections.abc import Mapping
from dataclasses import replace
from math import hypot, inf, pi
from typing import ClassVar

import numpy as np
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
COUPLED = 0.9  # of the largest ratio of masses with the same modes: nearly in tune, and their dampings still told apart
LIGHTEST = 1e-9  # ratio of the masses that the parameter may have at least
TURNS = 20  # of what damping adds, each of which leaves some of its square of what the one before left
SLOWEST, FASTEST = 1e-3, 10.0  # drag over the frequency of a load alone: a thousandth of its swing, and no swing at all
DAMPED = (1e-5, 0.3)  # damping ratios of what shows as a line


def _at_the_lines(rig: Rig) -> tuple[Recipe, ...]:
    """One variant for every frequency that stands out of what is left, and each of several masses.

    Where a free motion grows again its own frequency stands for two that beat.
    """
    natural = rig.values["natural_frequency"] / (2 * pi)
    sought = [(frequency, ratio) for frequency in rig.frequencies for ratio in RATIOS]
    sought += [(natural, ratio) for ratio in BEATS if rig.swells]
    found = tuple(_begun(Mode(at, ratio, 0.01), HIGH, _alone(at, natural)) for at, ratio in sought)
    found = found if rig.mode is None else (*found, _behind_a_drive(rig.mode))
    return tuple(replace(one, settled=("mass_ratio",)) for one in found) if rig.swings_freely else found


def _behind_a_drive(mode: Mode) -> Recipe:
    """A load on a spring behind a drive, which the ground brakes where the records ask for it."""
    about = mode.frequency / ABOUT, mode.frequency * ABOUT
    bare, rate = _begun(mode, HEAVY, about), 2 * pi * mode.frequency
    if mode.drag_rate == 0:
        return bare
    return replace(
        bare,
        scanned={**bare.scanned, "drag_rate": mode.drag_rate},
        within={**bare.within, "second_mode.drag_rate": (SLOWEST * rate, FASTEST * rate)},
        sharpest=("drag_rate",),
    )


def _alone(line: float, natural: float) -> tuple[float, float]:
    """Range of where the second mass swings alone, in Hz, if a line is one of the two modes and `natural` the other.

    It lies the farther from the line the heavier that mass is, up to where the heaviest of these modes is in tune: with
    k the square of the first mass' own, k w^2 is the product of the squares of both and k + (1 + mu) w^2 is their sum.
    """
    total, product = line**2 + natural**2, (line * natural) ** 2
    heaviest = min(HIGH, total**2 / (4 * product) - 1) if product > 0 else HIGH
    parted = max(total**2 - 4 * (1 + heaviest) * product, 0.0) ** 0.5
    alone = ((total + (parted if line > natural else -parted)) / (2 * (1 + heaviest))) ** 0.5
    return min(line / NEAR, alone), max(line * NEAR, alone)


def _begun(mode: Mode, most: float, within: tuple[float, float]) -> Recipe:
    """One variant that fits begin from, with the largest ratio of the masses and the range of its frequency.

    Two modes of a free swing have two frequencies and two dampings, which is one number less than two masses have: what
    the second mass does at first says the same as how heavy it is.
    """
    return Recipe(
        {"mass_ratio": min(max(mode.mass_ratio, 2 * LOW), most / 2)},
        non_nested=True,
        scanned={"frequency": mode.frequency, "damping_ratio": mode.damping_ratio},
        within={
            "second_mode.mass_ratio": (LOW, most),
            "second_mode.frequency": within,
            "second_mode.damping_ratio": DAMPED,
        },
        in_si=True,
    )


def _poles(values: Mapping[str, float], stiffness: float, damping: float) -> list[complex]:
    """One pole of each of the two modes, in 1/s, the slower one first; what is overdamped has none that swings.

    Both masses at rest at first: (s^2 + c s + k + mu (w^2 + 2 zeta w s)) (s^2 + (2 zeta w + d) s + w^2) =
    mu (w^2 + 2 zeta w s)^2.
    """
    rate = 2 * pi * values["frequency"]
    link = np.array([2 * values["damping_ratio"] * rate, rate**2])
    first = np.polyadd([1.0, damping, stiffness], values["mass_ratio"] * link)
    second = np.array([1.0, link[0] + values["drag_rate"], link[1]])
    poles = np.roots(np.polysub(np.polymul(first, second), values["mass_ratio"] * np.polymul(link, link)))
    return sorted(poles[poles.imag > 0], key=abs)


def _as_coupled(values: Mapping[str, float], stiffness: float, damping: float) -> tuple[dict[str, float], float, float]:
    """A second mass with the same two modes, of `COUPLED` of the largest mass that has them.

    The largest one is that of two equal frequencies; there the damping of neither mass is told from the other's.
    Coefficients of the polynomial of the poles give all but the mass, by turns for what damping adds to its middle.
    """
    poles = _poles(values, stiffness, damping)
    if len(poles) < 2 or values["drag_rate"] > 0:
        return dict(values), stiffness, damping
    _, cubic, square, linear, product = np.poly([*poles, *np.conj(poles)]).real
    ratio = COUPLED * (square**2 / (4 * product) - 1)
    if ratio < LIGHTEST:  # two modes that are one
        return dict(values), stiffness, damping
    is_slower = stiffness < (1 + values["mass_ratio"]) * (2 * pi * values["frequency"]) ** 2
    link = first = 0.0
    for _ in range(TURNS):
        middle = square - link * first
        spread = np.sqrt(max(middle**2 - 4 * (1 + ratio) * product, 0.0))
        rate = np.sqrt((middle + (spread if is_slower else -spread)) / (2 * (1 + ratio)))
        held = product / rate**2
        first, link = np.linalg.solve([[1.0, 1 + ratio], [rate**2, held]], [cubic, linear])
    if min(first, link) < 0:  # so the modes share their damping with other masses only
        return dict(values), stiffness, damping
    own = {"mass_ratio": ratio, "frequency": rate / (2 * pi), "damping_ratio": max(link / (2 * rate), DAMPED[0])}
    return {key: float(value) for key, value in own.items()}, float(held), float(first)


class SecondMode(ExtraStates, Load):
    """Another mass on a spring, on the one that is measured: what a second mode of a structure looks like there.

    The two together have two modes; any two that a sensor sees at the driven place can be written so.
    """

    name = "second_mode"
    equation = "x'' ... + mu (w^2 (x - z) + 2 zeta w (x' - z')), z'' = w^2 (x - z) + 2 zeta w (x' - z') - d z' - a_b"
    reference = "Den Hartog (1956), Mechanical Vibrations, ch. 3"
    parameters: ClassVar = (
        Parameter("mass_ratio", "1", 0.05, "mu, of the second mass over the first", 1e-9, 1e6),
        Parameter("frequency", "Hz", 1.0, "w / 2 pi, of the second mass on its spring alone", 1e-9, 1e9),
        Parameter("damping_ratio", "1", 0.01, "zeta, of the second mass on its spring alone", 0, 10),
        Parameter("drag_rate", "1/s", 0.0, "d, what brakes the second mass against the ground, per unit of it", 0, 1e9),
    )
    needs: ClassVar = (Trait.REST,)
    states: ClassVar = {"displacement": "m", "velocity": "m/s"}
    cause: ClassVar = Cause(
        "a second mode of the structure", _at_the_lines, separated_by="amplitude", modes=_poles, settles=_as_coupled
    )

    def decay_time(self, values: Mapping[str, float]) -> float:
        """1 / (zeta w + d / 2), of the second mass alone."""
        rate = 2 * pi * values["frequency"] * values["damping_ratio"] + values["drag_rate"] / 2
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
        found |= {"damping": 2 * values["damping_ratio"] * rate, "drag": values["drag_rate"]}
        return found | {"slowest_rate": rate, "fastest_rate": fastest}

    def load_force(self, at: Kinematics, p: Values) -> Tensor:
        """What the second mass pulls at the first."""
        return p["mass_ratio"] * self._pull(at, p)

    def state_rates(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """The second mass on its spring, on a base that may move."""
        rate = -self._pull(at, p) - p["drag"] * at.extra[RATE]
        if "base_acceleration" in at.inputs:
            rate = rate - at.inputs["base_acceleration"]
        return {"displacement": at.extra[RATE], "velocity": rate}

    def _pull(self, at: Kinematics, p: Values) -> Tensor:
        apart, rate = at.extra[PLACE] - at.displacement, at.extra[RATE] - at.velocity
        return p["stiffness"] * apart + p["damping"] * rate
