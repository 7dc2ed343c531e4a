"""A line keeps its order of the pinion at every speed, or its frequency: a belt, or the mains."""

import numpy as np
import pytest
import torch

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.fitting import fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.explanation.trials.line import strongest_line
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.least_squares import Rounds
from gear_damping.identification.output_error.records import FitRecord, FreeParameter, Observed
from gear_damping.measurement.record import Channel
from gear_damping.physics.effects.fourier_mesh_stiffness import FourierMeshStiffness
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.systems.gear_pair import GearPair

RATE, SAMPLES, SPEEDS = 20_000.0, 1500, (300.0, 420.0, 530.0)
TIME = np.arange(SAMPLES) / RATE
EVEN = {"fourier_mesh_stiffness.minimum": 3e8, "fourier_mesh_stiffness.maximum": 3e8}  # no mesh in what is left
DAMPING = "viscous_damping.damping_coefficient"


def fitted(responses, stiffness=None):
    """A gear pair, of even stiffness unless another is given, fitted to records at three speeds; and its evidence."""
    records = []
    for speed, values in zip(SPEEDS, responses, strict=True):
        inputs = {"pinion_angle": torch.as_tensor(speed * TIME)}
        seen = Observed("transmission_error")
        records.append(FitRecord(f"{speed}", torch.as_tensor(values), RATE, inputs, observed=seen))
    channel, records = Channel("transmission_error", np.zeros(1), "m"), tuple(records)
    evidence = Evidence("gear_pair", records, records[:1], Known({}, {}), channel, False, noise=1e-7)
    free = (FreeParameter(DAMPING, 100.0, logarithmic=True),)
    base = Hypothesis(GearPair(), (FourierMeshStiffness(), ViscousDamping()), stiffness or EVEN, free)
    return fit_hypothesis(base, evidence, rounds=Rounds(1)), evidence


def shown(stiffness=None):
    """What the pair shows without any line, (records, time)."""
    outcome, _ = fitted(np.full((3, SAMPLES), 1.6e-5), stiffness)
    problem = outcome.problem
    predicted = problem.response.values - outcome.fitted.prediction.residual[0] / problem.response.weights
    return predicted.reshape(3, SAMPLES).numpy()


@pytest.fixture(scope="module")
def calm():
    """The same of even stiffness."""
    return shown()


@pytest.mark.parametrize("is_force", [True, False])
def test_a_slow_force_changes_the_deflection_in_proportion_and_a_pickup_does_not(is_force):
    """The teeth are softer where one pair is in contact, and give more under the same force."""
    uneven = {"fourier_mesh_stiffness.minimum": 2e8, "fourier_mesh_stiffness.maximum": 3.5e8}
    clean, phases = shown(uneven), np.array([[0.4], [2.1], [5.0]])
    wave = 0.05 * np.cos(2 * np.pi * 43.0 * TIME + phases)
    noise = 1e-8 * np.random.default_rng(4).normal(size=clean.shape)
    line = strongest_line(*fitted(clean + wave * (clean if is_force else clean.mean()) + noise, uneven))
    assert line.is_force is is_force
    assert line.place == pytest.approx(43.0, rel=0.01)
    assert line.name.startswith("a force at 43" if is_force else "a line at 43")
    assert line.share > 0.98


def found(calm, wave):
    """The line in what the pair shows with a wave (angle of it by record) and a little noise."""
    random, phases = np.random.default_rng(2), np.array([[0.4], [2.1], [5.0]])
    angle = np.stack([speed * TIME for speed in SPEEDS])
    noise = 1e-7 * random.normal(size=calm.shape)
    return strongest_line(*fitted(calm + 1e-6 * np.cos(wave(TIME, angle) + phases) + noise))


@pytest.mark.parametrize("order", [0.71, 6.3])
def test_a_belt_keeps_its_order(calm, order):
    line = found(calm, lambda time, angle: order * angle)
    assert line.unit == "order"
    assert line.place == pytest.approx(order, rel=0.03)
    assert line.hertz == pytest.approx(order * SPEEDS[0] / (2 * np.pi), rel=0.03)


@pytest.mark.parametrize("hertz", [50.0, 417.0])
def test_the_mains_keep_their_frequency(calm, hertz):
    line = found(calm, lambda time, angle: 2 * np.pi * hertz * time)
    assert line.unit == "Hz"
    assert line.hertz == pytest.approx(line.place)
    assert line.place == pytest.approx(hertz, rel=0.03)
