"""Innovations of an oscillator that is pushed at random, against a Kalman filter and against what was drawn."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad_vec
from scipy.linalg import expm

from gear_damping.explanation.statistics.load_noise import Recurrence, drive_correlation, load_noise, recurrence

MASS, DAMPING, MEAN, RATE, SAMPLES, FINER = 0.3, 400.0, 3e8, 50e3, 3000, 20
LOAD, SENSOR = 0.3, 2e-7  # of a sub-step; m: the motion that the load leaves is three times as large


def stiffness(time):
    """That of a mesh at 1.1 kHz."""
    return MEAN * (1 + 0.25 * np.sin(2 * np.pi * 1100 * time))


def steps():
    """Transitions from sample to sample, (samples, 2, 2), the stiffness held over a twentieth of an interval."""
    time, found = np.arange(SAMPLES * FINER) / (RATE * FINER), []
    for sample in range(SAMPLES):
        whole = np.eye(2)
        for k in stiffness(time[sample * FINER : (sample + 1) * FINER] + 0.5 / (RATE * FINER)):
            whole = expm(np.array([[0, 1], [-k / MASS, -DAMPING / MASS]]) / (RATE * FINER)) @ whole
        found.append(whole)
    return np.array(found)


def deviance_of_white(seen):
    """Minus twice the logarithm of the likelihood of noise of a sensor alone, but for the same constant."""
    return len(seen[2:]) * np.log(np.mean(seen[2:] ** 2))


@pytest.fixture(scope="module")
def transitions():
    return steps()


@pytest.fixture(scope="module")
def motion(transitions):
    """As the package makes it: from two solutions of the free motion."""
    states = [np.eye(2)]
    for step in transitions[:-1]:
        states.append(step @ states[-1] / np.abs(step @ states[-1]).max())  # columns of one scale each are as good
    shown = []
    for t in range(SAMPLES - 2):  # from each start anew: the free motion dies away
        two = [np.eye(2)[0], transitions[t][0], (transitions[t + 1] @ transitions[t])[0]]
        shown.append(recurrence(np.array(two)))
    first, second = np.array(shown)[:, :, 0].T
    correlation = drive_correlation(MASS, DAMPING, MEAN, 1 / RATE, 0)
    return Recurrence(first, second, correlation)


def drawn(transitions, load, seed):
    """Displacement that a random load leaves, and the noise of the sensor."""
    random, state, seen = np.random.default_rng(seed), np.zeros(2), []
    for step in transitions:
        seen.append(state[0])
        push = random.normal(size=FINER) * load / MASS * (FINER / RATE) ** 0.5 / FINER
        late = (np.arange(FINER) + 0.5) / (RATE * FINER)
        state = step @ state + np.array([(push * late).sum(), push.sum()])
    return np.array(seen) + SENSOR * random.normal(size=SAMPLES)


def test_two_solutions_give_the_recurrence_that_all_follow(transitions, motion):
    state, seen = np.array([1.0, 300.0]), []
    for step in transitions:
        seen.append(state[0])
        state = step @ state
    seen = np.array(seen)
    np.testing.assert_allclose(motion.left(seen[:, None])[:500], 0, atol=1e-9 * np.abs(seen).max())


def test_the_correlation_of_what_drives_is_that_of_many_draws():
    step = expm(np.array([[0, 1], [-MEAN / MASS, -DAMPING / MASS]]) / RATE)
    random, late = np.random.default_rng(1), (np.arange(FINER) + 0.5) / (RATE * FINER)
    push = random.normal(size=(200_000, FINER))
    noise = np.stack([(push * late).sum(1), push.sum(1)], 1)  # exact but for the turn within an interval
    for derivatives, shown in ((0, np.array([1.0, 0.0])), (1, np.array([0.0, 1.0]))):
        u = noise[1:] @ shown + noise[:-1] @ (shown @ (step - np.trace(step) * np.eye(2)))
        found = drive_correlation(MASS, DAMPING, MEAN, 1 / RATE, derivatives)
        assert found == pytest.approx(float((u[1:] * u[:-1]).mean() / u.var()), abs=0.05)


def test_innovations_are_white_and_the_load_is_found(transitions, motion):
    seen = drawn(transitions, LOAD, 3)
    part = load_noise(seen, motion)
    white = part.innovations(seen[:, None])[2:, 0]
    assert white.var() == pytest.approx(1.0, rel=0.01)
    correlations = [abs((white[lag:] * white[:-lag]).mean()) for lag in range(1, 20)]
    assert max(correlations[1:]) < 4 / SAMPLES**0.5
    assert correlations[0] < 0.1  # what drives it hangs together a little more in stiff moments than in soft ones
    assert part.sensor**0.5 == pytest.approx(SENSOR, rel=0.1)
    assert part.deviance < deviance_of_white(seen) - 1000


def test_without_a_load_next_to_nothing_is_gained(transitions, motion):
    seen = drawn(transitions, 0.0, 4)
    part = load_noise(seen, motion)
    assert 0 <= deviance_of_white(seen) - part.deviance < 10 or part.deviance > deviance_of_white(seen)
    assert abs(part.deviance - deviance_of_white(seen)) < 10
    np.testing.assert_allclose(part.innovations(seen[:, None])[200:, 0], seen[200:] / SENSOR, atol=0.3)


def test_innovations_are_those_of_a_kalman_filter(transitions, motion):
    """With the load and the sensor that were drawn, from a start of which nothing is known."""
    load, seen = LOAD, drawn(transitions, LOAD, 5)
    late = (np.arange(FINER) + 0.5) / (RATE * FINER)
    shape = np.stack([late, np.ones(FINER)])
    noise = shape @ shape.T * (load / MASS * (FINER / RATE) ** 0.5 / FINER) ** 2
    state, covariances, expected = np.zeros(2), np.diag([1e-6, 1e3]), []
    for value, step in zip(seen, transitions, strict=True):
        variance = covariances[0, 0] + SENSOR**2
        gain = covariances[:, 0] / variance
        expected.append((value - state[0]) / variance**0.5)
        state = step @ (state + gain * (value - state[0]))
        covariances = step @ (covariances - np.outer(gain, covariances[0])) @ step.T + noise
    found = load_noise(seen, motion).innovations(seen[:, None])[:, 0]
    assert np.corrcoef(found[100:], np.array(expected)[100:])[0, 1] > 0.995


@pytest.mark.parametrize(
    ("mass", "damping", "stiffness"), [(1.0, 36032.0, 4.08e6), (MASS, DAMPING, MEAN), (1.0, 2.0, -2000.0)]
)
def test_the_correlation_holds_where_the_motion_dies_away_within_a_sample(mass, damping, stiffness):
    interval, rates = 1.3e-3, np.array([[0, 1], [-stiffness / mass, -damping / mass]])

    def pushed(time):
        answer = expm(rates * time)[:, 1]
        return np.outer(answer, answer).ravel()

    ends = [0.0, *np.geomspace(1e-4 * interval, interval, 12)]
    noise = sum(quad_vec(pushed, a, b, epsabs=0, epsrel=1e-10)[0] for a, b in pairwise(ends)).reshape(2, 2)
    step = expm(rates * interval)
    late = step[0] - np.trace(step) * np.eye(2)[0]
    expected = late @ noise[:, 0] / (noise[0, 0] + late @ noise @ late)
    assert abs(expected) <= 0.5
    assert drive_correlation(mass, damping, stiffness, interval, 0) == pytest.approx(expected, rel=1e-6, abs=1e-9)
