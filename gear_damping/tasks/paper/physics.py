"""The response itself, as the paper prints its equations and as they should be: figures 4, 5 and 10, table 1."""

from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import torch

from gear_damping.config.settings import Settings, read_settings
from gear_damping.identification.catalogue import make_wavelet
from gear_damping.reporting.paper.physics import Physics, Response, Stiffness
from gear_damping.reporting.paper.printed import RATIOS_PERCENT, REPRESENTATIVE_PERCENT
from gear_damping.simulation.inspect import forces_of
from gear_damping.simulation.plan import SimulationPlan, run_plan
from gear_damping.simulation.runs import Runs
from gear_damping.tasks.composed import composed
from gear_damping.tasks.paper.cases import PRINTED_ECCENTRICITY
from gear_damping.tasks.simulated import plan_of

VARIANTS = {  # of the response, by name
    "right": ("experiment=baseline",),
    "as_printed": ("experiment=baseline", "++simulator.as_printed=true"),
    "eccentricity": ("experiment=eccentricity",),
    "eccentricity_printed": PRINTED_ECCENTRICITY,
}
MESHES = {  # of figure 4, by label
    "8 harmonics (used here)": (),
    "8 harmonics, Lanczos weights": ("++simulator.fourier_mesh_stiffness.weighting=lanczos",),
    "rectangular, as described": (
        "++simulator.fourier_mesh_stiffness=null", "++simulator.rectangular_mesh_stiffness={}",
    ),
}  # fmt: skip
FINE_SCALES = 240  # on which ridges are looked for: 1.3 % from one to the next
MESH_PERIODS = 3  # as many as figure 4 of the paper shows
MESH_RATE_HZ = 1e6  # at which figure 4 is drawn: the edges of the wave are seen


def physics_of(settings: Settings) -> Physics:
    """Simulate every variant at every damping ratio of figure 14: the paper's torque, a speed that it does not give."""
    samples = settings.simulator.n_samples
    runs = {name: _runs(overrides, samples) for name, overrides in VARIANTS.items()}
    return Physics(
        {name: _response(found, settings.wavelet) for name, found in runs.items()},
        {label: _stiffness(("experiment=baseline", *more)) for label, more in MESHES.items()},
        {name: _derived(runs[name][REPRESENTATIVE_PERCENT]) for name in ("right", "as_printed")},
    )


def _plan(overrides: tuple[str, ...]) -> SimulationPlan:
    return replace(plan_of(read_settings(*composed([*overrides, "family=paper"]))), n_runs=1)


def _runs(overrides: tuple[str, ...], n_samples: int) -> dict[float, Runs]:
    """One run of every ratio (%)."""
    plan = replace(_plan(overrides), n_samples=n_samples)
    return {ratio: run_plan(replace(plan, damping_ratio_percent=ratio)) for ratio in RATIOS_PERCENT}


def _response(runs: dict[float, Runs], wavelet: dict[str, Any]) -> Response:
    """The response of the representative ratio, its transform, and the mean magnitudes at every ratio."""
    shown = runs[REPRESENTATIVE_PERCENT]
    coarse, magnitude, cone = _transform(shown, wavelet)
    fine = [_transform(one, wavelet | {"n_scales": FINE_SCALES}) for one in runs.values()]
    means = [np.nanmean(np.where(outside, np.nan, size), axis=1) for _, size, outside in fine]
    derived = _derived(shown)
    return Response(
        time_s=shown.time.numpy(),
        displacement_m=shown.response[0].numpy(),
        frequencies_hz=coarse,
        magnitude=magnitude,
        cone=cone,
        fine_hz=fine[0][0],
        mean_magnitude=np.stack(means),
        natural_frequency_hz=derived["natural_frequency_hz"],
        mesh_frequency_hz=derived["mesh_frequency_hz"],
    )


def _transform(runs: Runs, settings: dict[str, Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequencies (Hz), magnitudes (scale, time) and what the ends of the record reach, of the first run."""
    wavelet = make_wavelet(settings, runs.sampling_rate)
    signal = runs.response[0]
    with torch.no_grad():
        columns = wavelet((signal - signal.mean()).float().unsqueeze(0))[0]
    cone = wavelet.cone_of_influence(len(signal)).numpy()
    return np.asarray(wavelet.frequencies_hz), columns.abs().numpy(), cone


def _stiffness(overrides: tuple[str, ...]) -> Stiffness:
    """Mesh stiffness over the first mesh periods."""
    plan = replace(_plan(overrides), sampling_rate=MESH_RATE_HZ, damping_ratio_percent=REPRESENTATIVE_PERCENT)
    mesh_hz = float(_mesh_frequency(run_plan(replace(plan, n_samples=2))))
    runs = run_plan(replace(plan, n_samples=round(MESH_PERIODS * MESH_RATE_HZ / mesh_hz) + 1))
    return Stiffness(runs.time.numpy(), forces_of(runs, 0)["stiffness"].numpy())


def _mesh_frequency(runs: Runs) -> torch.Tensor:
    return runs.values["pinion_speed"][0] * runs.values["n_teeth_pinion"][0] / (2 * pi)


def _derived(runs: Runs) -> dict[str, float]:
    """What follows from table 1, by name with its unit."""
    found = {name: float(value[0]) for name, value in runs.derived.items()}
    mass, stiffness = found["equivalent_mass"], found["mean_stiffness"]
    return {
        "base_radius_pinion_m": found["base_radius_pinion"],
        "base_radius_gear_m": found["base_radius_gear"],
        "equivalent_mass_kg": mass,
        "mean_stiffness_n_per_m": stiffness,
        "natural_frequency_hz": found["natural_frequency"] / (2 * pi),
        "mean_load_n": found["mean_load"],
        "static_deflection_m": found["mean_load"] / stiffness,
        "damping_per_percent_ns_per_m": 0.02 * (stiffness * mass) ** 0.5,
        "mesh_frequency_hz": float(_mesh_frequency(runs)),
        "pinion_speed_rpm": float(runs.values["pinion_speed"][0]) * 30 / pi,
        "alpha_per_percent": float(runs.values["power_law_damping.coefficient"][0]) / REPRESENTATIVE_PERCENT,
    }
