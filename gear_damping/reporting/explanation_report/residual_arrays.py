"""What the report's figures show of residuals: their spectrum, and the force that would have closed the gap."""

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.stats import binned_statistic_2d

from gear_damping.explanation.answer.unexplained import first_channel, residual_force
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.shaft import Shaft, shaft_of
from gear_damping.explanation.model.hypothesis import Outcome, natural_frequency_hz
from gear_damping.explanation.state import State
from gear_damping.physics.systems.traits import Trait
from gear_damping.reporting.figures import ForceMap, ForceSurface, ResidualSpectrum
from gear_damping.signals.spectra import amplitude_spectrum, order_spectrum

PHASE_BINS = 16  # of a mesh period
STATE_BINS = (30, 24)  # of displacement and velocity
LEAST_VISITS = 3  # of a cell, for a mean to be drawn
END_SAMPLES = 16  # at either end, where the smoothed force knows only one side
WHOLE_TURNS = 1.05  # of the shaft: more than one, or its orders are no lines

Array = NDArray[np.float64]


def spectrum(found: State, evidence: Evidence, place: int, noise: float) -> ResidualSpectrum:
    """Spectrum of a held-out record's residual, over orders where it holds a whole turn of the pinion.

    Args:
        found: The search.
        evidence: The records.
        place: Which held-out record.
        noise: Its noise in the declared unit.
    """
    record, factor = evidence.held[place], evidence.channel.declared_factor
    samples = len(record.response)
    series = [found.nominal.holdout[place][:samples], record.response - record.response.mean()]
    series += [found.outcome.holdout[place][:samples]] if found.accepted else []
    stacked = torch.stack(series) / factor
    shaft = shaft_of(record, evidence)
    common = {"record": record.name}
    if shaft and _turns(shaft) > WHOLE_TURNS and (np.diff(shaft.angle) > 0).all():
        places, amplitudes = order_spectrum(stacked, torch.as_tensor(shaft.angle))
        common |= {"mesh_order": float(shaft.teeth[0]), "gear_order": shaft.teeth[0] / shaft.teeth[1]}
    else:
        places, amplitudes = amplitude_spectrum(stacked, record.sampling_rate)
        model = found.nominal.hypothesis.model
        common |= {"natural_frequency_hz": natural_frequency_hz(model, found.nominal.flat_given())}
    before, measured, *after = amplitudes.numpy()[:, 1:]
    floor = np.full(len(before), noise * _mean_amplitude(len(record.response)))
    return ResidualSpectrum(places.numpy()[1:], before, after[0] if after else None, measured, floor, **common)


def _turns(shaft: Shaft) -> float:
    return float(shaft.angle[-1] - shaft.angle[0]) / (2 * np.pi)


def _mean_amplitude(samples: int) -> float:
    """Mean amplitude of a line of white noise of unit variance under a Hann window: Rayleigh's mean."""
    window = np.hanning(samples)
    return float(np.sqrt(np.pi * (window**2).sum()) / window.sum())


def force_map(outcome: Outcome, evidence: Evidence) -> ForceMap | None:
    """Mean residual force by pinion tooth and mesh phase; None without shafts."""
    records = (*evidence.fitted, *evidence.held)
    shafts = [shaft_of(record, evidence) for record in records]
    if not all(shafts):
        return None
    teeth = shafts[0].teeth[0]
    meshed = np.concatenate([_inner(shaft.angle * teeth / (2 * np.pi)) for shaft in shafts])
    force = np.concatenate(_forces(outcome, evidence))
    edges = (np.linspace(0, 1, PHASE_BINS + 1), np.arange(teeth + 1))
    mean, _ = _binned(meshed % 1, np.floor(meshed) % teeth + 0.5, force, edges)
    return ForceMap((np.arange(PHASE_BINS) + 0.5) / PHASE_BINS, mean)


def force_surface(outcome: Outcome, evidence: Evidence) -> ForceSurface:
    """Mean residual force over displacement and velocity of the simulated motion."""
    records = (*evidence.fitted, *evidence.held)
    residuals = first_channel((*outcome.fit_residuals, *outcome.holdout), records)
    motion = [record.response.numpy() - residual for record, residual in zip(records, residuals, strict=True)]
    place = np.concatenate([_inner(x) for x in motion])
    pairs = zip(motion, records, strict=True)
    rate = np.concatenate([_inner(np.gradient(x)) * record.sampling_rate for x, record in pairs])
    edges = tuple(np.linspace(v.min(), v.max(), n + 1) for v, n in zip((rate, place), STATE_BINS[::-1], strict=True))
    mean, visits = _binned(rate, place, np.concatenate(_forces(outcome, evidence)), edges)
    v, x = ((e[1:] + e[:-1]) / 2 for e in edges)
    if evidence.has(Trait.MASS):
        return ForceSurface(1e6 * x, v, mean, visits=visits)
    unit, factor = evidence.channel.declared_unit, evidence.channel.declared_factor
    units = {"displacement_unit": unit, "velocity_unit": f"{unit}/s", "force_unit": f"({unit}/s²)"}
    return ForceSurface(x / factor, v / factor, mean / factor, visits=visits, **units)


def _forces(outcome: Outcome, evidence: Evidence) -> Sequence[Array]:
    records = (*evidence.fitted, *evidence.held)
    residuals = first_channel((*outcome.fit_residuals, *outcome.holdout), records)
    pairs = zip(residuals, records, strict=True)
    return [_inner(residual_force(outcome, torch.as_tensor(r), record.sampling_rate).numpy()) for r, record in pairs]


def _inner(values: Array) -> Array:
    return values[END_SAMPLES:-END_SAMPLES] if len(values) > 4 * END_SAMPLES else values


def _binned(first: Array, second: Array, values: Array, edges: Sequence[Array]) -> tuple[Array, Array]:
    """Means and counts over bins; NaN where there are too few values for a mean."""
    counts = np.histogram2d(first, second, bins=list(edges))[0]
    mean = binned_statistic_2d(first, second, values, statistic="mean", bins=list(edges)).statistic
    return np.where(counts >= LEAST_VISITS, mean, np.nan), counts
