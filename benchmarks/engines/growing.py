"""Work of growing size, each in a process of its own so that its peak memory is known."""

import torch

from benchmarks.engines.own import Run, assembled, cwt_signals
from benchmarks.members import SAMPLING_RATE, draw
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.signals.streaming import iterate_coefficients
from gear_damping.signals.wavelets import RickerCWT
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

STREAMED = 4096  # members that are held at once
SUBSTEPS = 4
MORE = (
    "backlash", "pinion_eccentricity", "gear_eccentricity", "profile_error", "torque_ripple", "coulomb_friction",
    "pinion_stiffness_modulation", "gear_stiffness_modulation",
)  # fmt: skip


def trajectories(batch: int, n_samples: int, effects: int = 2) -> Run:
    """Runs with the first `effects` effects, a slice of the batch at a time; their energy is what is kept."""
    model, values = assembled(draw(batch))
    if effects > 2:
        added = [effect_class(name)() for name in MORE[: effects - 2]]
        model = Model(GearPair(), [*model.effects, *added])
        values = model.values(batch) | values

    def run() -> None:
        energy = []
        for first in range(0, batch, STREAMED):
            part = {name: value[..., first : first + STREAMED] for name, value in values.items()}
            energy.append(_simulated(model, part, n_samples).square().sum(dim=1))
        torch.cat(energy)

    return run


def _simulated(model: Model, values: dict[str, torch.Tensor], n_samples: int) -> torch.Tensor:
    solver = Solver(substeps=SUBSTEPS)
    return simulate(model, values, sampling_rate=SAMPLING_RATE, n_samples=n_samples, solver=solver).response


def coefficients(batch: int, n_samples: int, n_scales: int) -> Run:
    """A data set's CWT, streamed; the sum stands for what is done with it."""
    wavelet = RickerCWT(SAMPLING_RATE, frequency_min_hz=200, frequency_max_hz=8000, n_scales=n_scales)
    signals = cwt_signals(batch, n_samples)

    def run() -> None:
        torch.stack([part.abs().sum() for _, part in iterate_coefficients(wavelet, signals)]).sum()

    return run
