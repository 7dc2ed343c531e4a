"""First guesses of a fit: how a record's motion begins, and where the zero of its channels lies."""

from collections.abc import Mapping, Sequence

import torch
from torch import Tensor

from gear_damping.identification.output_error.records import FitRecord, Observed
from gear_damping.physics.model import Model
from gear_damping.physics.systems.traits import Trait

TAIL = 0.25  # of a free decay: where it has come nearest to its rest


def static_deflection(model: Model, given: Mapping[str, object], records: Sequence[FitRecord]) -> Tensor:
    """Mean deflection of each record under its mean load, (records,); 0 for an oscillator."""
    values = model.values(len(records), **given)
    for name in {name for record in records for name in record.conditions} & values.keys():
        known = torch.tensor([r.conditions.get(name, torch.nan) for r in records], dtype=torch.float64)
        values[name] = torch.where(known.isnan(), values[name], known)
    derived = model.prepare(values).derived
    found = derived["mean_load"] / derived["mean_stiffness"]
    return torch.where(found.isfinite(), found, torch.zeros_like(found))


def first_offset(
    segments: Sequence[FitRecord], channel: Observed, static: float, parts: bool = False
) -> tuple[float, float]:
    """A first guess of a channel's zero, and what counts as a step of order one.

    Args:
        segments: Of one record.
        channel: The channel.
        static: Where its load holds it, in m or the rig's own unit.
        parts: Whether the flanks may part: flights go far to one side, and the mean with them; the median stays near
            where the load holds the teeth, as long as they touch for most of the time.
    """
    values = torch.cat([_samples(record, channel.name) for record in segments])
    deviation = float(values.std().clamp(min=1e-300))
    if channel.derivatives:
        return float(values.mean()), deviation
    decays = channel.name == "displacement" and not segments[0].inputs
    rest = values[-max(2, round(TAIL * len(values))) :] if decays else values
    return float(rest.median() if parts else rest.mean()) - static, deviation


def first_motion(record: FitRecord, offset: float, static: float, factor: float = 1.0) -> tuple[Tensor, Tensor]:
    """Displacement and velocity at the start of a record, (2,), and the scale of either.

    From a rate or an acceleration by integration: the mean of a displacement that was not recorded is not known. A rate
    whose zero is known is that of the motion, its mean included: what coasts has one.

    Args:
        record: The record.
        offset: The zero of its first channel.
        static: Where its load holds it, in m or the rig's own unit.
        factor: What that channel shows of the motion (`participation`).
    """
    place = record.shown_motion / factor + static if record.observed.derivatives else record.response - offset
    rate = place.diff() * record.sampling_rate
    if record.observed.derivatives == 1 and not record.observed.offset:
        rate = record.response / factor
    scale = torch.stack([place.std().clamp(min=1e-300), rate.std().clamp(min=1e-300)])
    return torch.stack([place[0], rate[0]]), scale


def participation(channel: Observed, model: Model, given: Mapping[str, object]) -> float:
    """What a channel shows of the motion, as a factor on it: of a shaft, its share of the relative motion.

    Args:
        channel: The channel.
        model: The simulator.
        given: Its known values by flat name, in SI.
    """
    if not model.system.has(Trait.SHAFTS) or not channel.derivatives:
        return 1.0
    values = model.values(1, **given)
    derived = model.prepare(values).derived
    shaft = channel.shaft or channel.name.partition("_")[0]
    sign = 1.0 if shaft == "pinion" else -1.0
    share = derived[f"base_radius_{shaft}"] * derived["equivalent_mass"] / values[f"inertia_{shaft}"]
    return sign * float(share[0]) * (channel.radius or 1.0)


def _samples(record: FitRecord, name: str) -> Tensor:
    listed = ((record.observed, record.response), *record.others)
    return next(values for channel, values in listed if channel.name == name)
