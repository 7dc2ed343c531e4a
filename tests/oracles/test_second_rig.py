"""The second rig against closed forms and another integrator; its files are read by the package, nothing else is."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from second_rig import CASES, SETS, write_case
from second_rig.case import CONSTANT, EFFECT, NULL, OUTSIDE
from second_rig.motion import Hidden, Run, Tables, damping_force, integrate, simulate
from second_rig.pair import mesh_stiffness, steel_rig

from gear_damping.measurement.load import load_measurement

RIG = steel_rig((23, 41), 3e-3, 0.02, (2e-3, 1.2e-2), 0.02)


def free_decay(start: float, steps: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """t / s, x / m and x' at a constant stiffness, without load."""
    even, step = np.ones(2 * steps + 1), 1.0 / 70 / RIG.natural_frequency
    tables = Tables(RIG.mean_stiffness * even, 0.0 * even, 0.0 * even, 0.0 * even)
    x, v, _ = integrate(tables, step, (start, 0.0), RIG.mass, damping_force(RIG, None))
    return np.arange(steps + 1) * step, x, v


def test_free_motion_decays_as_the_closed_form_does():
    start, ratio = 1e-5, RIG.damping_ratio
    t, x, _ = free_decay(start, 4000)
    w = 2 * math.pi * RIG.natural_frequency
    root = math.sqrt(1 - ratio**2)
    swing = np.cos(w * root * t) + ratio / root * np.sin(w * root * t)
    assert x == pytest.approx(start * np.exp(-ratio * w * t) * swing, abs=1e-4 * start)


def test_free_motion_loses_what_the_damping_takes():
    t, x, v = free_decay(1e-5, 2000)
    energy = 0.5 * RIG.mean_stiffness * x**2 + 0.5 * RIG.mass * v**2
    power = RIG.viscous * v**2
    taken = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(t))])
    assert energy + taken == pytest.approx(energy[0], rel=1e-4)


@pytest.mark.parametrize("law", ["trapezoid", "fourier"])
def test_the_steady_state_is_that_of_harmonic_balance(law):
    rig, torque = replace(RIG, law=law), 100.0
    run = Run(40e3, 0.02, 2700.0, torque, settling=0.1, mesh_zero=0.17, pinion_angle=0.3)
    motion = simulate(rig, run)
    harmonics, points = np.arange(-60, 61), 4096
    lines = np.fft.fft(mesh_stiffness(rig, np.arange(points) / points)) / points
    w = harmonics * rig.teeth[0] * run.speed * math.pi / 30
    balance = lines[(harmonics[:, None] - harmonics) % points] + np.diag(1j * w * rig.viscous - rig.mass * w**2)
    load = np.where(harmonics == 0, torque / rig.radii[0], 0.0)
    phase = motion.pinion_angle * rig.teeth[0] / (2 * math.pi) - run.mesh_zero
    expected = (np.linalg.solve(balance, load) * np.exp(2j * math.pi * phase[:, None] * harmonics)).sum(axis=1).real
    assert motion.x == pytest.approx(expected, abs=2e-3 * np.std(expected))


def by_events(run: Run, gap: float) -> np.ndarray:
    """x / m at the samples of a run: an integrator of order 8 that stops at each flank."""
    times = np.arange(run.samples) / run.rate
    force, phase = run.torque / RIG.radii[0], run.speed / 60 * RIG.teeth[0]
    found, t, state, flank = np.zeros(times.size), 0.0, list(run.begin), 0

    def slopes(t, y, flank):
        bent = y[0] + (gap if flank < 0 else 0.0)
        mesh = mesh_stiffness(RIG, np.array([t * phase]))[0] * bent + RIG.viscous * y[1]
        return [y[1], (force - (mesh if flank else 0.0)) / RIG.mass]

    def drive(t, y, flank):
        return y[0]

    def coast(t, y, flank):
        return y[0] + gap

    drive.terminal = coast.terminal = True
    while t < times[-1]:
        drive.direction, coast.direction = (-1.0, 0.0) if flank > 0 else (1.0, 1.0 if flank < 0 else -1.0)
        events = {1: [drive], -1: [coast], 0: [drive, coast]}[flank]
        part = solve_ivp(slopes, (t, times[-1]), state, "DOP853", rtol=1e-9, atol=1e-14, max_step=2e-5,
                         events=events, dense_output=True, args=(flank,))  # fmt: skip
        here = (times >= t) & (times <= part.t[-1])
        found[here] = part.sol(times[here])[0]
        t, state = part.t[-1], part.y[:, -1]
        if part.status == 1:
            flank = 0 if flank else (1 if len(part.t_events[0]) else -1)
    return found


def test_flanks_with_a_gap_move_as_an_integrator_with_events_says():
    gap, run = 6e-5, Run(40e3, 4e-3, 2700.0, 200.0 * RIG.radii[0], at_rest=True, begin=(-3e-5, 0.0), mesh_zero=0.0)
    x = simulate(RIG, run, Hidden("backlash", {"gap": gap})).x
    expected = by_events(run, gap)
    parted = np.diff(np.sign(expected))
    assert np.count_nonzero(parted) >= 3  # it meets, parts and meets again
    assert x == pytest.approx(expected, abs=5e-3 * np.std(expected))


def test_there_are_two_sets_with_nulls_effects_constants_and_one_that_nobody_knows():
    assert {name: len(cases) for name, cases in SETS.items()} == {"first": 16, "second": 14}
    found = [case.to_find for case in CASES.values()]
    assert {kind: found.count(kind) for kind in (NULL, EFFECT, CONSTANT, OUTSIDE)} == {
        NULL: 7,
        EFFECT: 19,
        CONSTANT: 3,
        OUTSIDE: 1,
    }


@pytest.mark.parametrize(("name", "channel"), [("c11", "acceleration"), ("d13", "gear_speed"), ("c15", "encoders")])
def test_the_package_reads_what_is_written(name, channel, tmp_path):
    truth = write_case(name, tmp_path / "m")
    measurement = load_measurement(tmp_path / "m" / "measurement.yaml")
    assert truth["sensor"] == channel
    assert len(measurement.records) == len(CASES[name].runs)


def test_a_case_is_the_same_whenever_it_is_drawn(tmp_path):
    """ENDS: first and last number of the last record, as they were when all cases were drawn one after the other."""
    for folder in ("one", "two"):
        write_case("d07", tmp_path / folder)
    one, two = (np.load(tmp_path / folder / "run4.npz")["te"] for folder in ("one", "two"))
    assert np.array_equal(one, two)
    assert [one[0], one[-1]] == pytest.approx(ENDS, rel=1e-6)


ENDS = [-0.022706418123927995, 20.64191396569301]
