"""The damping coefficient that stands for a force, by what a harmonic motion loses to it."""

import numpy as np
import pytest
import torch
from scipy.integrate import quad, solve_ivp

from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.cycle_loss import damping_coefficient
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator

STIFFNESS, SPEEDS = 4e4, (0.3, 2.0)
FREQUENCY = STIFFNESS**0.5


def found(name, given, speeds=SPEEDS):
    """Of an effect of an oscillator of 1 kg, at velocity amplitudes in m/s."""
    effect = effect_class(name)()
    model = Model(Oscillator(), [effect])
    given = {"stiffness": STIFFNESS, "amplitude": 0.01} | {f"{name}.{key}": value for key, value in given.items()}
    prepared = model.prepare(model.values(len(speeds), **given))
    return damping_coefficient(effect, prepared, torch.tensor(speeds, dtype=torch.float64)).tolist()


def test_dry_friction_is_four_over_pi_of_it():
    coefficients = found("coulomb_friction", {"force": 5.0, "width": 1e-6})
    assert coefficients == pytest.approx([20 / (np.pi * v) for v in SPEEDS], rel=1e-3)


def test_of_two_directions_the_mean_counts():
    width = 0.05 * 0.01 * FREQUENCY  # in units of the velocity that the reference amplitude has
    given = {"force_forward": 4.0, "force_backward": 2.0, "damping_forward": 8.0, "damping_backward": 4.0}

    def of_hand(speed):
        dry = quad(lambda a: 3.0 * np.tanh(speed * np.cos(a) / width) * np.cos(a), 0, 2 * np.pi, limit=400)[0]
        return 6.0 + dry / (np.pi * speed)

    coefficients = found("asymmetric_friction", given | {"width": 0.05})
    assert coefficients == pytest.approx([of_hand(v) for v in SPEEDS], rel=1e-5)


def test_what_grows_with_the_deflection_is_four_over_three_pi_of_that_at_its_amplitude():
    given = {"damping_coefficient": 7.0, "exponent": 1.0, "reference_deflection": 1e-3}
    expected = [7.0 * (v / FREQUENCY / 1e-3) * 4 / (3 * np.pi) for v in SPEEDS]
    assert found("hunt_crossley_damping", given) == pytest.approx(expected, rel=1e-5)


def test_hysteresis_counts_with_its_loop():
    share, limit = 0.05, 4e-3

    def of_hand(speed):
        size = speed / FREQUENCY

        def rates(phase, state):  # of z and of the work, over the phase of x = size sin(phase)
            rate = size * np.cos(phase)
            z = state[0]
            return rate - abs(z / limit) * (rate + abs(rate) * np.sign(z)) / 2, share * STIFFNESS * z * rate

        work = solve_ivp(rates, (0, 10 * np.pi), (0.0, 0.0), rtol=1e-9, atol=1e-14, max_step=0.01,
                         t_eval=(8 * np.pi, 10 * np.pi)).y[1]  # fmt: skip
        return (work[1] - work[0]) / (np.pi * speed * size)

    coefficients = found("hysteretic_damping", {"share": share, "yield_deflection": limit, "exponent": 1.0})
    assert coefficients == pytest.approx([of_hand(v) for v in SPEEDS], rel=2e-3)


def test_hysteresis_that_yields_at_once_is_dry_friction():
    """Of share * k * z_y, where it yields early in a swing; in a thousand steps of a cycle it would run away."""
    given = {"share": 0.5, "yield_deflection": 1e-5, "exponent": 1.0}
    assert found("hysteretic_damping", given, (2.0,)) == pytest.approx(
        [4 * 0.5 * STIFFNESS * 1e-5 / (2 * np.pi)], rel=0.01
    )


def test_hysteresis_too_stiff_to_be_summed_has_no_figure():
    assert np.isnan(found("hysteretic_damping", {"share": 0.5, "yield_deflection": 1e-9}, (2.0,))[0])


def test_a_member_that_is_too_stiff_to_be_summed_leaves_the_others_their_figure():
    given = {"share": 0.5, "yield_deflection": 1e-4, "exponent": 1.0}
    slow, fast = found("hysteretic_damping", given, (2.0, 2e5))
    assert np.isnan(fast)
    assert slow == pytest.approx(found("hysteretic_damping", given, (2.0,))[0], rel=1e-9)


def test_gears_move_about_the_deflection_of_their_load():
    effects = [effect_class(name)() for name in ("fourier_mesh_stiffness", "hunt_crossley_damping")]
    given = {"damping_coefficient": 50.0, "exponent": 1.0, "reference_deflection": 1e-5}
    model = Model(GearPair(), effects)
    values = model.values(1, **{f"hunt_crossley_damping.{key}": value for key, value in given.items()})
    prepared = model.prepare(values)
    mean = float(prepared.derived["mean_load"][0] / prepared.derived["mean_stiffness"][0])
    small = torch.tensor([1e-6], dtype=torch.float64)
    assert float(damping_coefficient(effects[1], prepared, small)[0]) == pytest.approx(50.0 * mean / 1e-5, rel=1e-6)
