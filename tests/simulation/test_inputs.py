"""Measured series as inputs: between samples, and what is refused."""

import numpy as np
import pytest
import torch

from gear_damping.errors import InputError
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.equation import HELD_LOAD
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.inspect import forces_of
from gear_damping.simulation.series import ANGLE, ANGLE_RATE, Series, continued
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver


def test_a_band_limited_input_between_its_samples():
    n, cycles = 400, 0.23  # cycles per sample
    index = torch.arange(n, dtype=torch.float64)
    tone = torch.sin(2 * np.pi * cycles * index + 0.4).unsqueeze(0)
    series = Series(("force",))
    packed = series.shared({"force": tone}, {}, n - 1, 1).for_each()
    for u in (0.0, 0.3, 0.77, 1.0):
        position = torch.full((1,), u, dtype=torch.float64)
        found = torch.stack([series.at(rows, position, position)["force"] for rows in packed])[50:-50, 0]
        expected = torch.sin(2 * np.pi * cycles * (index[50:-51] + u) + 0.4)
        assert (found - expected).abs().max() < 2e-3


def test_a_held_load_and_an_even_rotation():
    series = Series((HELD_LOAD, ANGLE))
    load = torch.tensor([[1.0, -2.0, 5.0]], dtype=torch.float64)
    angle = torch.tensor([[0.5, 1.5, 2.5, 3.5]], dtype=torch.float64)
    packed = series.shared({HELD_LOAD: load, ANGLE: angle}, {}, 3, 1).for_each()
    half, interval = torch.tensor([0.5], dtype=torch.float64), torch.tensor([0.1], dtype=torch.float64)
    found = series.at(packed[1], half, interval)
    assert float(found[HELD_LOAD]) == -2
    assert float(found[ANGLE]) == 2
    assert float(found[ANGLE_RATE]) == pytest.approx(10, rel=1e-14)


def uneven_angle(index, turns=600.0):
    """A shaft that turns fast and unevenly: thousands of rad, a sway of 0.2 rad once in 20 samples; its rate."""
    rate = 2 * np.pi / 20
    angle = turns * index + 0.2 * torch.sin(rate * index + 0.3)
    return angle, turns + 0.2 * rate * torch.cos(rate * index + 0.3)


def between(series, packed, index, u):
    """Angle and rate per sample at u of the intervals `index`."""
    one = torch.ones(len(index), dtype=torch.float64)
    found = series.at(packed[index, :, 0].T, u * one, one)
    return found[ANGLE], found[ANGLE_RATE]


def test_an_uneven_rotation_between_its_samples():
    """Band-limited: of what a straight line between the samples misses, less than 1e-4 is left."""
    every = torch.arange(300, dtype=torch.float64)
    angle, _ = uneven_angle(every)
    series = Series((ANGLE,))
    packed = series.shared({ANGLE: angle.unsqueeze(0)}, {}, 299, 1).for_each()
    inside = torch.arange(40, 260)
    for u in (0.1, 0.4, 0.5, 0.85):
        found, rate = between(series, packed, inside, u)
        true, true_rate = uneven_angle(inside.double() + u)
        straight = angle[inside] + u * (angle[inside + 1] - angle[inside])
        assert (found - true).abs().max() < 1e-4 * (straight - true).abs().max()
        steps = angle[inside + 1] - angle[inside]
        assert (rate - true_rate).abs().max() < 1e-3 * (steps - true_rate).abs().max()


def test_the_rate_of_an_angle_does_not_jump_at_samples():
    angle, true_rate = uneven_angle(torch.arange(300, dtype=torch.float64))
    series, inside = Series((ANGLE,)), torch.arange(40, 260)
    packed = series.shared({ANGLE: angle.unsqueeze(0)}, {}, 299, 1).for_each()
    jump = between(series, packed, inside, 1.0)[1] - between(series, packed, inside + 1, 0.0)[1]
    assert jump.abs().max() < 1e-4 * (true_rate - true_rate.mean()).abs().max()


