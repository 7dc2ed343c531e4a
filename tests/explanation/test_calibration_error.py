"""What errors of the calibration leave on held-out records, against many fits to as many draws of the noise."""

import math

import pytest
import torch

from gear_damping.explanation.evidence.excess import excess
from gear_damping.explanation.evidence.noise import NoiseLevel, Scatter
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.calibration_error import calibration_error
from gear_damping.explanation.model.fitting import fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.explanation.model.opened import opened
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.systems.oscillator import Oscillator

STIFFNESS, DAMPING, RATE, NOISE, DRAWS = (2 * math.pi * 10) ** 2, 1.0, 400.0, 2e-3, 60
COEFFICIENT = "viscous_damping.damping_coefficient"


def decay(stiffness, damping, samples):
    """The closed form of a free decay from 0.05 at rest."""
    time = torch.arange(samples, dtype=torch.float64) / RATE
    rate, decrement = math.sqrt(stiffness - damping**2 / 4), damping / 2
    shape = torch.cos(rate * time) + decrement / rate * torch.sin(rate * time)
    return 0.05 * torch.exp(-decrement * time) * shape


def calibrated(seed):
    """A fit to the first half second; held out are three seconds, over which an error of the frequency adds up."""
    generator = torch.Generator().manual_seed(seed)

    def record(name, samples):
        clean = decay(STIFFNESS, DAMPING, samples)
        return FitRecord(name, clean + NOISE * torch.randn(samples, generator=generator, dtype=torch.float64), RATE)

    fit, held = (record("fit", 200),), (record("held", 1200),)
    evidence = Evidence("oscillator", fit, held, Known({}, {}), None, one_record=False, noise=NOISE)
    free = (
        FreeParameter("stiffness", 1.01 * STIFFNESS, logarithmic=True),
        FreeParameter(COEFFICIENT, 1.2 * DAMPING, logarithmic=True),
    )
    return fit_hypothesis(Hypothesis(Oscillator(), (ViscousDamping(),), {"amplitude": 0.05}, free), evidence), evidence


def beside_any_start(true, values):
    """What the fitted parameters miss of a decay, whatever the start: each held-out record has its own."""
    time = torch.arange(len(true), dtype=torch.float64) / RATE
    stiffness, decrement = values["stiffness"], values[COEFFICIENT] / 2
    rate, envelope = math.sqrt(stiffness - decrement**2), torch.exp(-decrement * time)
    columns = torch.stack([envelope * torch.cos(rate * time), envelope * torch.sin(rate * time)], 1)
    return true - columns @ torch.linalg.lstsq(columns, true.unsqueeze(1)).solution[:, 0]


def test_it_is_what_fits_to_other_draws_of_the_noise_miss_on_average():
    true = decay(STIFFNESS, DAMPING, 1200)
    stated, missed = [], []
    for seed in range(DRAWS):
        outcome, evidence = calibrated(seed)
        stated.append(calibration_error(outcome, evidence))
        missed.append(float(beside_any_start(true, outcome.values).square().mean()) / NOISE**2)
    mean, deviation = torch.tensor(missed).mean(), torch.tensor(missed).std()
    error = float(deviation) / DRAWS**0.5
    expected = sum(s.expected for s in stated) / DRAWS
    assert expected == pytest.approx(float(mean), abs=3 * error)
    assert expected > 2 * error
    assert sum(s.deviation for s in stated) / DRAWS == pytest.approx(float(deviation), rel=0.5)


def test_chance_is_wider_where_the_calibration_is_uncertain():
    outcome, evidence = calibrated(0)
    noise = NoiseLevel({"fit": NOISE, "held": NOISE}, "declared", 1e9, True)
    scattered = NoiseLevel({"fit": NOISE, "held": NOISE}, "declared", 1e9, True, scatter=Scatter(0.5, 0.3))
    held = opened(outcome, evidence).holdout
    found, wider = (excess(held, evidence.holdout, level) for level in (noise, scattered))
    assert wider.percent == found.percent
    floor = 100 * NOISE**2 / float((evidence.holdout[0].response - evidence.holdout[0].response.mean()).square().mean())
    plain = found.chance / 3  # one standard error, in % of the channel's variance
    assert wider.chance == pytest.approx(0.5 * floor + 3 * math.hypot(plain, 0.3 * floor), rel=1e-9)


def test_it_is_of_the_motion_that_was_recorded_however_far_off_its_first_guess(monkeypatch):
    """As of an accelerometer that has lost its zero: integrated twice it runs away."""
    outcome, evidence = calibrated(0)
    expected = calibration_error(outcome, evidence).expected
    guess = OutputErrorProblem.first_states
    monkeypatch.setattr(OutputErrorProblem, "first_states", lambda problem: 8 * guess(problem))
    assert calibration_error(outcome, evidence).expected == pytest.approx(expected, rel=0.01)
