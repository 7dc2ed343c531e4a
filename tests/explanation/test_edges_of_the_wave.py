"""The ideal wave of the calibrated stiffness has edges and reaches the natural frequency: a load moves them."""

from types import SimpleNamespace

import numpy as np
import pytest
import torch

from gear_damping.explanation.model import nominal_gear_pair
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.explanation.model.nominal_gear_pair import EDGE, MESH
from gear_damping.physics.effects.fourier_mesh_stiffness import FourierMeshStiffness
from gear_damping.physics.effects.load_dependent_contact import LoadDependentContact
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.simulation.inspect import forces_of
from gear_damping.simulation.simulate import simulate

RATIO, GROWTH = 1.66, 0.03
STIFF, SOFT = 3.6e8, 2e8


def with_shape(monkeypatch, passed, harmonics=20):
    monkeypatch.setattr(nominal_gear_pair, "passed_harmonics", lambda model, given, evidence: passed)
    known = {f"{MESH}.maximum": STIFF, f"{MESH}.minimum": SOFT, f"{MESH}.contact_ratio": RATIO}
    hypothesis = Hypothesis(GearPair(), (FourierMeshStiffness(),), known, ())
    rough = SimpleNamespace(hypothesis=hypothesis, flat_given=lambda: known)
    return nominal_gear_pair.with_shape(rough, None, harmonics)


@pytest.mark.parametrize(("passed", "length"), [(6, 8), (9, 12), (14, 16), (20, 20)])
def test_the_wave_reaches_the_natural_frequency(monkeypatch, passed, length):
    shaped = with_shape(monkeypatch, passed)
    assert shaped.effects[0].chosen["n_harmonics"] == length
    assert shaped.given[f"{MESH}.edge"] == EDGE


def harmonic_under_load(effects, given, order, torque):
    """One harmonic of the mesh stiffness that a pair shows at this torque."""
    model = Model(GearPair(), [*effects, LoadDependentContact()])
    known = given | {"load_dependent_contact.growth": GROWTH, "pinion_torque": torque, "pinion_speed": 10.0}
    values = model.values(2, **{name: value for name, value in known.items() if not name.startswith("mesh_stiffness_")})
    turns = 10.0 * 20 / (2 * np.pi)  # mesh periods a second
    runs = simulate(model, values, sampling_rate=400 * turns, n_samples=400)
    stiffness = forces_of(runs, 0)["stiffness"]
    return complex((stiffness * torch.exp(-2j * np.pi * order * torch.arange(400) / 400)).mean())


def test_a_load_moves_what_lies_at_the_natural_frequency(monkeypatch):
    """d/d eps of the harmonics of a smooth wave that begins early and ends late, in closed form."""
    shaped = with_shape(monkeypatch, 11)
    found = [harmonic_under_load(shaped.effects[:1], shaped.given, 11, torque) for torque in (70.0, 160.0)]
    lengths = [RATIO + GROWTH * torque / 150 for torque in (70.0, 160.0)]
    exact = [
        (STIFF - SOFT) * np.sinc(11 * EDGE) / (11 * np.pi) * np.sin(11 * np.pi * (eps - 1)) for eps in lengths
    ]  # of one half of the spectrum, about the centre
    centre = np.exp(-1j * 11 * np.pi * (RATIO - 1))  # where both edges move alike
    assert found[1] - found[0] == pytest.approx((exact[1] - exact[0]) * centre, rel=0.02)


def test_which_teeth_carry_is_said_by_a_point_between_the_wheels(monkeypatch):
    """Of two wheels that turn by x against each other one of any mass is at most all of x off their mean rotation.

    Beyond, a fit of a sensor with a wrong gain ended at 4.8 of x and one of a quadratic damping at -26.6, with inertias
    that were 12 and 20 of their uncertainties away.
    """
    advance = next(one for one in with_shape(monkeypatch, 8).free if one.name == "contact_advance")
    shares = [one for mass in (1e-9, 1.0, 1e9) for one in (mass / (1 + mass), -1 / (1 + mass))]
    assert (advance.lower, advance.upper) == pytest.approx((min(shares), max(shares)))


def test_no_fit_leaves_the_declared_range_of_a_parameter(monkeypatch):
    shaped = with_shape(monkeypatch, 8)
    declared = Model(shaped.system, shaped.effects).parameters()
    for one in shaped.free:
        assert declared[one.declared_name].lower <= one.lower, one.name
        assert one.upper <= declared[one.declared_name].upper, one.name
