"""Where states of effects begin: two masses on two springs, and a fit that finds where they began."""

import numpy as np
import pytest
import torch
from gear_case import GearCase
from scipy.integrate import solve_ivp

from gear_damping.errors import InputError
from gear_damping.identification.output_error.least_squares import fit
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.effects.bearing_flexibility import BearingFlexibility
from gear_damping.physics.effects.fourier_mesh_stiffness import FourierMeshStiffness
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.simulation.driven import Driven
from gear_damping.simulation.simulate import simulate

CASE = GearCase()
K, KB, MB, RATE, SAMPLES = 3e8, 5e8, 1.3, 5e4, 300
GIVEN = {
    "fourier_mesh_stiffness.maximum": K,
    "fourier_mesh_stiffness.minimum": K,
    "bearing_flexibility.stiffness": KB,
    "bearing_flexibility.mass": MB,
    "bearing_flexibility.damping_ratio": 0.0,
}
PLACE = "bearing_flexibility.displacement"
X0, Y0 = 2e-5, 1.5e-5  # m, of the transmission error and of the bearing
REST = CASE.mean_load / KB  # where the effect itself puts the bearing


def model():
    return Model(GearPair(), [FourierMeshStiffness(), BearingFlexibility()])


def simulated(**initial_perturbations):
    values = model().values(1, initial_displacement=X0, **GIVEN)
    moved = {name: torch.tensor([value], dtype=torch.float64) for name, value in initial_perturbations.items()}
    return simulate(model(), values, sampling_rate=RATE, n_samples=SAMPLES, inputs=Driven(initial_perturbations=moved))


def two_masses():
    """The transmission error, by scipy."""

    def slope(t, s):
        x, v, y, w = s
        force = K * (x - y)
        return [v, (CASE.mean_load - force) / CASE.mass, w, (force - KB * y) / MB]

    times = np.arange(SAMPLES) / RATE
    return solve_ivp(slope, (0, times[-1]), [X0, 0, Y0, 0], "DOP853", times, rtol=1e-11, atol=1e-16).y[0]


def test_a_bearing_begins_where_it_is_told():
    found = simulated(**{PLACE: Y0 - REST})
    assert found.states[PLACE][0, 0].item() == pytest.approx(Y0, rel=1e-12)
    expected = two_masses()
    assert np.abs(found.states["displacement"][0].numpy() - expected).max() < 1e-4 * np.abs(expected).max()


def test_without_a_perturbation_it_is_where_the_effect_puts_it():
    assert simulated().states[PLACE][0, 0].item() == pytest.approx(REST, rel=1e-9)


def test_an_unknown_state_is_refused_with_the_nearest():
    with pytest.raises(InputError, match=f"did you mean '{PLACE}'"):
        simulated(**{"bearing_flexibility.displacment": 0.0})


def test_a_fit_finds_where_the_bearing_began():
    record = FitRecord("run", torch.as_tensor(two_masses()), RATE)
    problem = OutputErrorProblem(model(), GIVEN, [], [record])
    found = fit(problem, torch.zeros(1, 0, dtype=torch.float64))
    start = dict(zip(problem.local, (found.states * problem.scales)[0].tolist(), strict=True))
    assert start["displacement"] == pytest.approx(X0, rel=1e-3)
    assert start[PLACE] == pytest.approx(Y0 - REST, rel=1e-3)
