"""The natural frequency that follows from what a file states of its rig, before anything was fitted."""

from math import pi, sqrt

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.nominal_gear_pair import stated_mesh_frequency
from gear_damping.identification.oscillator.linear_model import mass_of
from gear_damping.physics.systems.traits import Trait, by_trait


def stated_frequency(evidence: Evidence) -> float | None:
    """In Hz; None where nothing is stated that it follows from."""
    return by_trait(evidence.base, FREQUENCIES, "stated natural frequency")(evidence)


def _of_a_spring(evidence: Evidence) -> float | None:
    stiffness = evidence.parameters.get(evidence.base.spring)
    return None if stiffness is None else sqrt(stiffness / mass_of(evidence.known)) / (2 * pi)


FREQUENCIES = {Trait.TEETH: stated_mesh_frequency, Trait.REST: _of_a_spring}
