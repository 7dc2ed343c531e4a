"""The package itself."""

from collections.abc import Callable

import numpy as np
import torch

from benchmarks.members import GAP, SAMPLING_RATE, Batch, draw
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.signals.wavelets import RickerCWT
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

torch.set_num_threads(1)
Run = Callable[[], np.ndarray | None]


def assembled(members: Batch) -> tuple[Model, dict[str, torch.Tensor]]:
    """The package's model of these members."""
    names = ["fourier_mesh_stiffness", "power_law_damping", *(["backlash"] if members.gap else [])]
    model = Model(GearPair(), [effect_class(name)() for name in names])
    given = {
        "pinion_torque": members.torque, "pinion_speed": members.speed, "initial_displacement": members.x0,
        "power_law_damping.coefficient": members.alpha, "power_law_damping.exponent": members.exponent,
    }  # fmt: skip
    if members.gap:
        given["backlash.gap"] = np.full_like(members.torque, GAP)
    return model, model.values(len(members.torque), **{k: torch.as_tensor(v) for k, v in given.items()})


def ours(
    batch: int, n_samples: int, substeps: int | None, backlash: bool = False, keep: int = 64, engine: str = "auto"
) -> Run:
    members = draw(batch, backlash)
    model, values = assembled(members)
    solver = Solver(substeps=substeps, engine=engine)

    def run() -> np.ndarray:
        runs = simulate(model, values, sampling_rate=SAMPLING_RATE, n_samples=n_samples, solver=solver)
        return runs.response[:keep].numpy() / members.length[:keep, None]

    return run


def cwt(batch: int, n_samples: int, n_scales: int) -> Run:
    wavelet = RickerCWT(SAMPLING_RATE, frequency_min_hz=200, frequency_max_hz=8000, n_scales=n_scales)
    signals = cwt_signals(batch, n_samples)

    def run() -> np.ndarray:
        with torch.no_grad():
            return wavelet(signals)[:2].numpy()

    return run


def irfft(batch: int, n_samples: int, n_scales: int) -> Run:
    """The inverse FFT of the padded size alone, in the chunks of the transform: what no transform can beat."""
    wavelet = RickerCWT(SAMPLING_RATE, frequency_min_hz=200, frequency_max_hz=8000, n_scales=n_scales)
    signals = cwt_signals(batch, n_samples)
    _, n_fft = wavelet._operator(signals, wavelet._spectrum)
    spectrum = torch.fft.rfft(torch.randn(wavelet.chunk, n_scales, n_fft, generator=torch.Generator().manual_seed(0)))

    def run() -> None:
        for _ in range(0, batch, wavelet.chunk):
            torch.fft.irfft(spectrum, n=n_fft)

    return run


def cwt_signals(batch: int, n_samples: int) -> torch.Tensor:
    return torch.randn(batch, n_samples, generator=torch.Generator().manual_seed(0))


def scales(n_scales: int) -> list[float]:
    """What peers are given: the scales (samples) of our frequencies."""
    wavelet = RickerCWT(SAMPLING_RATE, frequency_min_hz=200, frequency_max_hz=8000, n_scales=n_scales)
    return list(wavelet.scales)
