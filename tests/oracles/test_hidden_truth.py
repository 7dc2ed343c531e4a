"""The generator of hidden effects against closed forms: motion, forces, geometry, instruments, sizes."""

import math
from pathlib import Path

import numpy as np
import pytest
from hidden import EFFECTS, FOREIGN, draw_case, pair
from hidden.catalogue import HIDDEN
from hidden.contact import dry_friction, power
from hidden.excitation import Turning, crack_window, error, load, measured_torques, pitch_steps, turning
from hidden.integrate import integrate
from hidden.invariants import hysteretic_loss, memoryless_loss
from hidden.knobs import NEUTRAL, stack
from hidden.sensor import transmission_error
from hidden.stiffness import mean_stiffness, mesh_stiffness
from hidden.tooth_friction import lever_arm

RATE = 50e3
EVEN = {"one_pair": 3e8, "two_pairs": 3e8}  # a mesh without parametric excitation


def at(angle):
    """Shafts at a pinion angle / rad."""
    return Turning(angle, angle / 2.0, 20.0 * angle, np.ones_like(angle))


def run(*members, n=400, **options):
    return integrate(stack(members), n, RATE, **options)


def test_the_mass_is_that_of_both_inertias_seen_along_the_line_of_action():
    assert pytest.approx(0.2657, abs=1e-4) == pair.MASS
    assert pair.pitch_point() == pytest.approx(0.857, abs=1e-3)


def test_free_oscillation_is_the_damped_harmonic_of_the_textbook():
    zeta, k = 0.03, 3e8
    wn = math.sqrt(k / pair.MASS)
    path = run(EVEN | {"viscous": 2 * zeta * math.sqrt(k * pair.MASS)}, moved=0.2)
    static = 150.0 / pair.RADIUS[0] / k
    wd = wn * math.sqrt(1 - zeta**2)
    t = path.time
    expected = static + 0.2 * static * np.exp(-zeta * wn * t) * (np.cos(wd * t) + zeta * wn / wd * np.sin(wd * t))
    assert np.max(np.abs(path.x[:, 0] - expected)) < 1e-5 * static


def test_the_integrator_is_of_sixth_order():
    knobs = EVEN | {"cubic": 6e17, "torque": 150.0}
    fine = run(knobs, moved=0.3, substeps=16, n=100).x
    coarse, half = (np.max(np.abs(run(knobs, moved=0.3, substeps=s, n=100).x - fine)) for s in (1, 2))
    assert 2**5 < coarse / half < 2**7.5


def test_a_ball_on_the_drive_flank_flies_a_parabola_and_comes_back():
    """Teeth apart move under the load alone, and the flank is met where the parabola says."""
    force = 150.0 / pair.RADIUS[0]
    acceleration = force / pair.MASS
    path = run(EVEN | {"gap": 1e-3}, moved=-3.0, n=30)  # two static deflections beyond the flank, at rest
    start = -2.0 * force / 3e8
    until = math.sqrt(2.0 * -start / acceleration)
    flying = path.time < until
    assert 1 < flying.sum() < 30
    expected = start + 0.5 * acceleration * path.time[flying] ** 2
    assert np.allclose(path.x[flying, 0], expected, rtol=0, atol=1e-6 * abs(start))
    energy = 0.5 * pair.MASS * path.v[:, 0] ** 2 + 0.5 * 3e8 * np.maximum(path.x[:, 0], 0) ** 2 - force * path.x[:, 0]
    assert np.ptp(energy) < 1e-6 * np.max(np.abs(energy))


def test_energies_of_a_cycle_are_those_of_the_closed_forms():
    a, w = 2e-6, 3.4e4
    dry = stack([{"dry": 100.0, "dry_width": 1e-7}])
    assert memoryless_loss(dry, 1e-5, a, w) == pytest.approx(4 * 100.0 * a, rel=1e-3)
    square = stack([{"power": 500.0, "power_n": 2.0, "power_rounding": 1e-9}])
    assert memoryless_loss(square, 1e-5, a, w) == pytest.approx(8 / 3 * 500.0 * w**2 * a**3, rel=1e-5)
    assert dry_friction(dry, 0.0, np.array([1.0]))[0] == pytest.approx(100.0)
    assert power(square, 0.0, np.array([-0.5]))[0] == pytest.approx(-125.0)


