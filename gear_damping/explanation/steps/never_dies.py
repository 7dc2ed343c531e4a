"""A motion that something drives which no channel holds is no ring-down, whatever a search makes of it."""

from gear_damping.explanation.state import State
from gear_damping.identification.free_vibration import never_falls
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
    if beats or not is_cut or not all(map(never_falls, evidence.fit)):
        return ""
    return (
        "The motion does not die away, and no channel holds what drives it: the search takes it for ring-downs, and "
        "its damping tells nothing. Declare the force; where that is a random load, `task=identify "
        "model=ambient_spectrum` tells the damping."
    )
