"""Records that one model follows one by one and not together are told with the figures of each."""

from gear_damping.explanation.evidence.records import is_begun_anew
from gear_damping.explanation.state import State
from gear_damping.explanation.trials.levels_alone import alone_beside
from gear_damping.identification.oscillator.each_alone import LEAVES, said_of_each
from gear_damping.physics.systems.traits import Trait

HARDLY_ANY = 0.1  # of what one model misses, which is small: no law that they have in common would leave as little


def followed_one_by_one(state: State) -> str:
    """A sentence where a linear model of its own follows every record, one for all loses some, and no cause was found.

    Args:
        state: Where the search stands.
    """
    return _said(state, LEAVES) if is_begun_anew(state.bench.evidence) else ""


def of_each_record(state: State) -> str:
    """The same, also where one model loses none, but leaves more than the sensor makes and single ones hardly any.

    Args:
        state: Where the search ended.
    """
    if said := followed_one_by_one(state):
        return said
    is_more = state.beyond_sensor(state.nominal).misfit > state.bench.settings.small_misfit
    return _said(state, HARDLY_ANY) if is_more and state.bench.evidence.has_spring else ""


def _said(state: State, leaves: float) -> str:
    """The sentence, where models of single records leave so much of what one of all leaves at most.

    Parts of one record are of one rig: of a swing that dies away each has a frequency of its own as its law is none.
    """
    evidence = state.bench.evidence
    if state.accepted or not evidence.has(Trait.REST) or len({record.record for record in evidence.fit}) == 1:
        return ""
    alone = alone_beside(state.nominal, evidence, state.bench.solver, leaves)
    if not alone:
        return ""
    return (
        f"A linear model of its own follows each record: {said_of_each(alone)}. They may not be of one rig, or of one "
        "state of it: a mass, a tension or the mounting changed between them. Explain those of one state alone."
    )
