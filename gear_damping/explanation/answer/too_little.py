"""What would take most of so little that no cause is named, and what that would make of the damping."""

from gear_damping.explanation.answer.gain import damping_ratio
from gear_damping.explanation.model.ringing import told_covariance
from gear_damping.explanation.state import State

NAMES = "{} would take {:.0f} % of what is missing, too little of the signal for a name"
DAMPING = "; of the damping ratio, {:.3g} %, it would make {:.2g} %"


def takes_of_little(state: State) -> str:
    """What is said of causes where nothing is worth one; empty where there are none, or they take less than most.

    A friction that is a ten thousandth of the signal may be a tenth of its damping.

    Args:
        state: Where the search ended.
    """
    if not state.accepted:
        return ""
    share = state.share_between(state.nominal, state.outcome)
    if share < state.bench.settings.taken_by_one:
        return ""
    said = NAMES.format(" and ".join(f"`{cause.name}`" for cause in state.accepted), 100 * min(share, 1.0))
    found = damping_ratio(state.outcome, told_covariance(state.outcome, state.bench.evidence)) or {"by_law": {}}
    own = sum(found["by_law"].get(cause.name, 0.0) for cause in state.accepted)
    return f"{said}{DAMPING.format(found['value'], own)}." if own else f"{said}."
