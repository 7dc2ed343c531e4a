"""The generator of hidden oscillators against closed forms, another integrator, and what it promises."""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from hidden import oscillator, write_case
from hidden.oscillator import OSCILLATOR_EFFECTS, draw_oscillator
from hidden.oscillator.calibrate import linear
from hidden.oscillator.inputs import KINDS, NONE, drawn
from hidden.oscillator.laws import Scales, damping, members, restoring
from hidden.oscillator.motion import STEP, between, move, reading
from scipy.integrate import solve_ivp

LENGTH = 60.0  # natural time
START = np.array([[0.8], [0.3]])


def moved(knobs, force=NONE, length=LENGTH):
    p = members([knobs])
    return move(p, [force], START, length), p


@pytest.mark.parametrize("name", [n for n in OSCILLATOR_EFFECTS if not n.startswith("sensor_")])
def test_two_integrators_agree_on_every_law(name):
    rng = np.random.default_rng(4)
    law, force = OSCILLATOR_EFFECTS[name], drawn("multisine", 1.0, 0.02, LENGTH, rng)
    knobs = {"zeta": 0.02} | law.knobs(law.at(law.draw(rng), 0.5))
    motion, p = moved(knobs, force)
    yields = knobs.get("yield", 1.0) * np.array([0.5, 1.0, 1.6])

    def rates(t, y):
        u, v, z = y[0], y[1], y[2:]
        pull = knobs.get("hysteresis", 0.0) * z.mean()
        acceleration = force(np.array([t]))[0] - restoring(p, u)[0] - damping(p, u, v)[0] - pull
        return [v, acceleration, *(v - abs(v) * z / yields)]

    t = motion.time[motion.time < 25.0]
    found = solve_ivp(rates, (0, 25.0), [0.8, 0.3, 0, 0, 0], "DOP853", t, rtol=1e-10, atol=1e-12)
    assert np.max(np.abs(found.y[0] - motion.state[0, : t.size, 0])) < 2e-4


def test_energy_is_kept_without_a_loss_and_lost_by_dry_friction_as_the_textbook_says():
    motion, _ = moved({"zeta": 0.0, "cubic": 0.5, "quadratic": 0.2})
    u, v = motion.state[:2, :, 0]
    energy = 0.5 * v**2 + 0.5 * u**2 + 0.2 * u**3 / 3 + 0.5 * u**4 / 4
    assert np.ptp(energy) < 1e-7
    motion, _ = moved({"zeta": 0.0, "dry": 0.01, "dry_width": 1e-4}, length=4 * np.pi + 1)
    amplitude = [np.hypot(*motion.state[:2, round(turn / STEP), 0]) for turn in (0.0, 2 * np.pi, 4 * np.pi)]
    assert -np.diff(amplitude) == pytest.approx([0.04, 0.04], rel=0.03)  # 4 F / k a cycle


def test_a_pendulum_has_its_period():
    """Large swings last longer: T / T0 = 1 + a^2 / 16 + 11 a^4 / 3072 + ..."""
    motion = move(members([{"zeta": 0.0, "bend": 1.0}]), [NONE], np.array([[1.0], [0.0]]), 14.0)
    u = motion.state[0, :, 0]
    down = np.flatnonzero((u[:-1] < 0) & (u[1:] >= 0))
    crossing = motion.time[down] - u[down] * STEP / (u[down + 1] - u[down])
    assert np.diff(crossing)[0] / (2 * np.pi) == pytest.approx(1 + 1 / 16 + 11 / 3072 + 173 / 737280, rel=2e-4)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_the_linear_model_of_the_calibration_is_the_motion(order):
    force = drawn("random", 1.0, 0.03, LENGTH, np.random.default_rng(1))
    motion, _ = moved({"zeta": 0.03}, force)
    free, forced = linear(1.0, 0.03, force(motion.time), order)
    assert np.max(np.abs(free @ START[:, 0] + forced - motion.state[order, :, 0])) < 5e-3


@pytest.mark.parametrize("kind", KINDS)
def test_levels_are_those_of_the_linear_response(kind):
    force = drawn(kind, 1.0, 0.05, 200.0, np.random.default_rng(2))
    motion, _ = moved({"zeta": 0.05}, force, 200.0)
    assert np.std(motion.state[0, 500:, 0]) == pytest.approx(0.4, rel=0.35)


