"""What any damping force takes in a cycle, whether it follows the rate, the deflection or what was before."""

from math import pi

import torch
from torch import Tensor

from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.model import Prepared
from gear_damping.physics.terms import DampingForce, ExtraStates, Values

INSTANTS = 1000  # of a cycle over which a loss is summed; a sign change of a hundredth of it has sixteen of them
MOST_INSTANTS = 20000  # of a cycle through which states are led; what yields in less of it is not summed
CYCLES = 5  # until a state of its own comes back to where it was; the last one counts

_TURNED = 3.0  # times the rate that is resolved in a simulation: one at which the midpoint rule is stable


def damping_coefficient(effect: DampingForce, prepared: Prepared, speed: Tensor) -> Tensor:
    """The viscous coefficient in N s/m that takes as much of a harmonic motion at the natural frequency, (batch,).

    c_eq = (1 / (pi V)) integral of F cos(phi) over a cycle of x' = V cos(phi), about the deflection of the mean load
    where there is one, the flanks in contact. Of a force with states of its own these are led through the motion by
    the midpoint rule, in so many steps that none yields more than once in one; nan of a member that needs too many.

    Args:
        effect: The force.
        prepared: The model, (batch,).
        speed: V, m/s, (batch,).
    """
    scales, derived, p = prepared.scales, prepared.derived, prepared.terms[effect.name]
    velocity, frequency = speed / scales.velocity, derived["natural_frequency"] * scales.time
    mean = torch.zeros_like(velocity)
    if "mean_load" in derived:
        mean = derived["mean_load"] / derived["mean_stiffness"] / scales.length
    with_states = isinstance(effect, ExtraStates)
    needed = _instants(velocity / frequency, p) if with_states else torch.full_like(velocity, INSTANTS)
    followed = needed <= MOST_INSTANTS
    if not bool(followed.any()):
        return torch.full_like(velocity, torch.nan)
    instants = int(needed[followed].max())
    step = 2 * pi / instants

    def moved(phase: float, extra: dict[str, Tensor]) -> Kinematics:
        angle = torch.full_like(velocity, phase)
        place, rate = mean + velocity / frequency * torch.sin(angle), velocity * torch.cos(angle)
        named = {f"{effect.name}.{name}": value for name, value in extra.items()}
        return Kinematics(angle, place, rate, named, delta=place, delta_rate=rate, deflection=place)

    extra = effect.initial(p, prepared.base) if with_states else {}
    first = (CYCLES - 1 if with_states else 0) * instants
    total = torch.zeros_like(velocity)
    for instant in range(first + instants):
        phase = step * instant
        middle = extra
        if with_states:
            middle = _after(effect, extra, effect.state_rates(moved(phase, extra), p), step / 2 / frequency)
        at = moved(phase + step / 2, middle)
        if instant >= first:
            total = total + effect.damping_force(at, p) * at.velocity / velocity
        if with_states:
            extra = _after(effect, extra, effect.state_rates(at, p), step / frequency)
    found = 2 * total / instants / velocity * scales.mass / scales.time
    return torch.where(followed, found, torch.nan)


def _instants(amplitude: Tensor, p: Values) -> Tensor:
    """Steps of a cycle of each amplitude, (batch,), where a state says how fast it follows the motion."""
    if "fastest_rate" not in p:
        return torch.full_like(amplitude, INSTANTS)
    turned = (_TURNED * 2 * pi * amplitude * p["fastest_rate"]).ceil().clamp(min=INSTANTS)
    return torch.where(turned.isfinite(), turned, torch.full_like(turned, INSTANTS))


def _after(effect: ExtraStates, extra: dict[str, Tensor], rates: dict[str, Tensor], time: Tensor) -> dict[str, Tensor]:
    return {name: extra[name] + time * rates[name] for name in effect.states}
