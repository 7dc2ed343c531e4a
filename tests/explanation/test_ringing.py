"""A ringing that noise makes of itself tells neither frequency nor damping; one that stands out of it does."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import torch

from gear_damping.explanation.model import ringing
from gear_damping.explanation.model.ringing import with_untold_ringing
from gear_damping.identification.output_error.normal_equations import nuisance_basis, project_out
from gear_damping.identification.output_error.problem import Prediction
from gear_damping.identification.output_error.records import FitRecord, Observed

RATE, N, TEETH, SPEED = 25e3, 4000, 23, 115.0
TIME = np.arange(N) / RATE
RINGING = 2 * np.pi * 2800.0
MESH = 3e-6 * np.cos(TEETH * SPEED * TIME) + 1e-6 * np.sin(2 * TEETH * SPEED * TIME)
COSINE, SINE = np.cos(RINGING * TIME), np.sin(RINGING * TIME)
LEVEL = 1e-7  # of the noise


@pytest.fixture(autouse=True)
def natural_frequency(monkeypatch):
    monkeypatch.setattr(ringing, "natural_frequency_hz", lambda *_: RINGING / (2 * np.pi))


def _case(sizes, stated=True, spectrum=None):
    """Records of one speed, each of which was fitted with a ringing of some size."""
    fitted, left, owned = [], [], []
    for seed, size in enumerate(sizes):
        noise = LEVEL * np.random.default_rng(seed).standard_normal(N) + (0 if spectrum is None else spectrum)
        series = torch.as_tensor(MESH + size * COSINE + noise)
        turns = {"pinion_angle": torch.as_tensor(SPEED * TIME)} if stated else {}
        fitted.append(FitRecord(f"run{seed}", series, RATE, turns, {}))
        left.append(torch.as_tensor(noise))
        owned.append(torch.as_tensor(np.stack([-size * TIME * SINE, np.cos(46 * SPEED * TIME), COSINE, SINE], 1)))
    found = Prediction(torch.stack(left)[None], torch.stack(owned)[None])
    problem = SimpleNamespace(records=fitted, n_shared=2, response=SimpleNamespace(channels=("transmission_error",)))
    values = {f"pinion_speed@run{seed}": SPEED for seed in range(len(sizes))}
    outcome = SimpleNamespace(
        linearisation=found,
        problem=problem,
        fit_residuals=left,
        values=values,
        hypothesis=SimpleNamespace(model=None),
        flat_given=dict,
    )
    teeth = {"n_teeth_pinion": float(TEETH), "n_teeth_gear": 41.0}
    return outcome, SimpleNamespace(has=lambda trait: True, fitted=fitted, parameters=teeth)


def _told(case, place):
    """How much of the sensitivity by a parameter is left beside what the records have of their own, by record."""
    sensitivity = with_untold_ringing(*case).sensitivity[0]
    apart = project_out(sensitivity[..., :2], nuisance_basis(sensitivity, 2))
    return (apart.square().sum(1) / sensitivity[..., :2].square().sum(1))[:, place]


@pytest.mark.parametrize("stated", [True, False], ids=["angle", "fitted speed"])
def test_a_ringing_within_the_noise_tells_no_frequency(stated):
    case = _case([0.05 * LEVEL], stated)
    assert float(_told(case, 0)) < 1e-6
    assert float(_told(case, 1)) > 0.99  # what repeats with the mesh tells as much as before


def test_a_ringing_that_stands_out_tells_it():
    assert float(_told(_case([LEVEL]), 0)) > 0.1


def test_each_record_is_asked_by_itself():
    quiet, loud = _told(_case([0.05 * LEVEL, LEVEL]), 0)
    assert quiet < 1e-6
    assert loud > 0.1


def test_a_line_among_stronger_ones_is_none():
    lines = sum(0.3 * LEVEL * np.cos(2 * np.pi * f * TIME) for f in (3210.0, 6180.0, 9960.0))
    assert float(_told(_case([0.25 * LEVEL]), 0)) > 0.1
    assert float(_told(_case([0.25 * LEVEL], spectrum=lines), 0)) < 1e-6


def test_where_nothing_turns_nothing_changes():
    outcome, evidence = _case([0.05 * LEVEL])
    evidence.has = lambda trait: False
    assert with_untold_ringing(outcome, evidence) is outcome.linearisation


def test_a_ringing_that_another_channel_shows_is_told():
    """An accelerometer shows it far above its noise, where the transmission error hides it."""
    outcome, evidence = _case([0.05 * LEVEL])
    (record,), noise = evidence.fitted, torch.as_tensor(np.random.default_rng(9).standard_normal(N))
    shown = torch.as_tensor(COSINE) + noise
    evidence.fitted = [replace(record, others=((Observed("acceleration", scale=1e-6), 1e6 * shown),))]
    outcome.fit_residuals = [torch.cat([outcome.fit_residuals[0], noise])]
    found = outcome.linearisation
    outcome.linearisation = Prediction(found.residual.repeat(1, 1, 2), found.sensitivity.repeat(1, 1, 2, 1))
    outcome.problem.response.channels = ("transmission_error", "acceleration")
    assert float(_told((outcome, evidence), 0)) > 0.1
    outcome.fit_residuals = [torch.cat([outcome.fit_residuals[0][:N], shown])]  # of which the simulation shows nothing
    assert float(_told((outcome, evidence), 0)) < 1e-6


@pytest.mark.parametrize(("size", "told"), [(0.03 * LEVEL, False), (LEVEL, True)])
def test_of_a_slow_mesh_orders_far_beyond_the_ringing_are_not_taken_out(monkeypatch, size, told):
    """At 100 kHz a mesh of 30 Hz has 1666 of them, the least squares of which took a minute for each record."""
    rate, count, asked = 100e3, 15000, []
    time = np.arange(count) / rate
    noise = LEVEL * np.random.default_rng(3).standard_normal(count)
    series = MESH[0] * np.cos(2 * np.pi * 30 * time) + size * np.cos(RINGING / 4 * time) + noise
    angle = torch.as_tensor(2 * np.pi * 30 / TEETH * time)
    record = FitRecord("slow", torch.as_tensor(series), rate, {"pinion_angle": angle}, {})
    taken_out = ringing.without_orders
    monkeypatch.setattr(ringing, "without_orders", lambda x, turning: asked.append(x.shape) or taken_out(x, turning))
    turning = ringing.Turning(TEETH * angle.numpy(), (TEETH, 41.0))
    assert ringing._is_told(record, noise, turning, RINGING / 4 / (2 * np.pi)) is told
    assert asked[0][0] < 2 * 5 * 700 * 0.15 * 1.2  # samples of .15 s at twice five natural frequencies
