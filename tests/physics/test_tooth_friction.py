"""Friction between the flanks against the torques that every tooth pair exerts on the two bodies."""

import math

import numpy as np
import pytest
import torch
from effect_bench import Bench
from gear_case import GearCase

MU = 0.06


def pitch_point(case: GearCase, addendum: float = 1.0) -> float:
    """Mesh periods from the first contact (tip of the gear on the line of action) to the pitch point."""
    r1, r2 = case.base_radii
    tip = case.module * (case.teeth_gear / 2 + addendum)
    first = math.sqrt(tip**2 - r2**2)  # distance along the line of action from the gear's base circle
    return (first - r2 * math.tan(case.pressure_angle)) / (2 * math.pi * r1 / case.teeth_pinion)


def exact_factor(case: GearCase, mesh_angle: float, direction: float, lead: float = 0.0) -> float:
    """-(m_e (r_b1 theta_1'' - r_b2 theta_2'')) / N of the normal and friction forces of all pairs, per unit N."""
    r1, r2 = case.base_radii
    tangent, pitch = math.tan(case.pressure_angle), pitch_point(case)
    base_pitch = 2 * math.pi * r1 / case.teeth_pinion
    start = -lead / (2 * math.pi)
    u = start + (mesh_angle / (2 * math.pi) - start) % 1.0
    pairs = [u] if u + 1 >= case.contact_ratio + start else [u, u + 1]
    torque_1 = torque_2 = 0.0
    for place in pairs:
        rho_1, rho_2 = r1 * tangent + (place - pitch) * base_pitch, r2 * tangent - (place - pitch) * base_pitch
        sliding = direction * (rho_1 - rho_2 * case.teeth_pinion / case.teeth_gear)  # of the pinion on the gear
        friction = -MU * np.sign(sliding) / len(pairs)  # on the pinion, along its own motion
        torque_1 += -r1 / len(pairs) + friction * rho_1
        torque_2 += r2 / len(pairs) - friction * rho_2
    return -case.mass * (r1 * torque_1 / case.inertia_pinion - r2 * torque_2 / case.inertia_gear)


def factors(case: GearCase, options: dict, batch: int = 301) -> tuple[np.ndarray, np.ndarray]:
    given = {
        "n_teeth_pinion": case.teeth_pinion,
        "n_teeth_gear": case.teeth_gear,
        "pressure_angle": case.pressure_angle,
        "tooth_friction.friction_coefficient": MU,
        "fourier_mesh_stiffness.contact_ratio": case.contact_ratio,
        "pinion_speed": case.pinion_speed,
        "pinion_angle": 0.013,
    }
    bench = Bench("tooth_friction", {}, given | options, batch=batch)
    time = torch.linspace(0, 3 * case.mesh_period, batch, dtype=torch.float64)
    at = bench.evaluated(time=time)
    return bench.effect.force_factor(at, bench.p).numpy(), at.mesh.angle.numpy()


CASES = {
    "default": GearCase(),
    "reversed": GearCase(pinion_speed=-300.0),
    "large pinion": GearCase(teeth_pinion=40, teeth_gear=25, contact_ratio=1.45),
    "late pitch point": GearCase(teeth_gear=200, pressure_angle=math.radians(14.5), contact_ratio=1.9),
}


@pytest.mark.parametrize("name", CASES)
def test_the_factor_follows_from_the_torques_of_all_pairs(name):
    case = CASES[name]
    found, angle = factors(case, {})
    wanted = [exact_factor(case, a, np.sign(case.pinion_speed)) for a in angle]
    np.testing.assert_allclose(found, wanted, rtol=1e-10)


def test_the_late_pitch_point_is_late():
    assert pitch_point(CASES["late pitch point"]) > 1


def test_standard_teeth_meet_857_thousandths_of_a_period_before_the_pitch_point():
    assert pitch_point(GearCase()) == pytest.approx(0.857, abs=5e-4)


def test_the_force_steps_by_twice_mu_tan_alpha_at_the_pitch_point():
    case = GearCase()
    bench = Bench("tooth_friction", {}, {"tooth_friction.friction_coefficient": MU}, batch=2)
    shares = torch.tensor([-1e-9, 1e-9], dtype=torch.float64)
    at = bench.evaluated(time=(pitch_point(case) + shares) * case.mesh_period)
    before, after = bench.effect.force_factor(at, bench.p).tolist()
    assert after - before == pytest.approx(2 * MU * math.tan(case.pressure_angle), rel=1e-6)


def test_a_region_continues_smoothly_beyond_its_edge():
    case = GearCase()
    bench = Bench("tooth_friction", {}, {}, batch=3)
    for edge in (0.0, 0.6, pitch_point(case)):
        shares = torch.tensor([-2e-3, -1e-3, 1e-3], dtype=torch.float64)
        at = bench.kinematics((edge + 1 + shares) * case.mesh_period, bench.random())
        active_branch = {k: v[:1].expand(3) for k, v in at.active_branch.items()}
        assert any((v[0] != v[2]).item() for v in at.active_branch.values())
        at.active_branch = active_branch
        found = bench.effect.force_factor(at, bench.p)
        assert (found[2] - found[1]).item() == pytest.approx(2 * (found[1] - found[0]).item(), rel=1e-6, abs=1e-12)


def test_contact_that_grows_with_load_moves_the_zones_but_not_the_pitch_point():
    case = GearCase(contact_ratio=1.65)
    given = {"tooth_friction.friction_coefficient": MU, "load_dependent_contact.growth": 0.05}
    given |= {"load_dependent_contact.reference_load": GearCase().mean_load}
    bench = Bench("tooth_friction", {}, given, others=("load_dependent_contact",), batch=200)
    time = torch.linspace(1e-6, 3.1 * case.mesh_period, 200, dtype=torch.float64)
    at = bench.evaluated(time=time)
    found = bench.effect.force_factor(at, bench.p).numpy()
    wanted = [exact_factor(case, a, 1.0, lead=0.05 * math.pi) for a in at.mesh.angle.tolist()]
    np.testing.assert_allclose(found, wanted, rtol=1e-10)
