"""A motion that something drives which no channel holds is no ring-down, whatever a search makes of it."""

from gear_damping.explanation.evidence.records import is_begun_anew
from gear_damping.explanation.model.gives_back import gives_back
from gear_damping.explanation.state import State
from gear_damping.identification.free_vibration import never_falls


def never_dies(state: State) -> str:
    """A sentence where fitted records without an input are lost and do not die away, else nothing.

    The nominal model follows a ring-down from its start; it is begun anew in segments where it loses one.

    Args:
        state: Where the search ended.
    """
    evidence = state.bench.evidence
    if not is_begun_anew(evidence) or not all(map(never_falls, evidence.fit)):
        return ""
    if any(gives_back(cause.effect, state.outcome, evidence) for cause in state.accepted):  # it beats
        return ""
    return (
        "The motion does not die away, and no channel holds what drives it: the search takes it for ring-downs, and "
        "its damping tells nothing. Declare the force; where that is a random load, `task=identify "
        "model=ambient_spectrum` tells the damping."
    )
