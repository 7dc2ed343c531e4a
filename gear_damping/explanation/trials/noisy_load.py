"""Whether an oscillator moves with the noise of its measured load, or the sensor of the load alone shows it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.statistics.load_error import load_error
from gear_damping.explanation.statistics.paired import paired_gain
from gear_damping.explanation.trials.innovations import known_error
from gear_damping.explanation.trials.refit import block_samples


def moves_with_noise(loud: Outcome, quiet: Outcome, evidence: Evidence) -> bool:
    """Whether the load as it was measured is far likelier to have driven the records than the one without its noise.

    What the error of a load leaves is narrow about the natural frequency, and hangs together over as long as the motion
    rings: two predictions are compared in residuals that are made white by it. Where its size is not known, or a record
    is left out in part, block by block.

    Args:
        loud: The nominal model driven by loads as they were measured.
        quiet: The same by loads without the noise of their sensor.
        evidence: The records with those.
    """
    gained = _gained(loud, quiet, evidence)
    if gained is not None:
        return gained >= evidence.settings.rival_evidence
    blocks = block_samples(quiet, evidence, evidence.fitted)
    _, t = paired_gain(quiet.fit_residuals, loud.fit_residuals, blocks)
    return t >= evidence.settings.rival_t


def _gained(loud: Outcome, quiet: Outcome, evidence: Evidence) -> float | None:
    """By how much the squares of whitened residuals are fewer with loads as measured: twice the log of the odds."""
    total = 0.0
    for record, *pair in zip(evidence.fitted, quiet.fit_residuals, loud.fit_residuals, strict=True):
        known, rows = known_error(replace(record, weight=1.0), quiet), _side_by_side(pair)
        if known is None or len(rows) != len(known.stamps):
            return None
        white = load_error(rows[:, 0], known).innovations(rows)
        total += float((white[:, 0] ** 2).sum() - (white[:, 1] ** 2).sum())
    return total


def _side_by_side(residuals: Sequence) -> np.ndarray:
    return np.stack([residual.numpy() for residual in residuals], axis=1)
