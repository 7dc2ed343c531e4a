"""What a reference run of the gear pair is: every number in SI, every sign and phase convention stated here.

    m_e x'' + F_d(x' - e') + k(t) g(x - e) = F(t),      x = r_b1 theta_1 - r_b2 theta_2  [m]

Angles: theta_1 = pinion_angle_0 + pinion_speed t; theta_2 = theta_1 z1/z2 + gear_angle_0;
theta_M = z1 theta_1 + mesh_phase. Two tooth pairs carry on [0, 2 pi (contact_ratio - 1)) of theta_M.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

Wave = tuple[float, float]  # (amplitude, phase / rad): amplitude * cos(angle + phase)


@dataclass(frozen=True)
class Ripple:
    """Load ripple amplitude * cos(order * theta + phase) of the 'pinion' or the 'gear' shaft.

    amplitude: N, added to the load; or, if proportional, a share of the load that it multiplies.
    """

    amplitude: float
    order: float
    phase: float = 0.0
    shaft: str = "pinion"
    proportional: bool = False


@dataclass(frozen=True)
class GearCase:
    """One reference run. Defaults: the paper's Table 1, 4600 rpm, no damping, no defects, bilateral mesh."""

    teeth_pinion: int = 20
    teeth_gear: int = 40
    module: float = 3e-3  # m
    pressure_angle: float = math.radians(20.0)
    inertia_pinion: float = 2.6e-4  # kg m^2
    inertia_gear: float = 4.5e-3
    k_max: float = 4e8  # N/m, two pairs in contact
    k_min: float = 2e8  # N/m, one pair in contact
    contact_ratio: float = 1.6
    stiffness_form: str = "fourier"  # or 'rectangular'
    n_harmonics: int = 8
    weighting: str = "plain"  # or 'lanczos': sinc(h / (n_harmonics + 1))
    mesh_phase: float = 0.0  # rad
    pinion_speed: float = 4600.0 * 2.0 * math.pi / 60.0  # rad/s
    pinion_angle_0: float = 0.0  # rad
    gear_angle_0: float = 0.0  # rad
    torque: float = 150.0  # N m, on the pinion
    gear_torque: float | None = None  # None: balanced at every instant; a number: held at it
    x0: float = 0.0  # m
    v0: float = 0.0  # m/s
    viscous: float = 0.0  # N s/m
    power_alpha: float = 0.0  # N (s/m)^power_n
    power_n: float = 1.0
    coulomb_force: float = 0.0  # N
    coulomb_smoothing: float = 0.0  # m/s: force * tanh(v / smoothing); 0: sharp, with sticking
    gap: float | None = None  # m, whole clearance below the drive flank at 0; None: bilateral
    pinion_eccentricity: Wave = (0.0, 0.0)  # m, at theta_1
    gear_eccentricity: Wave = (0.0, 0.0)  # m, at theta_2
    profile_error: tuple[tuple[int, float, float], ...] = ()  # (harmonic h, m, rad): cos(h theta_M + phase)
    pinion_stiffness_modulation: Wave = (0.0, 0.0)  # k (1 + amplitude cos(theta_1 + phase))
    gear_stiffness_modulation: Wave = (0.0, 0.0)  # multiplies as well, at theta_2
    torque_steps: tuple[Wave, ...] = ()  # (time, added N m from then on)
    torque_ramp: tuple[float, float, float] | None = None  # (start, end, N m added by the end and kept)
    torque_sine: tuple[float, float, float] | None = None  # (N m, Hz, rad): amplitude sin(2 pi f t + phase)
    measured_torque: tuple[tuple[float, ...], tuple[float, ...]] | None = None  # times, N m; linear between;
    # it takes the place of `torque`; the first and last values are kept outside its range
    ripple: tuple[Ripple, ...] = ()
    held_load: tuple[float, ...] = ()  # N, sample j acts on [j, j + 1) held_load_step; 0 N beyond the last
    held_load_step: float = 0.0  # s

    @cached_property
    def base_radii(self) -> tuple[float, float]:
        """Base circle radii of pinion and gear / m."""
        half = 0.5 * self.module * math.cos(self.pressure_angle)
        return half * self.teeth_pinion, half * self.teeth_gear

    @cached_property
    def mass(self) -> float:
        """Equivalent mass on the line of action / kg: the two compliances r_b^2/I in parallel."""
        r1, r2 = self.base_radii
        return 1.0 / (r1 * r1 / self.inertia_pinion + r2 * r2 / self.inertia_gear)

    @cached_property
    def mean_stiffness(self) -> float:
        """Time mean of the mesh stiffness / (N/m)."""
        return (2.0 - self.contact_ratio) * self.k_min + (self.contact_ratio - 1.0) * self.k_max

    @cached_property
    def natural_frequency(self) -> float:
        """Natural frequency with the mean stiffness / (rad/s)."""
        return math.sqrt(self.mean_stiffness / self.mass)

    @property
    def balanced_gear_torque(self) -> float:
        """Gear torque that balances `torque` / N m."""
        r1, r2 = self.base_radii
        return self.torque * r2 / r1

    @property
    def mean_load(self) -> float:
        """Load of the nominal torques on the line of action / N."""
        return self.load_of(self.torque)

    def load_of(self, torque: float) -> float:
        """Load / N of a pinion torque / N m, the gear torque balanced or held."""
        r1, r2 = self.base_radii
        gear_torque = torque * r2 / r1 if self.gear_torque is None else self.gear_torque
        return self.mass * (r1 * torque / self.inertia_pinion + r2 * gear_torque / self.inertia_gear)

    @property
    def static_deflection(self) -> float:
        """Deflection of the mean stiffness under the nominal load / m."""
        return self.mean_load / self.mean_stiffness

    @property
    def mesh_period(self) -> float:
        """Time from one tooth to the next / s."""
        return 2.0 * math.pi / (self.teeth_pinion * abs(self.pinion_speed))
