"""A damping ratio that stands in a configuration: the coefficient of its law that follows from it."""

from gear_damping.config.simulator import SimulatorSettings
from gear_damping.errors import InputError, Problem
from gear_damping.simulation.prior import DAMPING_RATIO, coefficients_for
from gear_damping.simulation.runs import reference_velocity

Given = dict[str, float | tuple[float, ...]]


def at_its_ratio(settings: SimulatorSettings) -> Given:
    """What the simulator was given, with what its damping ratio makes of the parameters of the law that carries it.

    Raises:
        InputError: no effect carries the ratio, or none of its coefficients has it.
    """
    return settings.given | _following(settings)


def refuse_both(settings: SimulatorSettings, source: str) -> None:
    """Refuse a coefficient that was given beside the damping ratio that decides it.

    Args:
        settings: What was read.
        source: Where it was read from, for messages.

    Raises:
        InputError: both are given.
    """
    rule, remedy = f"is given beside {DAMPING_RATIO}, which decides it", "keep one of the two"
    both = [name for name in _following(settings) if name in settings.given]
    if both:
        raise InputError([Problem(f"simulator.{name}", rule, settings.given[name], remedy, source) for name in both])


def _following(settings: SimulatorSettings) -> Given:
    """The parameters that follow from the ratio; none where none was asked for."""
    model, ratio, law = settings.model, settings.damping_ratio_percent, settings.damping_law
    if ratio is None:
        return {}
    if law is None:
        laws = " or ".join(effect.name for effect in model.damping_laws)
        remedy = f"give damping_law: {laws}" if laws else "switch one on, for example viscous_damping: {}"
        raise InputError(Problem(f"simulator.{DAMPING_RATIO}", "no effect carries a damping ratio", ratio, remedy))
    values = model.values(1, **settings.given)
    velocity = reference_velocity(model.prepare(values).derived)
    found = coefficients_for(model, values, law, velocity.new_full((1,), ratio / 100), velocity)
    return {name: float(value) for name, value in found.items()}
