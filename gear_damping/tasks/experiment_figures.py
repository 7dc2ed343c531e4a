"""The figures of a training run: stiffness, a response, its scalogram, predicted against true."""

from collections.abc import Mapping
from math import pi
from typing import Any

import numpy as np
import torch
from matplotlib.figure import Figure

from gear_damping.config.settings import Settings
from gear_damping.identification.catalogue import make_wavelet
from gear_damping.physics.systems.traits import Trait
from gear_damping.reporting import figures
from gear_damping.simulation.inspect import forces_of
from gear_damping.simulation.runs import Runs

SCALOGRAM_SAMPLES = 480  # that a scalogram shows: 12 ms at 40 kHz, some 18 mesh periods


def experiment_figures(settings: Settings, runs: Runs, predictions: Mapping[str, Any]) -> dict[str, Figure]:
    """Figures by file name; those of a response show the first run."""
    signal = runs.record(torch.Generator().manual_seed(settings.seed))[0]
    unit, factor = ("µm", 1e6) if runs.model.system.has(Trait.TEETH) else ("m", 1.0)
    made = {
        "response": figures.response_figure(runs.time.numpy(), factor * signal.numpy(), unit),
        "scalogram": scalogram(settings, runs, signal),
        "predicted_against_true": figures.predicted_against_true_figure(predictions),
    }
    if runs.model.system.has(Trait.TEETH):
        forces = forces_of(runs, 0)
        made["mesh_stiffness"] = figures.mesh_stiffness_figure(
            runs.angles["mesh_angle"][0].numpy(), forces["stiffness"].numpy()
        )
    return made


def scalogram(settings: Settings, runs: Runs, signal: torch.Tensor) -> Figure:
    """The wavelet transform of a record, with the cone of influence and the mesh harmonics marked."""
    wavelet = make_wavelet(settings.wavelet, runs.sampling_rate, settings.model.plugins)
    with torch.no_grad():
        columns = wavelet(signal.float().unsqueeze(0) - signal.float().mean())[0]
    speed = runs.values.get("pinion_speed")
    mesh = None if speed is None else abs(float(speed[0] * runs.values["n_teeth_pinion"][0])) / (2 * pi)
    shown = slice(0, SCALOGRAM_SAMPLES)  # of a longer record more would be a blur
    return figures.scalogram_figure(
        runs.time.numpy()[shown],
        np.asarray(wavelet.frequencies_hz),
        columns.numpy()[:, shown],
        wavelet.cone_of_influence(signal.shape[0], signal.device).numpy()[:, shown],
        mesh_frequency_hz=mesh or None,  # a mesh that does not turn has none
        natural_frequency_hz=float(runs.derived["natural_frequency"][0]) / (2 * pi),
    )
