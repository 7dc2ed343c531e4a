"""The equivalent damping ratio of every damping law of a model, each at one velocity amplitude."""

from collections.abc import Mapping

import torch
from torch import Tensor

from gear_damping.physics.cycle_loss import damping_coefficient
from gear_damping.physics.model import Model, Prepared
from gear_damping.physics.terms import DampingForce, DampingLaw


def ratio_by_law(
    model: Model, values: Mapping[str, Tensor], prepared: Prepared, stiffness: Tensor, speed: Tensor
) -> dict[str, Tensor]:
    """Damping ratios, 1 where critical, (batch,) of each law by its name; empty without any.

    A law that states its ratio is asked for it. Dry friction, hysteresis and what grows with the deflection count with
    the viscous damping that takes as much of a harmonic motion of that velocity. What acts in a gap alone damps no
    contact, and is no law here.

    Args:
        model: With its effects.
        values: Its parameters, SI by flat name, (batch,) or (n, batch).
        prepared: The model with these values.
        stiffness: Mean linear stiffness, N/m, (batch,), of which a damping is critical.
        speed: Velocity amplitude, m/s, (batch,).
    """
    mass, found = prepared.derived["equivalent_mass"], {}
    for effect in counted_laws(model):
        if isinstance(effect, DampingLaw):
            found[effect.name] = stated_ratio(effect, values, mass, stiffness, speed)
        else:
            critical = 2 * torch.sqrt(stiffness * mass)
            found[effect.name] = damping_coefficient(effect, prepared, speed) / critical
    return found


def stated_ratio(
    law: DampingLaw, values: Mapping[str, Tensor], mass: Tensor, stiffness: Tensor, speed: Tensor
) -> Tensor:
    """The damping ratio that a law of a model states, 1 where critical, (batch,); arguments as before."""
    own = {p.name: values[f"{law.name}.{p.name}"] for p in law.parameters}
    return law.damping_ratio(own, mass, stiffness, speed)


def counted_laws(model: Model) -> tuple[DampingForce, ...]:
    """The damping forces of a model that have an equivalent damping ratio."""
    return tuple(effect for effect in model.effects if isinstance(effect, DampingForce) and not effect.requires)
