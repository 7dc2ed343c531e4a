"""The regimes of a smooth piece and the ways out of them: (contact, slip) and their switches.

contact: +1 drive flank, 0 inside the gap, -1 coast flank. slip: the sign of delta' where the damping law has
a corner there; 0 while sharp Coulomb friction sticks.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from gear_case import GearCase
from gear_terms import Piece

BREAKS_LOOSE = "breaks loose"


@dataclass
class Event:
    """A switch, in the form scipy asks for: its function, the direction of crossing, the contact behind it.

    size: the magnitude of the function in an ordinary run, to judge what counts as zero.
    """

    kind: str
    function: Callable[[float, np.ndarray], float]
    direction: float
    contact: int
    size: float
    at_rest: bool = False
    terminal: bool = True

    def __call__(self, t: float, y: np.ndarray) -> float:
        """Zero at the switch."""
        return self.function(t, y)


def displacement_scale(case: GearCase) -> float:
    """Size of the motion / m: the largest of the static deflection, the start and the errors."""
    errors = [case.pinion_eccentricity[0], case.gear_eccentricity[0], *(e[1] for e in case.profile_error)]
    loads = [case.static_deflection, *(force / case.mean_stiffness for force in case.held_load)]
    starts = [case.x0, case.v0 / case.natural_frequency]
    return max(abs(value) for value in (*loads, *starts, *errors)) or 1e-6


@dataclass
class Regime:
    """The right-hand side of one regime, smooth also a little beyond its own region."""

    piece: Piece
    contact: int
    slip: int

    @staticmethod
    def contact_at_start(piece: Piece, x: float, v: float) -> int:
        case, (e, e_rate, _) = piece.case, piece.error(0.0)
        delta, rate = x - e, v - e_rate
        if case.gap is None or delta > 0.0 or (delta == 0.0 and rate >= 0.0):
            return 1
        return -1 if delta < -case.gap or (delta == -case.gap and rate <= 0.0) else 0

    @classmethod
    def enter(
        cls, piece: Piece, contact: int, t: float, y: np.ndarray, at_rest: bool = False, loose: bool = False
    ) -> Regime:
        """The regime just behind t: its slip by the sign of delta', or of delta'' when delta' is 0.

        loose: friction has just been overcome, so that it cannot hold whatever the last digit says.
        """
        regime = cls(piece, contact, 1)
        _, e_rate, e_rate_2 = piece.error(t)
        rate = float(y[1]) - e_rate
        if not at_rest and rate != 0.0:
            regime.slip = 1 if rate > 0.0 else -1
        else:
            free = regime.free_acceleration(t, float(y[0])) - e_rate_2
            hold = 0.0 if loose else regime.dry_friction / piece.case.mass
            regime.slip = int(free > hold) - int(free < -hold)
            if regime.slip == 0 and hold == 0.0:
                regime.slip = 1
        return regime

    @property
    def dry_friction(self) -> float:
        """Force / N of the sharp friction in this contact state: Coulomb, and the power law of n = 0."""
        case = self.piece.case
        sharp = case.coulomb_force if case.coulomb_smoothing == 0.0 else 0.0
        return (sharp + (case.power_alpha if case.power_n == 0.0 else 0.0)) * abs(self.contact)

    @property
    def has_corner(self) -> bool:
        """Whether the damping force has a corner or a jump at delta' = 0 (all but odd whole exponents)."""
        case = self.piece.case
        return self.contact != 0 and (
            self.dry_friction > 0.0 or (case.power_alpha != 0.0 and case.power_n % 2.0 != 1.0)
        )

    def free_acceleration(self, t: float, x: float) -> float:
        """Acceleration / (m/s^2) by load and spring alone."""
        piece, case = self.piece, self.piece.case
        if self.contact == 0:
            return piece.load(t) / case.mass
        delta = x - piece.error(t)[0] + (case.gap if self.contact < 0 else 0.0)
        return (piece.load(t) - piece.stiffness(t) * delta) / case.mass

    def damping(self, rate: float) -> float:
        """Damping force / N at delta' = rate, the sign of the corner locked to the slip of this regime."""
        case = self.piece.case
        if self.contact == 0:
            return 0.0
        force = case.viscous * rate
        if case.power_alpha:
            smooth = self.slip * rate if case.power_n == round(case.power_n) else abs(rate)
            if self.has_corner:
                force += case.power_alpha * self.slip * smooth**case.power_n
            else:
                force += case.power_alpha * rate**case.power_n
        if case.coulomb_force and case.coulomb_smoothing == 0.0:
            force += case.coulomb_force * self.slip
        elif case.coulomb_force:
            force += case.coulomb_force * math.tanh(rate / case.coulomb_smoothing)
        return force

    def derivative(self, t: float, y: np.ndarray) -> np.ndarray:
        """(x', v')."""
        x, v = y.tolist()
        _, e_rate, e_rate_2 = self.piece.error(t)
        if self.slip == 0:
            return np.array([v, e_rate_2])
        return np.array([v, self.free_acceleration(t, x) - self.damping(v - e_rate) / self.piece.case.mass])

    def events(self) -> list[Event]:
        """Every way out of this regime."""
        found, case = [], self.piece.case
        length = displacement_scale(case)
        speed = length * case.natural_frequency
        if case.gap is not None and self.contact == 1:
            found.append(Event("leaves drive flank", self._above(0.0), -1.0, 0, length))
        if self.contact == 0:
            found.append(Event("meets drive flank", self._above(0.0), 1.0, 1, length))
            found.append(Event("meets coast flank", self._above(-case.gap), -1.0, -1, length))
        if self.contact == -1:
            found.append(Event("leaves coast flank", self._above(-case.gap), 1.0, 0, length))
        if self.slip == 0:
            hold = self.dry_friction / case.mass
            found.append(Event(BREAKS_LOOSE, self._grip, -1.0, self.contact, hold, at_rest=True))
        elif self.has_corner:
            kind, direction = "reverses", -float(self.slip)
            found.append(Event(kind, self._rate, direction, self.contact, speed, at_rest=True))
        return found

    def _above(self, level: float) -> Callable[[float, np.ndarray], float]:
        return lambda t, y: float(y[0]) - self.piece.error(t)[0] - level

    def _rate(self, t: float, y: np.ndarray) -> float:
        return float(y[1]) - self.piece.error(t)[1]

    def _grip(self, t: float, y: np.ndarray) -> float:
        needed = self.free_acceleration(t, float(y[0])) - self.piece.error(t)[2]
        return self.dry_friction / self.piece.case.mass - abs(needed)
