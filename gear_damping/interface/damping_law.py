"""The damping ratio against amplitude of a fitted simulation of an oscillator, with the band of its parameters."""

from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.covariance import covariance_of
from gear_damping.explanation.model.hypothesis import Outcome, natural_frequency_hz
from gear_damping.identification.damping_estimate import DampingCurve
from gear_damping.identification.decay_rate import ratio_percent
from gear_damping.identification.output_error.uncertainty import QUANTILE
from gear_damping.simulation.simulate import simulate

Array = NDArray[np.float64]
SHARE, LARGEST, SMALLEST = 0.05, 0.02, 1e-12  # of a standard deviation, and of a coordinate: moves for slopes
PER_PERIOD = 60  # samples: a turning point between two of them is right to their fourth power
FIRST_PERIODS, MOST_PERIODS = 40, 2000  # of a decay; as often doubled as it takes to fall to the smallest amplitude
AT_REST = 3.0  # periods without a turn, after which the decay has ended
ABOVE = 1.1  # times the largest amplitude, where the decay begins
POINTS = 60  # of the curve, evenly in the logarithm of the amplitude
FEWEST_SWINGS = 4  # half swings of a decay that tells a rate


def damping_law(outcome: Outcome, evidence: Evidence, ends: tuple[float, float]) -> DampingCurve | None:
    """From free decays of the simulation: the fall from one half swing to the next.

    Args:
        outcome: A fitted simulation of an oscillator.
        evidence: What it was fitted to.
        ends: Largest and smallest amplitude of the first channel, SI.

    Returns:
        None where the fitted simulation does not swing, or does not fall over these amplitudes.
    """
    hypothesis = outcome.hypothesis
    frequency = natural_frequency_hz(hypothesis.model, outcome.flat_given())
    if not np.isfinite(frequency) or frequency <= 0:
        return None
    factor = (2 * np.pi * frequency) ** evidence.fit[0].observed.derivatives
    grid = np.geomspace(*ends, POINTS)
    free, count = outcome.problem.free, len(hypothesis.common)
    moves, sizes = _moves(covariance_of(outcome, evidence)[:count, :count])
    steps = torch.cat([torch.zeros_like(moves[:1]), moves, -moves])
    coordinates = outcome.fitted.shared[:count] + steps
    values = {p.name: p.value(coordinates[:, i]) for i, p in enumerate(free[:count])}
    decays = _decays(outcome, values, (ends[0] / factor, ends[1] / factor), frequency)
    curves = [_against(grid / factor, *decay) for decay in decays]
    if any(curve is None for curve in curves):
        return None
    ratio, frequencies = curves[0]
    moved = np.array([one for one, _ in curves[1:]])
    slopes = (moved[: len(moves)] - moved[len(moves) :]) / 2 * sizes[:, None]
    half = QUANTILE * np.sqrt(np.square(slopes).sum(0))
    return DampingCurve(grid, ratio, np.stack([ratio - half, ratio + half], axis=1), frequencies)


def _moves(covariances: Tensor) -> tuple[Tensor, Array]:
    """Small moves (n, n) of the coordinates that are independent of each other, and standard deviations over them.

    Parameters that trade against each other may lie far apart along a curved valley, which their covariance does not
    know: the slopes at its bottom are what it is for.
    """
    sizes, axes = torch.linalg.eigh((covariances + covariances.T) / 2)
    deviations = sizes.clamp(min=0).sqrt()
    steps = (SHARE * deviations).clamp(max=LARGEST)
    return steps.unsqueeze(1) * axes.T, (deviations / steps.clamp(min=SMALLEST)).numpy()


def _decays(
    outcome: Outcome, values: dict[str, Tensor], ends: tuple[float, float], frequency: float
) -> list[tuple[Array, Array]]:
    """Time (n,) and half swing (n,) of a free decay with every set of values."""
    batch = len(next(iter(values.values())))
    model, given = outcome.hypothesis.model, outcome.flat_given()
    chosen: dict[str, Any] = model.values(batch, **given)
    for name, value in values.items():
        if name in chosen:
            chosen[name] = value
    chosen["initial_displacement"] = torch.full((batch,), ABOVE * ends[0], dtype=torch.float64)
    chosen["initial_velocity"] = torch.zeros(batch, dtype=torch.float64)
    chosen = {name: torch.zeros_like(v) if name == "offset_force.force" else v for name, v in chosen.items()}
    rate, periods = PER_PERIOD * frequency, FIRST_PERIODS
    while True:
        runs = simulate(model, chosen, sampling_rate=rate, n_samples=periods * PER_PERIOD)
        path, speed = (runs.states[name].numpy() for name in ("displacement", "velocity"))
        swings = [_half_swings(x, v, rate) for x, v in zip(path, speed, strict=True)]
        end = (periods - AT_REST) / frequency
        if 2 * periods > MOST_PERIODS or all(not len(t) or size[-1] < ends[1] or t[-1] < end for t, size in swings):
            return swings
        periods *= 2


def _half_swings(path: Array, speed: Array, rate: float) -> tuple[Array, Array]:
    """Half the distance between two turning points, and the time between them, one after another."""
    turns = np.flatnonzero(np.sign(speed[1:]) != np.sign(speed[:-1]))
    turns = turns[np.isfinite(path[turns] + path[turns + 1])]
    before, after = speed[turns], speed[turns + 1]
    share = before / np.where(before == after, 1.0, before - after)  # the velocity between two samples is a line
    step = 1 / rate
    place = path[turns] + step * share * (before + (after - before) * share / 2)
    time = (turns + share) * step
    return (time[1:] + time[:-1]) / 2, np.abs(np.diff(place)) / 2


def _against(amplitudes: Array, time: Array, size: Array) -> tuple[Array, Array] | None:
    """Damping ratio in % and frequency in Hz at amplitudes from the largest on; None where there is no fall."""
    falls = np.flatnonzero(np.diff(size) >= 0)
    stop = int(falls[0]) + 1 if falls.size else len(size)
    time, size = time[:stop], size[:stop]
    if len(size) < FEWEST_SWINGS:
        return None
    frequency = 1 / (2 * np.diff(time))
    ratio = ratio_percent(-np.diff(np.log(size)) / np.diff(time), frequency)
    middle = np.sqrt(size[1:] * size[:-1])
    found = (np.interp(-np.log(amplitudes), -np.log(middle), series) for series in (ratio, frequency))
    ratios, frequencies = found
    return ratios, frequencies
