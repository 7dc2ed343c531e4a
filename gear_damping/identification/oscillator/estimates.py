"""What a fit of the linear oscillator says, as quantities with intervals."""

from dataclasses import dataclass
from math import pi

from torch import Tensor

from gear_damping.identification.oscillator.linear_model import DAMPING, fitted_mass
from gear_damping.identification.output_error.least_squares import Fitted
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.uncertainty import covariance, interval
from gear_damping.physics.systems.traits import Trait

CORRELATED_PERIODS = 3.0  # characteristic times over which residuals may be correlated
PER_SECONDS = (" / s^2", " / s", "")  # from a displacement, a velocity and an acceleration to an acceleration


@dataclass(frozen=True)
class Estimate:
    """A quantity with its 95 % interval."""

    value: float
    interval95: tuple[float, float]
    unit: str


def estimates(problem: OutputErrorProblem, fitted: Fitted, scale: float) -> dict[str, Estimate]:
    """What a solution says, with 95 % intervals: parameters, damping ratio, frequency, decrement."""
    covariances = covariance(problem, fitted, CORRELATED_PERIODS * scale)
    place = {parameter.name: i for i, parameter in enumerate(problem.free)}
    system, mass = problem.model.system, fitted_mass(problem)
    stiffness, gain = system.spring, next(iter(system.gains.values()), "")

    def value(name: str, shared: Tensor) -> Tensor:
        if name not in place:
            return shared.new_tensor(problem.given[name])
        return problem.free[place[name]].value(shared[place[name]])

    def ratio(shared: Tensor) -> Tensor:
        return value(DAMPING, shared) / (2 * (value(stiffness, shared) * mass).sqrt())

    units = ("N*s/m", "N/m") if system.has(Trait.MASS) else ("1/s", "1/s^2")
    quantities = {"damping_coefficient": (lambda s: value(DAMPING, s), units[0])} if DAMPING in place else {}
    if stiffness in place:
        quantities[stiffness] = (lambda s: value(stiffness, s), units[1])
        quantities["natural_frequency_hz"] = (lambda s: (value(stiffness, s) / mass).sqrt() / (2 * pi), "Hz")
    if stiffness in place and DAMPING in place:
        quantities["damping_ratio_percent"] = (lambda s: 100 * ratio(s), "%")
        quantities["log_decrement"] = (lambda s: 2 * pi * ratio(s) / (1 - ratio(s) ** 2).sqrt(), "1")
    if gain in place:
        order = min(channel.derivatives for record in problem.records for channel in record.channels)
        quantities[gain] = (lambda s: value(gain, s), f"response unit / force unit{PER_SECONDS[order]}")
    found = {
        name: (interval(function, fitted.shared, covariances), unit) for name, (function, unit) in quantities.items()
    }
    return {name: Estimate(number, bounds, unit) for name, ((number, bounds), unit) in found.items()}
