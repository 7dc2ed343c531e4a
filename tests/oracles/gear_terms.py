"""The forces of a GearCase, each frozen to one smooth piece of time: no switch happens inside a piece."""

from __future__ import annotations

import cmath
import math
from bisect import bisect_right

import numpy as np
from gear_case import GearCase


def stiffness_coefficients(case: GearCase) -> list[complex]:
    """Complex Fourier coefficients C_0..C_H of the wave: k = Re(C_0 + 2 sum C_h e^{i h angle})."""
    angle = 2.0 * math.pi * (case.contact_ratio - 1.0)
    swing = (case.k_max - case.k_min) / (2.0 * math.pi)
    coefficients: list[complex] = [case.mean_stiffness]
    for h in range(1, case.n_harmonics + 1):
        weight = 1.0
        if case.weighting == "lanczos":
            u = math.pi * h / (case.n_harmonics + 1)
            weight = math.sin(u) / u
        coefficients.append(weight * swing * (1.0 - cmath.exp(-1j * h * angle)) / (1j * h))
    return coefficients


def rectangular_stiffness(case: GearCase, mesh_angle: float) -> float:
    """The rectangular wave at one mesh angle / rad, in N/m."""
    share = math.fmod(mesh_angle, 2.0 * math.pi) / (2.0 * math.pi)
    return case.k_max if (share + (share < 0.0)) < case.contact_ratio - 1.0 else case.k_min


def break_times(case: GearCase, end: float) -> list[float]:
    """All times in (0, end) at which a term switches or has a corner / s, ascending."""
    found = [time for time, _ in case.torque_steps]
    if case.torque_ramp is not None:
        found += case.torque_ramp[:2]
    if case.measured_torque is not None:
        found += case.measured_torque[0]
    found += [(j + 1) * case.held_load_step for j in range(len(case.held_load))]
    if case.stiffness_form == "rectangular":
        found += _stiffness_edges(case, end)
    inside = sorted({t for t in found if 0.0 < t < end})
    return [t for j, t in enumerate(inside) if j == 0 or t - inside[j - 1] > 1e-15]


def _stiffness_edges(case: GearCase, end: float) -> list[float]:
    start = case.teeth_pinion * case.pinion_angle_0 + case.mesh_phase
    rate = case.teeth_pinion * case.pinion_speed
    turns = sorted((start / (2.0 * math.pi), (start + rate * end) / (2.0 * math.pi)))
    whole = range(math.floor(turns[0]) - 1, math.ceil(turns[1]) + 2)
    edges = [2.0 * math.pi * (j + part) for j in whole for part in (0.0, case.contact_ratio - 1.0)]
    return [(edge - start) / rate for edge in edges]


