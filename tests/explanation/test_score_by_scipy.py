"""The score of a candidate and the estimates by record, against slopes and least squares that scipy and numpy make."""

import math
from functools import cache

import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.candidates import candidates_for
from gear_damping.explanation.model.fitting import fit_hypothesis
from gear_damping.explanation.model.homogeneity import homogeneity
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.explanation.trials.score import scores
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.least_squares import Rounds
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.measurement.record import Channel
from gear_damping.physics.effects.cubic_stiffness import CubicStiffness
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.systems.oscillator import Oscillator

STIFFNESS, DAMPING, CUBICS = (2 * math.pi * 10) ** 2, 4.0, (2e4, 2e4, 4e4, 1.5e4)  # of each record
RATE, SAMPLES, NOISE = 400.0, 160, 2e-4
NAMES = ["stiffness", "viscous_damping.damping_coefficient"]
TIMES = np.arange(SAMPLES) / RATE


def motion(stiffness, damping, cubic, place, speed):
    """Displacement of a mass of 1 kg at the sampling instants."""

    def rates(_, state):
        return state[1], -damping * state[1] - stiffness * state[0] - cubic * state[0] ** 3

    return solve_ivp(rates, (0, TIMES[-1]), (place, speed), t_eval=TIMES, rtol=1e-10, atol=1e-13).y[0]


@cache
def measured():
    source = np.random.default_rng(5)
    return [motion(STIFFNESS, DAMPING, cubic, 0.045 + 0.003 * i, 0.0) + NOISE * source.standard_normal(SAMPLES)
            for i, cubic in enumerate(CUBICS)]  # fmt: skip


@cache
def fitted(with_cubic):
    records = tuple(FitRecord(f"run {i}", torch.tensor(y), RATE) for i, y in enumerate(measured()))
    channel = Channel("displacement", np.zeros(1), "m")
    evidence = Evidence("oscillator", records, records, Known({}, {}), channel, False, noise=NOISE)
    free = [FreeParameter("stiffness", STIFFNESS, logarithmic=True), FreeParameter(NAMES[1], DAMPING, logarithmic=True)]
    effects = [ViscousDamping()]
    given = {"amplitude": 0.05}
    if with_cubic:
        effects.append(CubicStiffness())
        free.append(FreeParameter("cubic_stiffness.coefficient", CUBICS[0], scale=CUBICS[0]))
        given["cubic_stiffness.coefficient"] = CUBICS[0]
    hypothesis = Hypothesis(Oscillator(), tuple(effects), given, tuple(free))
    return fit_hypothesis(hypothesis, evidence, rounds=Rounds(60)), evidence


def slopes(outcome, cubic):
    """Residuals (samples,), slopes by stiffness, damping and cubic, and by each start, all by central differences."""
    stiffness, damping = (outcome.values[name] for name in NAMES)
    states = (outcome.fitted.states * outcome.problem.scales)[:, :2].numpy()
    steps = {"stiffness": 1e-4 * stiffness, "damping": 1e-4 * damping, "cubic": 1.0}
    residual, shared, own = [], [], np.zeros((len(states) * SAMPLES, 2 * len(states)))
    for i, (place, speed) in enumerate(states):
        at = {"stiffness": stiffness, "damping": damping, "cubic": cubic, "place": place, "speed": speed}
        residual.append(measured()[i] - motion(**at))

        def slope(name, step, at=at):
            ahead, behind = (motion(**(at | {name: at[name] + sign * step})) for sign in (1, -1))
            return (ahead - behind) / (2 * step)

        shared.append(np.stack([slope(name, step) for name, step in steps.items()], 1))
        rows = slice(i * SAMPLES, (i + 1) * SAMPLES)
        own[rows, 2 * i], own[rows, 2 * i + 1] = slope("place", 1e-5), slope("speed", 1e-3)
    return np.concatenate(residual), np.concatenate(shared), own


def orthogonal(columns, signal):
    basis = np.linalg.qr(columns / np.linalg.norm(columns, axis=0))[0]
    return signal - basis @ (basis.T @ signal)


def test_a_score_is_the_share_that_its_column_takes_with_the_nuisance_projected_out():
    outcome, evidence = fitted(with_cubic=False)
    residual, shared, own = slopes(outcome, 0.0)
    nuisance = np.concatenate([shared[:, :2], own], 1)
    column = orthogonal(nuisance, shared[:, 2])
    left = orthogonal(nuisance, residual)
    size = (column @ left) / (column @ column)
    expected = (column @ left) * size / (residual @ residual)
    tried = [c for c in candidates_for(outcome.hypothesis, evidence) if c.name == "cubic_stiffness"]
    found = scores(outcome, tried, NOISE)[0]
    assert expected > 0.05
    assert found.gain == pytest.approx(expected, rel=2e-3)
    direction = found.direction[: len(residual)].numpy()
    assert abs(direction @ column) / np.linalg.norm(column) == pytest.approx(1.0, abs=1e-4)
    place = found.candidate.strengths[0]
    parameter = found.candidate.hypothesis.common[place]
    assert float(parameter.value(found.start[place])) == pytest.approx(size, rel=0.01)


def test_estimates_by_record_are_those_of_least_squares_over_all_of_them():
    outcome, evidence = fitted(with_cubic=True)
    coefficient = outcome.values["cubic_stiffness.coefficient"]
    residual, shared, own = slopes(outcome, coefficient)
    split = np.zeros((len(residual), len(CUBICS)))
    for i in range(len(CUBICS)):
        rows = slice(i * SAMPLES, (i + 1) * SAMPLES)
        split[rows, i] = shared[rows, 2]
    columns = np.concatenate([split, shared[:, :2], own], 1)
    sizes = np.linalg.norm(columns, axis=0)
    shift = (np.linalg.lstsq(columns / sizes, residual, rcond=None)[0] / sizes)[: len(CUBICS)]
    found = homogeneity(outcome, "cubic_stiffness", evidence)
    assert found.names == tuple(f"run {i}" for i in range(len(CUBICS)))
    assert coefficient * np.array(found.estimates) == pytest.approx(coefficient + shift, rel=5e-3)
    assert np.argmax(found.estimates) == np.argmax(CUBICS)
    assert not found.holds  # one of four records has twice what the others have
