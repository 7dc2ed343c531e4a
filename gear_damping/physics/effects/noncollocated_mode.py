"""A second mode of a structure whose sensor sits elsewhere than the force acts."""

from collections.abc import Mapping
from math import inf, pi
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import ExtraStates, LoadPath, TransmissionErrorSource, Values

PLACE, RATE = "noncollocated_mode.displacement", "noncollocated_mode.velocity"
BEGUN = 0.1  # of the first mode's residue, which a linear step finds the size from
DAMPINGS = (0.003, 0.03)  # ratios that are tried: a resonance ten times wider looks like another one
NEAR = 1.3  # of the line that it is sought at: farther, it would take the place of the first mode
LARGEST = 1e3  # of the first mode's residue: beyond, that one is not seen
DAMPED = (1e-5, 0.5)  # damping ratios of what shows as a line


def _at_the_lines(rig: Rig) -> tuple[Recipe, ...]:
    """One variant for every frequency that stands out of what is left, where a load tells which way a mode moves.

    Where no spring holds the first mass, for the one with which loads and motions agree best.
    """
    if rig.swings_freely:
        return ()
    found = [_begun(frequency, BEGUN, ratio) for frequency in rig.frequencies for ratio in DAMPINGS]
    opposed = rig.opposed
    return (*found, *([_begun(opposed.frequency, opposed.mass_ratio, opposed.damping_ratio)] if opposed else []))


def _begun(frequency: float, residue_ratio: float, damping_ratio: float) -> Recipe:
    return Recipe(
        {"residue_ratio": residue_ratio},
        scanned={"frequency": frequency, "damping_ratio": damping_ratio},
        within={
            "noncollocated_mode.residue_ratio": (0.0, LARGEST),
            "noncollocated_mode.frequency": (frequency / NEAR, frequency * NEAR),
            "noncollocated_mode.damping_ratio": DAMPED,
        },
        in_si=True,
    )


def _poles(values: Mapping[str, float], stiffness: float, damping: float) -> list[complex]:
    """One pole of each of the two modes that swings, in 1/s, the slower one first: neither knows of the other."""
    rate = 2 * pi * values["frequency"]
    found = []
    for linear, square in ((damping, stiffness), (2 * values["damping_ratio"] * rate, rate**2)):
        under = linear**2 / 4 - square
        found += [complex(-linear / 2, (-under) ** 0.5)] if under < 0 else []
    return sorted(found, key=abs)


class NoncollocatedMode(ExtraStates, TransmissionErrorSource, LoadPath):
    """A second mode that moves the sensor the other way than the first: no mass on a spring at the driven place does.

    The response is the sum of two modes under the same load, as modal analysis has it; forces of other effects act in
    the first one.
    """

    name = "noncollocated_mode"
    equation = "x = delta - rho q, q'' + 2 zeta w q' + w^2 q = F / m, and delta moves as x does without it"
    reference = "Ewins (2000), Modal Testing, ch. 2"
    parameters: ClassVar = (
        Parameter("residue_ratio", "1", 0.1, "rho, its residue over the first mode's, of the other sign", 0, 1e6),
        Parameter("frequency", "Hz", 1.0, "w / 2 pi, of the second mode", 1e-9, 1e9),
        Parameter("damping_ratio", "1", 0.01, "zeta, of the second mode", 0, 10),
    )
    needs: ClassVar = (Trait.REST,)
    states: ClassVar = {"displacement": "m", "velocity": "m/s"}
    cause: ClassVar = Cause(
        "a second mode that moves the sensor in the opposite way to the first, as where that sits elsewhere than the "
        "force acts",
        _at_the_lines,
        separated_by="amplitude",
        modes=_poles,
    )

    def decay_time(self, values: Mapping[str, float]) -> float:
        """1 / (zeta w)."""
        rate = 2 * pi * values["frequency"] * values["damping_ratio"]
        return 1 / rate if rate > 0 else inf

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """Coefficients of the second mode, and a bound on its rate."""
        rate = 2 * pi * values["frequency"]
        found = {"residue_ratio": values["residue_ratio"], "stiffness": rate.square()}
        found |= {"damping": 2 * values["damping_ratio"] * rate, "mass": base["equivalent_mass"]}
        fastest = torch.maximum(rate, torch.sqrt(base["mean_stiffness"] / base["equivalent_mass"]))
        return found | {"slowest_rate": rate, "fastest_rate": fastest}

    def error(self, at: Kinematics, p: Values) -> tuple[Tensor, Tensor]:
        """What the sensor sees of it, which neither spring nor damper of the first mode feels."""
        return -p["residue_ratio"] * at.extra[PLACE], -p["residue_ratio"] * at.extra[RATE]

    def transmitted_load(self, at: Kinematics, p: Values) -> Tensor:
        """The load with what carries the sensor along with it."""
        return at.drive_load - p["residue_ratio"] * p["mass"] * self._rate(at, p)

    def state_rates(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """The second mode under the load."""
        return {"displacement": at.extra[RATE], "velocity": self._rate(at, p)}

    def _rate(self, at: Kinematics, p: Values) -> Tensor:
        return at.drive_load / p["mass"] - p["stiffness"] * at.extra[PLACE] - p["damping"] * at.extra[RATE]
