"""Our method behind torchdiffeq's front door."""

import subprocess
import sys

import pytest
import torch
import torchdiffeq
from torchdiffeq import odeint

from gear_damping.simulation import torchdiffeq_method
from gear_damping.simulation.integrate import Batch, initial_states, kernel_of
from gear_damping.simulation.layout import Layout
from gear_damping.simulation.series import Series, SharedSeries
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver
from gear_damping.simulation.stepper import Stepper


@pytest.fixture(autouse=True)
def _registered():
    torchdiffeq_method.register()


@pytest.fixture
def stepper(bench_model):
    model, values = bench_model
    prepared = model.prepare(values(3))
    interval = 1 / (40e3 * prepared.scales.time)
    layout, series = Layout(prepared), Series(())
    fixed, start = layout.pack(prepared, interval), initial_states(model, prepared)
    empty = fixed.new_zeros(50, 0, 3)
    kernel = kernel_of(model, layout, series, Batch(fixed, empty[0], fixed.new_zeros(())), start)
    return Stepper(kernel, fixed, SharedSeries.written_out(empty)), start, prepared


def test_dopri5_of_torchdiffeq_agrees_before_the_first_impact(stepper, bench_model):
    """The same right-hand side, another integrator."""
    walker, start, prepared = stepper
    times = torch.arange(12, dtype=torch.float64)
    found = odeint(walker.rates, start, times, rtol=1e-10, atol=1e-12)
    model, values = bench_model
    solver = Solver(substeps=32)
    ours = simulate(model, values(3), sampling_rate=40e3, n_samples=12, solver=solver).response
    torch.testing.assert_close(found[:, 0].T * prepared.scales.length.unsqueeze(1), ours, rtol=1e-6, atol=2e-12)


def test_unknown_options_are_an_error(stepper):
    walker, start, _ = stepper
    options = {"stepper": walker, "substeps": 2, "substep": 3}
    with pytest.raises(ValueError, match="substep"):
        odeint(walker.rates, start, torch.arange(3.0), method=torchdiffeq_method.METHOD, options=options)


def test_times_must_be_output_intervals(stepper):
    walker, start, _ = stepper
    options = {"stepper": walker, "substeps": 2}
    with pytest.raises(ValueError, match="0, 1, 2"):
        odeint(walker.rates, start, torch.tensor([0.0, 0.5, 1.0]), method=torchdiffeq_method.METHOD, options=options)


def test_an_untested_torchdiffeq_is_refused(monkeypatch):
    monkeypatch.setattr(torchdiffeq, "__version__", "9.9.9")
    torchdiffeq_method.register.cache_clear()
    with pytest.raises(RuntimeError, match=r"9\.9\.9"):
        torchdiffeq_method.register()


def test_it_is_refused_when_it_is_used_and_not_before(monkeypatch):
    code = "import torchdiffeq; torchdiffeq.__version__ = '9.9.9'; import gear_damping.simulation.integrate"
    subprocess.run([sys.executable, "-c", code], check=True)
