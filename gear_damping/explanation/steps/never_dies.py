"""A motion that something drives which no channel holds is no ring-down, whatever a search makes of it."""

from gear_damping.explanation.state import State
from gear_damping.identification.damping_estimate import UndyingMotion, UnsuitedRecord
from gear_damping.identification.free_vibration import free_vibration
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.terms import ExtraStates


def never_dies(state: State) -> str:
    """A sentence where fitted records without an input are lost and do not die away, else nothing.

    The nominal model follows a ring-down from its start; it is begun anew in segments where it loses one.

    Args:
        state: Where the search ended.
    """
    evidence = state.bench.evidence
    is_cut = bool(evidence.segments) and not evidence.stated_segments and evidence.has_spring
    beats = any(isinstance(cause.effect, ExtraStates) for cause in state.accepted)  # and swells between them
    if beats or not is_cut or not all(map(_goes_on, evidence.fit)):
        return ""
    return (
        "The motion does not die away, and no channel holds what drives it: the search takes it for ring-downs, and "
        "its damping tells nothing. Declare the force; where that is a random load, `task=identify "
        "model=ambient_spectrum` tells the damping."
    )


def _goes_on(record: FitRecord) -> bool:
    """Whether a record has no input and its motion does not die away."""
    if record.inputs:
        return False
    try:
        free_vibration(record)
    except UnsuitedRecord as said:
        return isinstance(said, UndyingMotion)
    return False
