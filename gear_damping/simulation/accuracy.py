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
ALLOWED = (1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64, 96, 128, 192, 256)


def substeps_for(accuracy: float, prepared: Prepared, interval: Tensor, intervals: int) -> Tensor:
    """Sub-steps per output interval, from each member's own parameters alone; shape (batch,).

    Args:
        accuracy: Relative L2 error asked.
        prepared: The members in natural units.
        interval: Natural time between outputs, (batch,).
        intervals: Output intervals of a run.
    """
    whole = (interval * intervals).clamp(min=10.0)
    radians = torch.minimum(whole, FORGETTING * (whole / FORGETTING) ** GROWTH)
    step = (accuracy / (CONSTANT * radians)) ** (1 / ORDER)
    step = step.clamp(max=(accuracy / CORNER) ** (1 / CORNER_ORDER))
    wanted = fastest_rate(prepared) * prepared.refinement * interval / step
    allowed = torch.tensor(ALLOWED, dtype=wanted.dtype, device=wanted.device)
    return allowed[torch.searchsorted(allowed, wanted.clamp(max=ALLOWED[-1]))].long()


def fastest_rate(prepared: Prepared) -> Tensor:
    """The fastest angular rate that a step must resolve, natural units, (batch,).

    The natural frequency is 1 in natural units; a term that brings a faster one says so with a value
    called `fastest_rate`.
    """
    rate = torch.ones_like(prepared.base["equivalent_mass"])
    for values in prepared.terms.values():
        if "fastest_rate" in values:
            rate = torch.maximum(rate, values["fastest_rate"])
    return rate
