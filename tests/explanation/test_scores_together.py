"""Candidates that differ in values alone are simulated together and score as they would alone."""

import numpy as np
import pytest
import torch

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.candidates import candidates_for
from gear_damping.explanation.model.fitting import fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.explanation.trials import score as ranking
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.least_squares import Rounds
from gear_damping.identification.output_error.records import FitRecord, FreeParameter, Observed
from gear_damping.measurement.record import Channel
from gear_damping.physics.effects.fourier_mesh_stiffness import FourierMeshStiffness
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.systems.gear_pair import GearPair

DAMPING = "viscous_damping.damping_coefficient"


@pytest.fixture(scope="module")
def nominal():
    time = torch.arange(600, dtype=torch.float64) / 40_000
    angle = 500 * time
    source = torch.Generator().manual_seed(0)
    response = 1.6e-5 + 1e-6 * torch.cos(3 * angle) + 1e-7 * torch.randn(600, generator=source, dtype=torch.float64)
    record = FitRecord("r", response, 4e4, {"pinion_angle": angle}, observed=Observed("transmission_error"))
    channel = Channel("transmission_error", np.zeros(1), "m")
    evidence = Evidence("gear_pair", (record,), (record,), Known({}, {}), channel, False, noise=1e-7)
    free = (FreeParameter(DAMPING, 100.0, logarithmic=True),)
    base = Hypothesis(GearPair(), (FourierMeshStiffness(), ViscousDamping()), {}, free)
    return fit_hypothesis(base, evidence, rounds=Rounds(2)), evidence


def test_together_they_score_as_alone(nominal, monkeypatch):
    outcome, evidence = nominal
    tried = candidates_for(outcome.hypothesis, evidence)
    tried = [c for c in tried if c.name == "torque_ripple" or (c.name == "tooth_crack" and "shaft=pinion" in c.label)]
    together = ranking.scores(outcome, tried, 1e-7)
    groups = ranking._alike(tried, len(evidence.fit[0].response))
    sizes = sorted(len(group) for group in groups)
    assert sizes == [2, 2, 10, 10, 20, 20], "teeth, halved or not; orders as torque and share, two of the gear"
    monkeypatch.setattr(ranking, "MOST_SAMPLES", 1)
    assert all(len(group) == 1 for group in ranking._alike(tried, 600))
    alone = {id(score.candidate): score for score in ranking.scores(outcome, tried, 1e-7)}
    assert len(together) == len(alone) == len(tried)
    for score in together:
        other = alone[id(score.candidate)]
        assert score.gain == pytest.approx(other.gain, abs=1e-9)
        torch.testing.assert_close(score.start, other.start, rtol=1e-6, atol=1e-9)


def test_effects_for_which_there_is_no_time_are_not_scored(nominal):
    outcome, evidence = nominal
    tried = [c for c in candidates_for(outcome.hypothesis, evidence) if c.name in ("torque_ripple", "sensor_offset")]
    asked = []

    def refuses(name):
        asked.append(name)
        return name == "torque_ripple"

    found = ranking.scores(outcome, tried, 1e-7, ranking.Scoring(refuses=refuses))
    assert set(asked) == {"torque_ripple", "sensor_offset"}
    assert {score.candidate.name for score in found} == {"sensor_offset"}


@pytest.mark.parametrize("effect", ["pitch_error", "tooth_crack"])
def test_teeth_without_numbers_are_not_simulated_again(nominal, monkeypatch, effect):
    outcome, evidence = nominal
    tried = [c for c in candidates_for(outcome.hypothesis, evidence) if c.name == effect]
    apart = [c for c in tried if c.own_tooth]
    members, original = [], ranking.OutputErrorProblem.predict

    def predict(problem, shared, states, horizon=None):
        members.append(len(shared))
        return original(problem, shared, states, horizon)

    monkeypatch.setattr(ranking.OutputErrorProblem, "predict", predict)
    together = ranking.scores(outcome, tried, 1e-7)
    assert apart
    assert sum(members) == sum(len(c.strengths) for c in tried if not c.own_tooth)
    alone = {id(score.candidate): score for score in ranking.scores(outcome, apart, 1e-7)}
    assert sum(members) > sum(len(c.strengths) for c in tried if not c.own_tooth), "by themselves they are"
    for score in (one for one in together if one.candidate.own_tooth):
        other = alone[id(score.candidate)]
        assert score.gain == pytest.approx(other.gain, abs=1e-9)
        assert score.own == pytest.approx(other.own)