@pytest.mark.parametrize("length", [70, 400])
def test_a_shorter_series_is_continued_as_it_is_interpolated_alone(length):
    index = torch.arange(60, dtype=torch.float64)
    given = {ANGLE: uneven_angle(index, 3.0)[0], "pinion_torque": 150 + 30 * torch.cos(index / 5)}
    series = Series(tuple(given))
    alone = series.shared({name: value.unsqueeze(0) for name, value in given.items()}, {}, 59, 1).for_each()
    longer = {name: continued(value, length).unsqueeze(0) for name, value in given.items()}
    together = series.shared(longer, {}, length - 1, 1).for_each()[:59]
    one = torch.ones(59, dtype=torch.float64)
    for u in (0.0, 0.3, 1.0):
        expected, found = (series.at(p[..., 0].T, u * one, one) for p in (alone, together))
        for name, value in expected.items():
            torch.testing.assert_close(found[name], value, rtol=1e-5, atol=0)
    assert len(continued(torch.ones(1), 3)) == 3


def test_members_share_the_series_of_their_record_in_their_own_units():
    """Five members of two records, written out by hand and shared."""
    torques = torch.stack([torch.linspace(1, 2, 9), torch.linspace(5, 3, 9)]).double()
    series, units = Series(("pinion_torque",)), torch.tensor([1.0, 2.0, 4.0, 0.5, 0.25, 8.0], dtype=torch.float64)
    shared = series.shared({"pinion_torque": torques}, {"pinion_torque": units}, 8, 6)
    assert shared.coefficients.shape[2] == 2
    written = torques.repeat(3, 1) / units.unsqueeze(1)
    expected = series.shared({"pinion_torque": written}, {}, 8, 6)
    for interval in (0, 3, 7):
        torch.testing.assert_close(shared[interval], expected[interval], rtol=1e-12, atol=1e-12)
    some = torch.tensor([4, 1])
    torch.testing.assert_close(shared.of(some)[5], expected[5][:, some], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("engine", ["native", "eager"])
def test_a_member_moves_as_its_own_record_drives_it(engine):
    """Beside others of another record, and other units, as alone."""
    model = Model(Oscillator(), [effect_class("viscous_damping")()])
    forces = torch.stack([torch.sin(torch.arange(200) / 5), torch.cos(torch.arange(200) / 9)]).double()
    run = {"sampling_rate": 100.0, "n_samples": 200, "solver": Solver(engine=engine)}
    values = model.values(6)
    values["stiffness"] = 400.0 * torch.linspace(0.7, 1.9, 6, dtype=torch.float64)
    together = simulate(model, values, inputs={"force": forces}, **run)
    for member in range(6):
        own = {name: value[..., member : member + 1] for name, value in values.items()}
        alone = simulate(model, own, inputs={"force": forces[member % 2 : member % 2 + 1]}, **run)
        torch.testing.assert_close(
            together.states["displacement"][member], alone.states["displacement"][0], rtol=1e-10, atol=1e-16
        )


def test_an_even_rotation_is_exact():
    """Also after ten thousand turns."""
    series = Series((ANGLE,))
    angle = 3.0 + 2.5 * torch.arange(25000, dtype=torch.float64).unsqueeze(0)
    packed = series.shared({ANGLE: angle}, {}, 24999, 1).for_each()
    inside = torch.arange(24999)
    found, rate = between(series, packed, inside, 0.37)
    assert (found - (3.0 + 2.5 * (inside.double() + 0.37))).abs().max() < 1e-10
    assert (rate - 2.5).abs().max() < 1e-10


def test_a_measured_angle_takes_the_place_of_the_speed(bench_model):
    model, values = bench_model
    given = values(2)
    run = {"sampling_rate": 40e3, "n_samples": 200}
    expected = simulate(model, given, **run)
    angle = expected.channel("pinion_angle")
    given["pinion_speed"] = given["pinion_speed"] * 0.3
    found = simulate(model, given, inputs={"pinion_angle": angle}, **run)
    torch.testing.assert_close(found.response, expected.response, rtol=1e-6, atol=1e-14)
    assert torch.equal(found.channel("pinion_angle"), angle)


def test_a_measured_torque_takes_the_place_of_the_mean(bench_model):
    model, values = bench_model
    given = values(2)
    run = {"sampling_rate": 40e3, "n_samples": 200}
    expected = simulate(model, given, **run).response
    torque = given["pinion_torque"].unsqueeze(1).expand(2, 200)
    found = simulate(model, given, inputs={"pinion_torque": torque}, **run).response
    torch.testing.assert_close(found, expected, rtol=1e-6, atol=1e-14)


def test_wrong_inputs_are_named(bench_model):
    model, values = bench_model
    series = {"force": torch.zeros(2, 5), "pinion_torque": torch.zeros(2, 4)}
    with pytest.raises(InputError) as caught:
        simulate(model, values(2), sampling_rate=40e3, n_samples=5, inputs=series)
    assert "inputs.force" in str(caught.value)
    assert "(2, 5)" in str(caught.value)


def test_forces_balance_the_acceleration(bench_model):
    """m x'' = load - mesh force, with x'' from the velocity by central differences."""
    model, values = bench_model
    runs = simulate(model, values(2), sampling_rate=400e3, n_samples=400)
    forces = forces_of(runs, 1)
    velocity = runs.states["velocity"][1]
    acceleration = (velocity[2:] - velocity[:-2]) * 400e3 / 2
    mass = float(runs.derived["equivalent_mass"][1])
    expected = (forces["load"] - forces["mesh_force"])[1:-1]
    inside = forces["contact"][1:-1] == 1
    difference = (mass * acceleration - expected)[inside]
    assert float(difference.abs().median()) < 2e-3 * float(expected.abs().max())


def test_forces_under_measured_inputs_are_those_of_the_run(bench_model):
    """m x'' of the run is load less mesh force at every output, with a torque and an angle from outside."""
    model, values = bench_model
    eccentric = Model(model.system, [*model.effects, effect_class("pinion_eccentricity")()])
    index = torch.arange(120, dtype=torch.float64)
    inputs = {
        "pinion_torque": (150 + 30 * torch.sin(index / 6)).unsqueeze(0),
        "pinion_angle": uneven_angle(index, turns=0.012)[0].unsqueeze(0),
    }
    given = {**eccentric.values(2), **values(2)}
    solver = Solver(acceleration=True)
    runs = simulate(eccentric, given, sampling_rate=40e3, n_samples=120, inputs=inputs, solver=solver)
    forces = forces_of(runs, 1)
    expected = runs.derived["equivalent_mass"][1] * runs.states["acceleration"][1]
    torch.testing.assert_close(forces["load"] - forces["mesh_force"], expected, rtol=1e-6, atol=1e-3)


def test_rows_that_a_batch_repeats_are_the_same_as_rows_given_in_full():
    model = Model(Oscillator(), [])
    values = model.values(4, stiffness=torch.tensor([1e4, 2e4, 3e4, 4e4]), amplitude=1e-3)
    force = torch.sin(torch.arange(50, dtype=torch.float64) * torch.tensor([[0.3], [0.7]]))
    run = {"sampling_rate": 1000.0, "n_samples": 50}
    short = simulate(model, values, inputs={"force": force}, **run)
    whole = simulate(model, values, inputs={"force": force.repeat(2, 1)}, **run)
    assert torch.equal(short.response, whole.response)
    assert torch.equal(short.inputs["force"], whole.inputs["force"])
    with pytest.raises(InputError, match="shape"):
        simulate(model, values, inputs={"force": force[:1].repeat(3, 1)}, **run)


def test_a_recorded_angle_drives_the_pair_without_its_error(bench_model):
    """The record of a run with a wrong angle, driven by that angle: the same motion, when the error is known."""
    model, values = bench_model
    rate, n = 40e3, 400
    wrong = Model(model.system, [*model.effects, effect_class("shaft_angle_error")()])
    known = {"shaft_angle_error.amplitude": 5e-3, "shaft_angle_error.phase": 0.7}
    given = {**wrong.values(2, **known), **values(2)}
    run = {"sampling_rate": rate, "n_samples": n}
    truth = simulate(wrong, given, **run)
    angle = truth.channel("pinion_angle")
    recorded = angle + 5e-3 * torch.cos(angle + 0.7)
    corrected = simulate(wrong, given, inputs={"pinion_angle": recorded}, **run)
    believed = simulate(model, values(2), inputs={"pinion_angle": recorded}, **run)
    deviation = truth.response.std()
    assert (corrected.response - truth.response).abs().max() < 2e-3 * deviation
    assert (believed.response - truth.response).abs().max() > 2e-2 * deviation


def test_an_input_of_one_member_is_refused_in_its_own_shape_and_where_it_is_not_finite():
    model = Model(Oscillator(), [effect_class("viscous_damping")()])
    wrong = {r"\(batch, time\) = \(1, 40\)": torch.ones(1, 30), "finite": torch.full((1, 40), torch.nan)}
    for said, series in wrong.items():
        given = {"force": series.double()}
        with pytest.raises(InputError, match=said):
            simulate(model, model.values(1), sampling_rate=200.0, n_samples=40, inputs=given)