def test_the_hysteretic_loss_is_that_of_the_elements_integrated():
    a, knobs = 2e-6, stack([{"hysteresis": 1e7, "yield": 1.5e-6}])
    angle = np.linspace(0, 16 * np.pi, 40_001)
    total = 0.0
    for ratio in (0.5, 1.0, 1.6):
        z, loss = 0.0, 0.0
        travel = a * np.cos(angle)
        for i in range(40_000):
            step = travel[i + 1] - travel[i]
            slope = 1.0 - np.sign(step) * z / (1.5e-6 * ratio)
            new = z + slope * step
            loss += 0.5 * (z + new) * step if i >= 35_000 else 0.0
            z = new
        total += 1e7 * loss / 3.0
    assert hysteretic_loss(knobs, a) == pytest.approx(total, rel=2e-3)


def test_the_mean_stiffness_is_that_of_the_share_of_two_pairs():
    knobs = stack([{"contact_ratio": 1.6, "edge": 0.1}, {"contact_ratio": 1.5, "edge": 0.02}])
    assert mean_stiffness(knobs) == pytest.approx([2e8 + 2e8 * 0.6, 2e8 + 2e8 * 0.5], rel=1e-3)
    middle = mesh_stiffness(knobs, np.array([[2 * np.pi * 0.3], [2 * np.pi * 0.8]]))
    assert middle[:, 0] == pytest.approx([4e8, 2e8])


def test_crown_and_lean_keep_the_mean_of_a_pair():
    plain, shaped = (float(mean_stiffness(stack([{"edge": 0.02} | more]))[0]) for more in ({}, {"lean": 0.1}))
    assert shaped == pytest.approx(plain, rel=2e-3)


def test_error_rates_are_the_derivatives_of_the_errors():
    t = np.linspace(0.0, 0.01, 200_001)[:, None]
    pitch = np.random.default_rng(3).normal(size=20) * 1e-6
    knobs = stack([{"pinion_runout": 2e-5, "gear_runout": 1e-5, "profile": np.full(6, 1e-6), "pitch": pitch}])
    e, rate = error(knobs, turning(knobs, t))
    assert np.allclose(np.gradient(e[:, 0], t[:, 0])[5:-5], rate[5:-5, 0], atol=2e-3 * np.abs(rate).max())


def test_pitch_steps_hold_every_tooths_value():
    pitch = np.arange(20.0)
    middle = (np.arange(20)[:, None]) * 2 * np.pi / 20 + 1e-9
    value, slope = pitch_steps(stack([{"pitch": pitch, "handover": 0.4}]), at(middle))
    assert value[:, 0] == pytest.approx(pitch)
    assert np.all(slope == 0.0)


def test_a_crack_is_open_for_one_contact_and_its_area_is_half_of_it():
    angle = np.linspace(0, 2 * np.pi, 100_000, endpoint=False)[:, None]
    window = crack_window(stack([{"contact_ratio": 1.6}]), at(angle))
    assert float(window.mean()) == pytest.approx(0.5 * 1.6 / 20, rel=1e-4)


def test_a_balanced_load_is_torque_over_radius_and_a_held_one_moves_less():
    t = np.zeros((1, 1))
    knobs = stack([{"slow": 10.0, "slow_phase": np.pi / 2}, {"slow": 10.0, "slow_phase": np.pi / 2, "held": 1.0}, {}])
    force = load(knobs, t, turning(knobs, t))[0][0]
    assert force[2] == pytest.approx(150.0 / pair.RADIUS[0])
    assert (force[0] - force[2]) / 10.0 == pytest.approx(35.47, abs=0.01)
    assert (force[1] - force[2]) / 10.0 == pytest.approx(28.8, abs=0.05)


