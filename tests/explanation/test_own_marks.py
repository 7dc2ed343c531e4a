"""Held-out records whose angle does not count from the mark of the others."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.model import own_marks
from gear_damping.identification.observation import MESH_PHASE
from gear_damping.physics.systems.traits import Trait

NOISE = 1.0


@dataclass(frozen=True)
class Record:
    left: tuple[float, float]  # mean squares in one phase of all, and in one of its own
    own: tuple = ()


@dataclass(frozen=True)
class Evidence:
    holdout: tuple[Record, ...]
    noise: float = NOISE
    has_index: bool = True
    mesh_index: bool = False
    trait: Trait = Trait.TEETH

    def has(self, trait):
        return trait is self.trait


def opened(outcome, evidence, solver=None):
    left = [record.left[MESH_PHASE in record.own] for record in evidence.holdout]
    return SimpleNamespace(holdout=[torch.full((10,), value).sqrt() for value in left])


FITTED = SimpleNamespace(fit_residuals=[torch.full((10,), NOISE)])
FAR, BARELY, BAD = (10.0, 1.0), (2.0, 1.0), (10.0, 9.0)  # the last is wrong whatever its angle


def found(records, monkeypatch, outcome=FITTED, **more):
    monkeypatch.setattr(own_marks, "opened", opened)
    evidence = Evidence(tuple(Record(left) for left in records), **more)
    outcome.holdout = opened(outcome, evidence).holdout
    return [MESH_PHASE in record.own for record in own_marks.with_own_marks(evidence, outcome).holdout]


def test_only_a_record_that_one_phase_leads_astray_has_its_own(monkeypatch):
    assert found([FAR, BARELY, BAD], monkeypatch) == [True, False, False]


@pytest.mark.parametrize("more", [{"mesh_index": True}, {"has_index": False}, {"trait": Trait.REST}])
def test_an_angle_that_counts_from_an_index_stays(more, monkeypatch):
    assert found([FAR], monkeypatch, **more) == [False]


def test_beside_a_model_that_misses_as_much_of_the_fitted_records_nothing_is_told(monkeypatch):
    bad = SimpleNamespace(fit_residuals=[torch.full((10,), 3.0)])
    assert found([FAR], monkeypatch, bad) == [False]


def test_what_a_record_has_already_stays(monkeypatch):
    monkeypatch.setattr(own_marks, "opened", opened)
    evidence = Evidence((replace(Record(FAR), own=(MESH_PHASE,)),))
    assert own_marks.with_own_marks(evidence, FITTED) is evidence
