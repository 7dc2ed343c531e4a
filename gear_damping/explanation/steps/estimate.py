"""Step 10: the figures, weighed by what is random in the records where nothing else is left."""

from dataclasses import replace

from gear_damping.explanation.state import State
from gear_damping.explanation.trials.efficient import efficient


def estimated(state: State) -> State:
    """The state with its model's parameters weighed by what is random; where more than that is left, as it was.

    Where nothing was added to it that is the nominal model. Beside causes this one keeps the figures that it has
    without anybody looking at the residuals.
    """
    if state.left is None or state.left.visible:
        return state
    outcome = efficient(state.outcome, state.left.random)
    return replace(state, outcome=outcome, nominal=outcome if state.outcome is state.nominal else state.nominal)
