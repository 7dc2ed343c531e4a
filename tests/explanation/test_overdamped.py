"""A mesh that is damped beyond critical is doubted, with what holds the fit, on made-up models."""

from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.steps import overdamped as module
from gear_damping.physics.systems.traits import Trait


def said(monkeypatch, ratio, frequency=270.0, teeth=True):
    """Of a mesh of 300 kg with so much of critical damping, c = 2 zeta m w."""
    monkeypatch.setattr(module, "natural_frequency_hz", lambda *_: frequency)
    mass, rate = 300.0, 2 * torch.pi * (frequency or 270.0)
    prepared = SimpleNamespace(derived={"equivalent_mass": torch.tensor([mass], dtype=torch.float64)})
    model = SimpleNamespace(values=lambda *_, **__: None, prepare=lambda _: prepared)
    given = {"viscous_damping.damping_coefficient": 2 * ratio * mass * rate}
    outcome = SimpleNamespace(flat_given=lambda: given, hypothesis=SimpleNamespace(model=model))
    evidence = SimpleNamespace(has=lambda trait: trait is Trait.TEETH and teeth)
    return module.overdamped(SimpleNamespace(outcome=outcome, bench=SimpleNamespace(evidence=evidence)))


def test_a_damping_beyond_critical_is_told_with_its_remedy(monkeypatch):
    """Heavy discs, slow shafts: 740 % of 3, and 3.02 (2.95 to 3.09) with the stiffness stated within a tenth."""
    found = said(monkeypatch, 7.4)
    assert found.startswith("A damping of 740 % of critical is none of a mesh")
    assert "damping_ratio with an `uncertainty`" in found


@pytest.mark.parametrize(("ratio", "more"), [(0.1, {}), (0.99, {}), (7.4, {"teeth": False}), (7.4, {"frequency": 0.0})])
def test_less_and_other_rigs_are_not(ratio, more, monkeypatch):
    assert not said(monkeypatch, ratio, **more)