def test_a_late_sensor_is_late_in_every_derivative_and_a_clipped_one_is_clipped():
    motion, p = moved({"zeta": 0.0, "delay": 0.37})
    plain, q = moved({"zeta": 0.0})
    t = np.linspace(1.0, 50.0, 997)
    for order in (0, 1, 2):
        late, prompt = reading(motion, p, 0, t, order), reading(plain, q, 0, t - 0.37, order)
        assert late == pytest.approx(prompt, abs=1e-9)
        assert between(plain, 0, t, order) == pytest.approx(
            np.real((0.8 - 0.3j) * 1j**order * np.exp(1j * t)), abs=2e-5
        )
    clipped, r = moved({"zeta": 0.0, "limit": 0.5})
    seen = reading(clipped, r, 0, t, 0)
    assert 0.49 < np.max(np.abs(seen)) <= 0.5


def test_own_units_are_those_of_the_equation_of_motion():
    """In the rig's units the law has the same force, per mass, as in natural ones."""
    scales, rng = Scales(3.0, 20.0, 60.0), np.random.default_rng(5)
    u, v = 0.4, -0.7
    own = {name: law.own(law.draw(rng), scales) for name, law in OSCILLATOR_EFFECTS.items()}
    rng = np.random.default_rng(5)
    natural = {name: law.knobs(law.draw(rng)) for name, law in OSCILLATOR_EFFECTS.items()}
    x, rate, force = u * 3.0, v * 3.0 * 20.0, 3.0 * 400.0
    cubic = own["cubic_stiffness"]["coefficient"] * x**3 / force
    assert cubic == pytest.approx(natural["cubic_stiffness"]["cubic"] * u**3)
    law = own["power_law_damping"]
    drag = law["coefficient"] * abs(rate) ** law["exponent"] / force
    assert drag == pytest.approx(natural["power_law_damping"]["power"] * abs(v) ** law["exponent"])
    pendulum = own["sine_restoring"]
    torque = pendulum["stiffness"] * pendulum["length"] * math.sin(x / pendulum["length"]) / force
    assert torque == pytest.approx(float(restoring(members([natural["sine_restoring"]]), u)[0]))


@pytest.mark.parametrize(
    ("name", "channel"),
    [("cubic_stiffness", "velocity"), ("coulomb_friction", "acceleration"), ("null", "displacement")],
)
def test_effects_are_sized_for_the_channel_that_is_written(name, channel, tmp_path):
    case = draw_oscillator(name, 3, channel=channel, kind="random", periods=8.0, target_excess=1.0)
    again = draw_oscillator(name, 3, channel=channel, kind="random", periods=8.0, target_excess=1.0)
    assert case.truth == again.truth
    reached = case.truth["excess_percent"]
    assert reached < 1e-3 if name == "null" else reached == pytest.approx(1.0, rel=0.35)
    content = yaml.safe_load(write_case(case, tmp_path / "m").read_text())
    assert [r["role"] for r in content["records"]] == ["fit"] * 3 + ["holdout"] * 2
    assert channel in content["records"][0]["channels"]
    record = case.records[0]
    written = np.loadtxt(tmp_path / "m" / "run_1.csv", delimiter=",", skiprows=1)
    assert np.allclose(written[:, -2], record.response, rtol=1e-9, atol=1e-9 * np.abs(record.response).max())
    assert np.std(record.response) > 3 * case.truth["noise_std"]


def test_cases_vary_what_labs_vary():
    cases = [draw_oscillator("null", seed, periods=8.0) for seed in range(4, 14)]
    assert {case.channel for case in cases} == {"displacement", "velocity", "acceleration"}
    assert len({case.unit for case in cases}) >= 5
    assert len({case.truth["kind"] for case in cases}) >= 3
    assert any(len({r.rate for r in case.records}) > 1 for case in cases)
    assert any(not r.even for case in cases for r in case.records)
    assert {case.arbitrary for case in cases} == {True, False}
    displaced = [case for case in cases if case.channel == "displacement"]
    assert max(abs(np.mean(r.response)) / np.std(r.response) for case in displaced for r in case.records) > 2.0


def test_the_generator_knows_nothing_of_the_package():
    folder = Path(oscillator.__file__).parent
    assert not [path.name for path in folder.glob("*.py") if "gear_damping" in path.read_text(encoding="utf-8")]