def test_no_torque_channel_shows_a_ripple():
    t = np.linspace(0, 0.02, 50)[:, None]
    plain, rippled = (stack([k]) for k in ({}, {"ripple": 20.0}))
    assert np.array_equal(measured_torques(plain, t)[0], measured_torques(rippled, t)[0])
    assert not np.allclose(load(plain, t, turning(plain, t))[0], load(rippled, t, turning(rippled, t))[0])


def test_the_lever_of_friction_at_the_pitch_point_is_the_tangent():
    assert lever_arm(0.0, NEUTRAL) == pytest.approx(math.tan(pair.PRESSURE_ANGLE))


def test_a_bearing_in_series_deflects_by_the_load_over_its_stiffness():
    soft = {"bearing": 1.0, "bearing_stiffness": 5e8, "bearing_mass": 2.0, "bearing_damping": 2e4}
    path = run(EVEN | {"viscous": 2e3}, EVEN | {"viscous": 2e3} | soft, n=2000)
    assert np.mean(path.x[-200:, 1] - path.x[-200:, 0]) == pytest.approx(150.0 / pair.RADIUS[0] / 5e8, rel=1e-3)


def test_instruments_delay_scale_and_round():
    members = [EVEN, EVEN | {"delay": 1e-4}, EVEN | {"gain": 1.1, "offset": 1e-6}, EVEN | {"step": 1e-7}]
    knobs = stack(members)
    path = integrate(knobs, 200, RATE, settle=50, moved=0.2)
    seen = transmission_error(knobs, path)
    assert np.allclose(seen[5:, 1], seen[:-5, 0], atol=1e-12)
    assert np.allclose(seen[:, 2], 1.1 * seen[:, 0] + 1e-6)
    assert np.allclose(seen[:, 3] / 1e-7, np.round(seen[:, 3] / 1e-7))


def test_every_effect_changes_the_motion_or_the_channel():
    """A knob that does nothing would make a case without a truth."""
    rng = np.random.default_rng(5)
    base = NEUTRAL | {"viscous": 600.0, "torque": 40.0, "speed": pair.rpm(4000.0)}
    catalogue = HIDDEN | FOREIGN
    members = [base]
    for name, effect in catalogue.items():
        knobs = base | dict(effect.given)
        turn = effect.as_modelled or effect.turn
        bearing = catalogue["bearing_flexibility"].turn(catalogue["bearing_flexibility"].draw(rng, 0.01), knobs)
        knobs |= bearing if name == "unbalance" else {}
        members.append(knobs | turn(effect.draw(rng, 0.01), knobs))
    knobs = stack(members)
    held = np.random.default_rng(6).normal(size=(500, len(members)))
    seen = transmission_error(knobs, integrate(knobs, 500, RATE, 2, held=held, moved=0.3))
    change = np.nan_to_num(np.abs(seen[:, 1:] - seen[:, :1]).max(axis=0), nan=1.0)
    silent = [name for name, moved in zip(catalogue, change, strict=True) if moved < 1e-9]
    assert silent == [] or silent == ["backlash"]  # teeth need not part


def test_the_same_seed_is_the_same_case_and_another_is_not():
    first, again, other = (draw_case("gear_eccentricity", seed, duration=0.004) for seed in (4, 4, 5))
    assert first.truth == again.truth
    one, same = (case.records[0].channels["transmission_error"] for case in (first, again))
    assert np.array_equal(one, same)
    assert first.truth["effects"] != other.truth["effects"]


@pytest.mark.parametrize("name", ["cubic_stiffness", "pinion_eccentricity"])
def test_effects_are_sized_for_the_excess_asked_for(name):
    case = draw_case(name, 2, duration=0.02, snr_db=30.0, target_excess=2.0)
    assert case.truth["excess_percent"] == pytest.approx(2.0, rel=0.35)
    assert len(case.records) == 8
    assert name in EFFECTS


def test_the_generator_knows_nothing_of_the_package():
    folder = Path(pair.__file__).parent
    assert not [path.name for path in folder.glob("*.py") if "gear_damping" in path.read_text(encoding="utf-8")]