class Piece:
    """The smooth functions of time of a case around the instant `middle`: stiffness, load, error."""

    def __init__(self, case: GearCase, middle: float) -> None:
        self.case = case
        self._coefficients = stiffness_coefficients(case)
        self._rectangle = rectangular_stiffness(case, self._mesh_angle(middle))
        torque, slope = self._linear_torque(middle)
        self._force_per_torque = case.load_of(1.0) - case.load_of(0.0)
        self._force, self._force_slope = case.load_of(torque), self._force_per_torque * slope
        index = math.floor(middle / case.held_load_step) if case.held_load else 0
        self._extra = case.held_load[index] if 0 <= index < len(case.held_load) else 0.0
        self._errors = self._error_waves()

    def _pinion_angle(self, t: float) -> float:
        return self.case.pinion_angle_0 + self.case.pinion_speed * t

    def _gear_angle(self, t: float) -> float:
        return self._pinion_angle(t) * self.case.teeth_pinion / self.case.teeth_gear + self.case.gear_angle_0

    def _mesh_angle(self, t: float) -> float:
        return self.case.teeth_pinion * self._pinion_angle(t) + self.case.mesh_phase

    def _linear_torque(self, middle: float) -> tuple[float, float]:
        """Torque at t = 0 and its slope: everything piecewise linear, extended from this piece."""
        case, level, slope = self.case, self.case.torque, 0.0
        if case.measured_torque is not None:
            times, values = case.measured_torque
            j = bisect_right(times, middle)
            level = values[min(j, len(values) - 1)]
            if 0 < j < len(times):
                slope = (values[j] - values[j - 1]) / (times[j] - times[j - 1])
                level -= slope * times[j]
        level += sum(change for time, change in case.torque_steps if time <= middle)
        if case.torque_ramp is not None:
            start, stop, change = case.torque_ramp
            inside = start <= middle < stop
            rate = change / (stop - start) if inside else 0.0
            level += -rate * start if inside else change * (middle >= stop)
            slope += rate
        return level, slope

    def _error_waves(self) -> list[tuple[complex, float]]:
        """Phasors (at t = 0) and angular rates of e(t) = Re(sum phasor e^{i rate t})."""
        case = self.case
        waves = [
            (*case.pinion_eccentricity, self._pinion_angle(0.0), case.pinion_speed),
            (*case.gear_eccentricity, self._gear_angle(0.0), case.pinion_speed * case.teeth_pinion / case.teeth_gear),
        ]
        for h, amplitude, phase in case.profile_error:
            rate = h * case.teeth_pinion * case.pinion_speed
            waves.append((amplitude, phase, h * self._mesh_angle(0.0), rate))
        return [(a * cmath.exp(1j * (phase + angle)), rate) for a, phase, angle, rate in waves if a != 0.0]

    def stiffness(self, t: float) -> float:
        """k(t) / (N/m), with the shaft-order modulations."""
        case, k = self.case, self._rectangle
        if case.stiffness_form == "fourier":
            turn, total = cmath.exp(1j * self._mesh_angle(t)), 0j
            for coefficient in reversed(self._coefficients[1:]):
                total = (total + coefficient) * turn
            k = self._coefficients[0] + 2.0 * total.real
        if case.pinion_stiffness_modulation[0]:
            share, phase = case.pinion_stiffness_modulation
            k *= 1.0 + share * math.cos(self._pinion_angle(t) + phase)
        if case.gear_stiffness_modulation[0]:
            share, phase = case.gear_stiffness_modulation
            k *= 1.0 + share * math.cos(self._gear_angle(t) + phase)
        return k

    def load(self, t: float) -> float:
        """F(t) / N."""
        case, force = self.case, self._force + self._force_slope * t
        if case.torque_sine is not None:
            amplitude, frequency, phase = case.torque_sine
            force += self._force_per_torque * amplitude * math.sin(2.0 * math.pi * frequency * t + phase)
        added, factor = self._extra, 1.0
        for wave in case.ripple:
            angle = self._pinion_angle(t) if wave.shaft == "pinion" else self._gear_angle(t)
            value = wave.amplitude * math.cos(wave.order * angle + wave.phase)
            added, factor = (added, factor + value) if wave.proportional else (added + value, factor)
        return force * factor + added

    def error(self, t: float) -> tuple[float, float, float]:
        """e, e', e'' / m, m/s, m/s^2."""
        if not self._errors:
            return 0.0, 0.0, 0.0
        e = rate_1 = rate_2 = 0.0
        for phasor, rate in self._errors:
            z = phasor * cmath.exp(1j * rate * t)
            e, rate_1, rate_2 = e + z.real, rate_1 - rate * z.imag, rate_2 - rate * rate * z.real
        return e, rate_1, rate_2


def sampled(case: GearCase, name: str, times: np.ndarray) -> np.ndarray:
    """A term ('stiffness', 'load' or 'error': e alone) at each time, as the run is integrated with it."""
    values = [getattr(Piece(case, t), name)(t) for t in times]
    return np.array([v[0] if name == "error" else v for v in values])
