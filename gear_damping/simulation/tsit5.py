"""One step of the fifth-order method of Tsitouras (2011), Computers & Mathematics with Applications 62."""

from collections.abc import Callable

from torch import Tensor

Rates = Callable[[Tensor, Tensor], Tensor]

# when each slope is taken, of the step (Tsitouras 2011)
NODES = (0.0, 0.161, 0.327, 0.9, 0.9800255409045097, 1.0)
# of the slopes before it, that each is taken at
STAGES = (
    (),
    (0.161,),
    (-0.008480655492356989, 0.335480655492357),
    (2.8971530571054935, -6.359448489975075, 4.3622954328695815),
    (5.325864828439257, -11.748883564062828, 7.4955393428898365, -0.09249506636175525),
    (5.86145544294642, -12.92096931784711, 8.159367898576159, -0.071584973281401, -0.028269050394068383),
)
# of all slopes, in the step
WEIGHTS = (
    0.09646076681806523,
    0.01,
    0.4798896504144996,
    1.379008574103742,
    -3.290069515436081,
    2.324710524099774,
)
ORDER = 5  # of the error over a record; that of one step is one higher


def step(rates: Rates, state: Tensor, start: Tensor, length: Tensor) -> tuple[Tensor, Tensor]:
    """The state after a step and the rate at its start.

    Args:
        rates: Rate of the state (n_state, batch) at a position (batch,).
        state: State at the start, (n_state, batch).
        start: Position of the start, (batch,).
        length: Length of the step, (batch,).
    """
    slopes: list[Tensor] = []
    for node, weights in zip(NODES, STAGES, strict=True):
        inner = state if not weights else state + length * _combine(weights, slopes)
        slopes.append(rates(start + node * length, inner))
    return state + length * _combine(WEIGHTS, slopes), slopes[0]


def _combine(weights: tuple[float, ...], slopes: list[Tensor]) -> Tensor:
    total = weights[0] * slopes[0]
    for weight, slope in zip(weights[1:], slopes[1:], strict=True):
        total = total + weight * slope
    return total
