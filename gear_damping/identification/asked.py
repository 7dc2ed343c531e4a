"""What a trained network says of many whole records at once."""

import torch
from torch import Tensor

from gear_damping.identification.known_model.estimate import LEVEL, Estimates
from gear_damping.identification.lightning_module import DampingModule

STRIDE = 15  # samples between the windows of a record that are asked about
AT_ONCE = 250  # records, whose windows are held together


@torch.inference_mode()
def estimates_of(module: DampingModule, records: Tensor) -> Estimates:
    """The damping ratio of every record in %: of a network of windows their mean, without an interval.

    Args:
        module: The network; its rate and unit are those of the records.
        records: (records, time), at least as long as the network sees at once.
    """
    parts, window = records.float().split(AT_ONCE), module.data["window"]
    if module.network.is_likelihood:
        said = [module.network.distribution(module.front_end(part[:, :window])) for part in parts]
        ratio, deviation = (torch.cat(column) for column in zip(*said, strict=True))
        return Estimates(ratio, *module.network.interval(ratio, deviation, LEVEL))
    each = [module(part.unfold(1, window, STRIDE).reshape(-1, window)).reshape(len(part), -1) for part in parts]
    return Estimates.without_interval(torch.cat(each).mean(1))
