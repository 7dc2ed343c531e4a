"""The linear oscillator that a model is on average."""

from gear_damping.explanation.model.hypothesis import Outcome


def linear_of(outcome: Outcome) -> tuple[float, float, float]:
    """Mass, damping coefficient and stiffness of a fitted model on average."""
    model, given = outcome.hypothesis.model, outcome.flat_given()
    derived = model.prepare(model.values(1, **given)).derived
    damping = float(given.get("viscous_damping.damping_coefficient", 0.0))
    return float(derived["equivalent_mass"][0]), damping, float(derived["mean_stiffness"][0])
