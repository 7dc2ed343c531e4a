"""A mesh that is damped beyond critical is held near what is stated, or doubted, on made-up models."""

from dataclasses import dataclass, replace
from math import inf
from types import SimpleNamespace

import pytest

from gear_damping.explanation.model import near_stated as module
from gear_damping.explanation.steps import calibrate
from gear_damping.explanation.steps.calibrate import Calibration
from gear_damping.explanation.steps.overdamped import HELD, overdamped
from gear_damping.identification.observation import Known
from gear_damping.physics.systems.traits import Trait

MASS, STIFFNESS = 300.0, 8.6e8
STATED = {"mesh_stiffness_max": 1e9, "mesh_stiffness_min": 7e8, "damping_ratio": 0.03, "contact_ratio": 1.6}


@dataclass(frozen=True)
class MadeUpEvidence:
    known: Known
    teeth: bool = True

    def has(self, trait):
        return trait is Trait.TEETH and self.teeth


def outcome_of(ratio, deviation=inf, held="viscous_damping.damping_coefficient"):
    """Of a mesh with so much of critical damping, c = 2 zeta (k m)^.5."""
    free = [SimpleNamespace(name=held, deviation=deviation)]
    damping = 2 * ratio * (STIFFNESS * MASS) ** 0.5
    return SimpleNamespace(figures=(MASS, damping, STIFFNESS), problem=SimpleNamespace(free=free), is_finite=True)


@pytest.fixture(autouse=True)
def made_up_models(monkeypatch):
    monkeypatch.setattr(module, "linear_of", lambda outcome: outcome.figures)


def said(ratio, nominal_deviation=inf, uncertainty=None, teeth=True, **free):
    evidence = MadeUpEvidence(Known(STATED, uncertainty or {}), teeth)
    nominal = outcome_of(ratio, nominal_deviation, **free)
    return overdamped(SimpleNamespace(outcome=nominal, nominal=nominal, bench=SimpleNamespace(evidence=evidence)))


def test_a_damping_beyond_critical_is_told_with_its_remedy():
    """Heavy discs, slow shafts: 740 % of 3, and 3.02 (2.95 to 3.09) with the stiffness held within a tenth."""
    found = said(7.4)
    assert found.startswith("A damping of 740 % of critical is none of a mesh")
    assert "damping_ratio with an `uncertainty` (10 %, and 50 %)" in found


@pytest.mark.parametrize(("ratio", "teeth"), [(0.1, True), (0.99, True), (7.4, False)])
def test_less_and_other_rigs_are_not(ratio, teeth):
    assert not said(ratio, teeth=teeth)


def test_that_a_mesh_was_held_is_said_where_the_file_does_not_say_so_itself():
    assert said(0.03, nominal_deviation=0.5) == HELD
    assert not said(0.03, nominal_deviation=0.5, uncertainty={"damping_ratio": 0.5})
    assert said(0.03, nominal_deviation=0.1, held="fourier_mesh_stiffness.maximum") == HELD
    assert not said(0.03, nominal_deviation=0.1, held="inertia_pinion")


def test_it_is_held_by_what_is_stated_without_an_uncertainty():
    near = module.near_stated(MadeUpEvidence(Known(STATED, {"mesh_stiffness_min": 0.02})))
    assert near.known.uncertainty == {"mesh_stiffness_max": 0.1, "mesh_stiffness_min": 0.02, "damping_ratio": 0.5}
    assert near.known.values == STATED
    assert module.near_stated(MadeUpEvidence(near.known)) is None
    assert module.near_stated(MadeUpEvidence(Known({"contact_ratio": 1.6}, {}))) is None


@pytest.mark.parametrize(
    ("free", "held", "chosen"),
    [(7.4, 0.03, 0.03), (0.05, 0.03, 0.05), (7.4, 6.0, 7.4)],
    ids=["held", "as it was fitted freely", "no better held"],
)
def test_a_calibration_beyond_critical_is_made_again_near_what_is_stated(free, held, chosen, monkeypatch):
    def fitted(evidence, _):
        return Calibration(evidence, outcome_of(held if evidence.known.uncertainty else free))

    monkeypatch.setattr(calibrate, "_under_quiet_torques", fitted)
    evidence = MadeUpEvidence(Known(STATED, {}))
    found = calibrate.NOMINAL[Trait.TEETH](evidence, None)
    assert module.mesh_damping_ratio(found.nominal) == pytest.approx(chosen)
    assert found.evidence == replace(evidence)  # what it was held by is not what the file says
