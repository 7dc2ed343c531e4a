"""How many sub-steps a member needs for the accuracy that is asked."""

import torch
from torch import Tensor

from gear_damping.physics.model import Prepared
from gear_damping.simulation.tsit5 import ORDER

# Relative L2 error of a smooth trajectory = CONSTANT * (fastest rate * sub-step)^5 * radians, measured by
# step halving over the families of runs. Phase errors add up over a run until damping forgets them.
CONSTANT = 4e-5
FORGETTING, GROWTH = 300.0, 0.25  # natural radians after which the error grows by this power only
CORNER, CORNER_ORDER = 5.6e-4, 2.75  # the same where |v|^n bends at rest: error = CORNER * step^CORNER_ORDER
# sub-steps of an output interval: few values, so that runs of one number go together
ALLOWED = (1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64, 96, 128, 192, 256)


def substeps_for(accuracy: float, prepared: Prepared, interval: Tensor, intervals: int) -> Tensor:
    """Sub-steps per output interval, from each member's own parameters alone; shape (batch,).

    Args:
        accuracy: Relative L2 error asked.
        prepared: The members in natural units.
        interval: Natural time between outputs, (batch,).
        intervals: Output intervals of a run.
    """
    whole = (_turning_rate(prepared) * interval * intervals).clamp(min=10.0)
    radians = torch.minimum(whole, FORGETTING * (whole / FORGETTING) ** GROWTH)
    step = (accuracy / (CONSTANT * radians)) ** (1 / ORDER)
    step = step.clamp(max=(accuracy / CORNER) ** (1 / CORNER_ORDER))
    wanted = fastest_rate(prepared) * prepared.refinement * interval / step
    allowed = torch.tensor(ALLOWED, dtype=wanted.dtype, device=wanted.device)
    return allowed[torch.searchsorted(allowed, wanted.clamp(max=ALLOWED[-1]))].long()


def fastest_rate(prepared: Prepared) -> Tensor:
    """The fastest angular rate that a step must resolve, natural units, (batch,).

    That of the unit of time is 1, and so is the natural frequency where it gives that unit. A term that brings a
    faster rate says so with a value called `fastest_rate`.
    """
    rate = _turning_rate(prepared)
    for values in prepared.terms.values():
        if "fastest_rate" in values:
            rate = torch.maximum(rate, values["fastest_rate"])
    return rate


def _turning_rate(prepared: Prepared) -> Tensor:
    """The natural frequency, but at least 1; 1 where a stiffness below 0 has none."""
    frequency = prepared.base["natural_frequency"]
    return torch.where(frequency > 1, frequency, torch.ones_like(frequency))
