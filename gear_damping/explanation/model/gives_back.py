"""What takes energy from the first mode and gives it back within a record: no line, and no law of one mode, does."""

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome, natural_frequency_hz
from gear_damping.explanation.model.rig import swells_again
from gear_damping.physics.terms import Effect, ExtraStates


def takes_and_gives(kind: type[Effect]) -> bool:
    """Whether an effect can do so at all: a second mode does, and the memory of a hysteresis does not."""
    return issubclass(kind, ExtraStates) and kind.exchange_time is not ExtraStates.exchange_time


def gives_back(effect: Effect, outcome: Outcome, evidence: Evidence) -> bool:
    """Whether an effect of a fitted model does so, by its fitted parameters, and the motion shows it."""
    if not isinstance(effect, ExtraStates):
        return False
    natural = natural_frequency_hz(outcome.hypothesis.model, outcome.flat_given())
    is_soon = effect.exchange_time(outcome.values_of(effect.name), natural) <= evidence.duration
    return is_soon and any(swells_again(record, natural) for record in evidence.fit)
