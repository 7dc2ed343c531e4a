"""Order of the error: five where contact is smooth, at least four with the corner of backlash."""

from dataclasses import replace

import closed_forms
import gear_reference
import numpy as np
import pytest
from cases import REFERENCE_CASES, TIMES

from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver


def slope(steps, errors):
    return -np.polyfit(np.log(steps), np.log(errors), 1)[0]


@pytest.mark.parametrize("ratio", [0.0, 0.01])
def test_order_five_on_the_oscillator(free_oscillator, ratio):
    rate = 2 * np.pi * 70
    model, values = free_oscillator(ratio, rate)
    errors, substeps = [], (6, 9, 12, 18)
    for n in substeps:
        runs = simulate(model, values, sampling_rate=610, n_samples=300, solver=Solver(substeps=n))
        expected, _ = closed_forms.free_decay(runs.time.numpy(), 1.0, 2 * ratio * rate, rate**2, 1e-3, 0.2e-3 * rate)
        errors.append(np.linalg.norm(runs.response[0].numpy() - expected))
    assert slope(substeps, errors) == pytest.approx(5, abs=0.2)


def test_order_five_on_a_smooth_gear_pair(run_case):
    case = replace(REFERENCE_CASES["bench_lanczos"], power_alpha=0.0, viscous=60.0, gap=None)
    expected, _ = gear_reference.simulate(case, TIMES)
    substeps = (8, 10, 12, 16)
    errors = [np.linalg.norm(run_case(case, TIMES, n) - expected) for n in substeps]
    assert slope(substeps, errors) == pytest.approx(5, abs=0.2)


def test_order_at_least_four_with_impacts(run_case):
    """Impacts at other places of the step at every step size: the mean of several runs shows the order."""
    substeps = (2, 4, 8, 16)
    total = np.zeros(len(substeps))
    for name in ("light_load_viscous", "resonance_third", "rectangular_loose_start", "tongue_4680"):
        case = REFERENCE_CASES[name]
        expected, _ = gear_reference.simulate(case, TIMES)
        total += [np.log(np.linalg.norm(run_case(case, TIMES, n) - expected)) for n in substeps]
    assert slope(substeps, np.exp(total / 4)) >= 4
