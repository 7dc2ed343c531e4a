"""A free ringing that is no more than noise makes of itself tells neither frequency nor damping.

In steady running what repeats with the mesh hardly tells the damping, and the initial state of a record is free. With
next to no damping it rings on all through the record, at the frequency at which the noise happens to be strongest, and
the fit then knows that line to a hair. Where the ringing of a record does not stand out of the lines of the noise
beside it, the record has a frequency and a decay of that ringing of its own.
"""

from dataclasses import replace
from math import log

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.signal import decimate
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.covariance import covariance_of
from gear_damping.explanation.model.hypothesis import Outcome, natural_frequency_hz
from gear_damping.identification.damping_estimate import UnsuitedRecord
from gear_damping.identification.free_vibration import Turning, without_orders
from gear_damping.identification.output_error.problem import Prediction
from gear_damping.identification.output_error.records import SEPARATOR, FitRecord
from gear_damping.physics.systems.gear_pair import teeth_of, turned
from gear_damping.physics.systems.traits import Trait

Array = NDArray[np.float64]
BAND = 5.0  # natural frequencies: what rings lies below, and of a slow mesh orders beyond are thousands
EDGE = 10  # samples at either end of what was decimated, into which scipy's filter carries zeros from beyond
BY_CHANCE = 0.01  # probability at which the strongest of all lines of white noise counts as one


def told_covariance(outcome: Outcome, evidence: Evidence) -> Tensor:
    """Covariance of the fitted coordinates as far as more than a ringing of noise tells them."""
    return covariance_of(outcome, evidence, with_untold_ringing(outcome, evidence))


def with_untold_ringing(outcome: Outcome, evidence: Evidence) -> Prediction:
    """The linearisation, with the frequency and the decay of a ringing that noise makes as the record's own.

    Along these the response changes by the time times what the initial state does.
    """
    found, rows = outcome.linearisation, len(outcome.problem.records)
    if not evidence.has(Trait.TEETH) or rows != len(evidence.fitted):  # segments are too short to tell a line
        return found
    pairs = zip(evidence.fitted, outcome.fit_residuals, strict=True)
    natural = natural_frequency_hz(outcome.hypothesis.model, outcome.flat_given())
    told = [_is_told(record, left.numpy(), _turning(record, outcome, evidence), natural) for record, left in pairs]
    untold = 1 - torch.tensor(told, dtype=torch.float64)
    own = found.sensitivity[..., outcome.problem.n_shared :]
    channels = len(outcome.problem.response.channels)
    time = torch.linspace(0.0, 1.0, own.shape[2] // channels, dtype=torch.float64).repeat(channels)
    more = untold[:, None, None] * time[:, None] * own
    return replace(found, sensitivity=torch.cat([found.sensitivity, more], -1))


def _is_told(record: FitRecord, left: Array, turning: Turning, natural: float) -> bool:
    """Whether a ringing stands out in any channel of a record, what neither the mesh nor a shaft repeats.

    Args:
        record: As it was fitted.
        left: What is left of its channels, one after another, in the unit of the first.
        turning: What turns.
        natural: The natural frequency in Hz, far beyond which nothing is looked at.
    """
    shown, channels = record.stacked.numpy() - left, len(record.channels)
    signals = np.stack([shown, left]).reshape(2 * channels, -1).T
    step = int(record.sampling_rate / (2 * BAND * natural))
    if step > 1 and len(signals) > 4 * EDGE * step:
        inside = slice(EDGE, -EDGE)
        turning = replace(turning, mesh_angle=turning.mesh_angle[::step][inside])
        signals = decimate(signals, step, ftype="fir", axis=0)[inside]
    try:
        apart = without_orders(signals, turning).T
    except UnsuitedRecord:  # so few turns tell no lines
        return True
    return any(map(_rings, apart[:channels], apart[channels:]))


def _turning(record: FitRecord, outcome: Outcome, evidence: Evidence) -> Turning:
    teeth = teeth_of(evidence.parameters)
    if "pinion_angle" in record.inputs:
        return Turning(teeth[0] * record.at_samples("pinion_angle").numpy(), teeth)
    names = ("pinion_speed", "pinion_acceleration", "pinion_jerk")
    stated = [record.conditions.get(name, 0.0) for name in names]
    pairs = zip(names, stated, strict=True)
    known = {name: outcome.values.get(f"{name}{SEPARATOR}{record.name}", one) for name, one in pairs}
    time = record.instants / record.sampling_rate
    return Turning(teeth[0] * turned(known | {"pinion_angle": 0.0}, time)[0].numpy(), teeth)


def _rings(ringing: Array, left: Array) -> bool:
    """Whether a ringing has more power than white noise makes of a line, and than any line that is left beside it."""
    n, variance = len(left), float(left.var())
    if variance <= 0:
        return True
    strongest = 2 * float((np.abs(np.fft.rfft(left)[1:]) ** 2).max()) / (n * variance)
    by_chance = 2 * log(n / 2 / BY_CHANCE)
    return float(ringing @ ringing) / variance > max(by_chance, strongest)
