"""The paper's literal readings, each beside what is built instead."""

import numpy as np
import pytest
import torch
from effect_bench import Bench
from gear_case import GearCase
from gear_terms import sampled


def test_the_printed_power_law_drives_the_motion_where_it_moves_back():
    bench = Bench("power_law_damping", {"as_printed": True}, {"power_law_damping.exponent": 1.5})
    at = bench.evaluated()
    force = (bench.effect.damping_force(at, bench.p) * bench.unit("N")).numpy()
    rate = bench.random()[1].numpy()
    np.testing.assert_allclose(force, 131.797425 * np.abs(rate) ** 2.5, rtol=1e-10)
    assert (force * rate < 0).any()


def test_the_printed_backlash_lies_about_the_middle_of_the_gap_and_damps_in_free_flight():
    bench = Bench("backlash", {"as_printed": True}, {"backlash.gap": 8e-5}, others=("viscous_damping",))
    at = bench.evaluated()
    x, v = (s.numpy() for s in bench.random())
    deflection = np.sign(x) * np.maximum(np.abs(x) - 4e-5, 0)
    assert (deflection == 0).any()
    force = sampled(GearCase(), "stiffness", bench.times().numpy()) * deflection + 64.5 * v
    found = (at.mesh_force * bench.unit("N")).numpy()
    np.testing.assert_allclose(found, force, rtol=1e-9, atol=1e-9 * np.abs(force).max())


def test_the_printed_backlash_is_the_other_one_shifted_by_half_the_gap():
    gap = 8e-5
    ours, printed = (Bench("backlash", {"as_printed": p}, {"backlash.gap": gap}) for p in (False, True))
    x, v = ours.random()
    forces = [
        bench.acceleration(bench.kinematics(bench.times(), (place, v)))
        for bench, place in ((ours, x), (printed, x + gap / 2))
    ]
    assert torch.allclose(*forces, rtol=1e-9, atol=1e-6)


@pytest.mark.parametrize("shaft", ["pinion", "gear"])
def test_the_printed_eccentricity_is_added_to_the_stiffness_and_does_nothing(shaft):
    name = f"{shaft}_eccentricity"
    bench = Bench(name, {"as_printed": True}, {f"{name}.amplitude": 1e-3})
    at = bench.evaluated()
    error, rate = bench.equation.imposed_error(at, bench.prepared.terms)
    assert not error.any()
    assert not rate.any()
    stiffness = sampled(GearCase(), "stiffness", bench.times().numpy())
    change = (at.stiffness * bench.unit("N/m")).numpy() / stiffness - 1
    assert np.abs(change).max() < 1e-11


def test_the_printed_eccentricity_counts_in_newton_per_metre():
    bench = Bench("pinion_eccentricity", {"as_printed": True}, {"pinion_eccentricity.amplitude": 0.0})
    bench.use(bench.values | {"pinion_eccentricity.amplitude": torch.full((bench.batch,), 1e7, dtype=torch.float64)})
    angle = GearCase().pinion_speed * bench.times().numpy()
    wanted = sampled(GearCase(), "stiffness", bench.times().numpy()) + 1e7 * np.cos(angle)
    np.testing.assert_allclose((bench.evaluated().stiffness * bench.unit("N/m")).numpy(), wanted, rtol=1e-11)


def test_the_printed_gear_pair_has_a_mass_of_one_kilogram():
    bench = Bench("viscous_damping", system_options={"as_printed": True})
    derived = bench.prepared.derived
    assert derived["equivalent_mass"][0].item() == 1.0
    assert derived["natural_frequency"][0].item() / (2 * np.pi) == pytest.approx(2847, abs=1)
    ours = Bench("viscous_damping").prepared.derived
    assert ours["natural_frequency"][0].item() / (2 * np.pi) == pytest.approx(5523, abs=1)
    assert ours["equivalent_mass"][0].item() == pytest.approx(GearCase().mass, rel=1e-14)
    assert ours["mean_load"][0].item() == pytest.approx(GearCase().mean_load, rel=1e-14)
