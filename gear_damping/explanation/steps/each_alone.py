"""Records that one model follows one by one and not together are told with the figures of each."""

from gear_damping.explanation.evidence.records import is_begun_anew
from gear_damping.explanation.state import State
from gear_damping.explanation.trials.levels_alone import alone_beside
from gear_damping.identification.oscillator.each_alone import said_of_each
from gear_damping.physics.systems.traits import Trait


def followed_one_by_one(state: State) -> str:
    """A sentence where a linear model of its own follows every record, and no cause was found, else nothing.

    Parts of one record are of one rig: of a swing that dies away each has a frequency of its own as its law is none.

    Args:
        state: Where the search ended.
    """
    evidence = state.bench.evidence
    if len({record.record for record in evidence.fit}) == 1:
        return ""
    if state.accepted or not is_begun_anew(evidence) or not evidence.has(Trait.REST):
        return ""
    alone = alone_beside(state.nominal, evidence, state.bench.solver)
    if not alone:
        return ""
    return (
        f"A linear model of its own follows each record: {said_of_each(alone)}. They may not be of one rig, or of one "
        "state of it: a mass, a tension or the mounting changed between them. Explain those of one state alone."
    )
