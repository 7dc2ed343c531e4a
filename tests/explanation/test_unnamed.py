"""What has no name is taken by the family of its kind, and by it more than by others; motions by scipy."""

import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.fitting import fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.explanation.trials.assess import orthonormal
from gear_damping.explanation.trials.score import projected
from gear_damping.explanation.trials.unnamed import unnamed_columns
from gear_damping.identification.output_error.records import FitRecord, FreeParameter, Observed
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.systems.oscillator import Oscillator

RATE, SAMPLES, NOISE = 60.0, 500, 1e-4
STIFFNESS, DAMPING = 40.0, 0.3  # by mass
COEFFICIENT = "viscous_damping.damping_coefficient"
PAST, STATE = "force that follows earlier motion", "force over the state"
DELAY, FINE = 0.23, 16  # s; steps of a sample that a delayed force is integrated with


def ringing(extra, states=0):
    """Decays from two amplitudes under one more force `extra(y)` on the mass and rates of further states."""
    time, found = np.arange(SAMPLES) / RATE, []
    for start in (1.0, 0.4):

        def rates(t, y):
            force, more = extra(y)
            return [y[1], force - DAMPING * y[1] - STIFFNESS * y[0], *more]

        first = [start, 0.0, *[start, 0.0][:states]]
        found.append(solve_ivp(rates, (0, time[-1]), first, t_eval=time, rtol=1e-10, atol=1e-12).y[:2])
    return found


def cubic(y):
    return -2.0 * y[0] ** 3, []


def hidden_mode(y):
    """A mass of 0.01 on a spring of its own, at 1.6 times the frequency."""
    pull, mass = 1.0 * (y[2] - y[0]) + 0.01 * (y[3] - y[1]), 0.01
    return pull, [y[3], -pull / mass]


def delayed():
    """A force that follows the displacement of a while ago, by small steps and a memory of them."""
    step, found = 1 / RATE / FINE, []
    for start in (1.0, 0.4):
        lag, place, rate = round(DELAY / step), [start], 0.0
        for k in range(SAMPLES * FINE):
            before = place[k - lag] if k >= lag else 0.0
            rate += step * (0.5 * before - DAMPING * rate - STIFFNESS * place[k])
            place.append(place[k] + step * rate)
        place = np.array(place)
        found.append((place[:-1:FINE], np.gradient(place, step)[:-1:FINE]))
    return found


def taken(motions, channel="displacement"):
    """Share that each family takes of what a linear oscillator leaves."""
    random, order = np.random.default_rng(3), ("displacement", "velocity").index(channel)
    noise = NOISE * (STIFFNESS**0.5 if order else 1.0)
    noisy = [torch.as_tensor(motion[order] + noise * random.normal(size=SAMPLES)) for motion in motions]
    observed = Observed(channel)
    records = tuple(FitRecord(n, one, RATE, observed=observed) for n, one in zip("ab", noisy, strict=True))
    known = {"stiffness": STIFFNESS, COEFFICIENT: DAMPING}
    evidence = Evidence("oscillator", records, records[:1], known, None, one_record=False, noise=noise)
    free = [FreeParameter(name, known[name], logarithmic=True) for name in ("stiffness", COEFFICIENT)]
    hypothesis = Hypothesis(Oscillator(), (effect_class("viscous_damping")(),), known, tuple(free))
    nominal = fit_hypothesis(hypothesis, evidence)
    project, residual = projected(nominal)
    residual = project(residual)[:, 0]
    found = {}
    for name, columns in unnamed_columns(nominal, evidence).items():
        basis = orthonormal(project(torch.nn.functional.pad(columns, (0, 0, 0, len(project.expected)))))
        found[name] = float((basis.T @ residual).square().sum() / residual.square().sum())
    return found


@pytest.mark.parametrize("channel", ["displacement", "velocity"])
def test_a_law_over_the_state_is_one_law_at_every_amplitude(channel):
    """The cube of an amplitude 2.5 times as small is 16 times as small: a family that forgot it takes less."""
    found = taken(ringing(cubic), channel)
    assert max(found, key=found.get) == STATE
    assert found[STATE] > 0.99


@pytest.mark.parametrize("motions", [lambda: ringing(hidden_mode, 2), delayed])
def test_what_depends_on_earlier_motion_is_taken_by_the_family_of_it(motions):
    found = taken(motions())
    assert max(found, key=found.get) == PAST
    assert found[PAST] > 0.8


def test_noise_is_taken_by_none():
    found = taken(ringing(lambda y: (0.0, [])))
    assert max(found.values()) < 0.1


def test_beside_a_decay_nothing_drifts():
    """The amplitude falls as time goes on: a law of the amplitude would be a drift of the stiffness."""
    assert "stiffness or damping that drifts" not in taken(ringing(cubic))
