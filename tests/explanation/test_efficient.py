"""Parameters weighed by a random load, against generalised least squares with the whole covariance of the residuals."""

import math
from dataclasses import replace

import numpy as np
import torch

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.covariance import covariance_of
from gear_damping.explanation.model.fitting import fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.explanation.trials.assess import assessed
from gear_damping.explanation.trials.efficient import efficient
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.identification.output_error.step import Points
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.systems.oscillator import Oscillator

STIFFNESS, DAMPING, RATE, NOISE, SAMPLES, LOAD = (2 * math.pi * 10) ** 2, 2.0, 100.0, 1e-4, 700, 0.1
COEFFICIENT = "viscous_damping.damping_coefficient"
RUNS = 30


def rates(stiffness, damping):
    return np.array([[0.0, 1.0], [-stiffness, -damping]])


def one_step(system):
    """Motion of one sample and covariance of what a white load of unit intensity adds in it, by the eigenvectors."""
    values, vectors = np.linalg.eig(system)
    step = (vectors @ np.diag(np.exp(values / RATE)) @ np.linalg.inv(vectors)).real
    pushed = np.linalg.solve(vectors, np.array([0.0, 1.0], dtype=complex))
    sums = values[:, None] + values[None, :]
    inner = np.outer(pushed, pushed) * (np.exp(sums / RATE) - 1) / sums
    return step, (vectors @ inner @ vectors.T).real


def pushed(random):
    step, added = one_step(rates(STIFFNESS, DAMPING))
    state, root, seen = np.array([0.05, 0.0]), np.linalg.cholesky(added), []
    for _ in range(SAMPLES):
        seen.append(state[0])
        state = step @ state + LOAD * root @ random.normal(size=2)
    return np.array(seen) + NOISE * random.normal(size=SAMPLES)


def decay(stiffness, damping, start, speed):
    half = damping / 2
    turn = math.sqrt(stiffness - half**2)
    time = np.arange(SAMPLES) / RATE
    return np.exp(-half * time) * (start * np.cos(turn * time) + (speed + half * start) / turn * np.sin(turn * time))


def whole_covariance(stiffness, damping):
    """Of the displacements that the load adds, and the sensor's noise."""
    step, added = one_step(rates(stiffness, damping))
    covariances, found = np.zeros((2, 2)), NOISE**2 * np.eye(SAMPLES)
    for at in range(SAMPLES):
        ahead = covariances
        for later in range(at, SAMPLES):
            found[at, later] += ahead[0, 0]
            found[later, at] = found[at, later]
            ahead = step @ ahead
        covariances = step @ covariances @ step.T + LOAD**2 * added
    return found


def generalised(seen, weight):
    """Logarithm of the damping coefficient and its deviation, by Gauss-Newton steps weighed by a whole covariance."""
    point = np.array([math.log(STIFFNESS), math.log(DAMPING), 0.05, 0.0])

    def shown(at):
        return decay(math.exp(at[0]), math.exp(at[1]), at[2], at[3])

    for _ in range(4):
        steps = np.diag([1e-6, 1e-5, 1e-6, 1e-5])
        slopes = np.stack([(shown(point + h) - shown(point - h)) / (2 * h.max()) for h in steps], 1)
        matrix = slopes.T @ weight @ slopes
        point = point + np.linalg.solve(matrix, slopes.T @ weight @ (seen - shown(point)))
    return point[1], math.sqrt(np.linalg.inv(matrix)[1, 1])


def fitted(seen):
    """A plain fit to a record, and its evidence."""
    records = (FitRecord("run", torch.as_tensor(seen), RATE),)
    evidence = Evidence("oscillator", records, (), Known({}, {}), None, one_record=False, noise=NOISE, sealed=True)
    free = (
        FreeParameter("stiffness", STIFFNESS, logarithmic=True),
        FreeParameter(COEFFICIENT, 1.2 * DAMPING, logarithmic=True),
    )
    return fit_hypothesis(Hypothesis(Oscillator(), (ViscousDamping(),), {"amplitude": 0.05}, free), evidence), evidence


def weighed(seen):
    """The same by least squares, and one step on: (coordinate, deviation) of each."""
    plain, evidence = fitted(seen)
    better = efficient(plain, assessed(plain, [], evidence).random)
    assert better.values == {p.name: p.start for p in better.hypothesis.free}
    return [
        (math.log(one.values[COEFFICIENT]), math.sqrt(float(covariance_of(one, evidence)[1, 1])))
        for one in (plain, better)
    ]


def test_one_step_on_whitened_residuals_is_as_good_as_the_whole_covariance():
    random = np.random.default_rng(7)
    seen = [pushed(random) for _ in range(RUNS)]
    weight = np.linalg.inv(whole_covariance(STIFFNESS, DAMPING))
    best = np.array([generalised(one, weight) for one in seen])
    plain, better = np.array([weighed(one) for one in seen]).transpose(1, 0, 2)
    true = math.log(DAMPING)

    def size(values):
        return math.sqrt(np.mean(np.square(values)))

    assert size(best[:, 0] - true) < 0.9 * size(plain[:, 0] - true)  # the load makes a difference
    assert size((plain[:, 0] - true) / plain[:, 1]) > 2  # which least squares does not know of
    assert size(better[:, 0] - best[:, 0]) < 0.1 * size(best[:, 0] - true)
    assert 0.85 < np.median(better[:, 1] / best[:, 1]) < 1.2
    assert 0.7 < size((better[:, 0] - true) / better[:, 1]) < 1.4  # of 30: three deviations of their mean square


def test_a_step_that_leaves_far_more_is_not_taken(monkeypatch):
    plain, evidence = fitted(pushed(np.random.default_rng(7)))
    random = assessed(plain, [], evidence).random
    assert efficient(plain, random) is not plain
    wrong = replace(plain.fitted.prediction, sensitivity=-1e-2 * plain.fitted.prediction.sensitivity)  # uphill, and far
    astray = replace(plain, fitted=replace(plain.fitted, prediction=wrong))
    assert efficient(astray, random) is astray
    nowhere = Points(torch.full((1, 2), math.nan, dtype=torch.float64), plain.fitted.states.unsqueeze(0))
    monkeypatch.setattr("gear_damping.explanation.trials.efficient.newton_step", lambda *args: nowhere)
    assert efficient(plain, random) is plain
