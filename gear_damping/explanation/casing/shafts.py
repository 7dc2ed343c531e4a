"""Which shaft carries one tooth that stands out, and whether a shaft's pattern is there at all."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gear_damping.explanation.casing.cycles import SHAFTS, Patterns, series
from gear_damping.explanation.casing.localised import DRAWS, RUNOUT, Localised, localised

Array = NDArray[np.float64]
FLIPS = 2000
FEWEST_GEAR_TURNS = 2.5  # fewer do not tell the patterns of the two shafts apart
BURST = 2  # mesh periods that a burst may last where it is taken out


@dataclass(frozen=True)
class Presence:
    """Whether what repeats with a shaft is more than chance.

    Args:
        ratio: Energy of the pattern over its mean where the signs of whole turns are drawn at random.
        p: Probability of that ratio or more by chance.
        turns: Whole turns of the shaft.
    """

    ratio: float
    p: float
    turns: int


def one_tooth(found: Patterns, draws: int = DRAWS) -> dict[str, Localised | None]:
    """The test of either shaft; None where the record does not let it be made.

    Where the gear turns once in a whole number of turns of the pinion, all that repeats with the pinion repeats with
    the gear as well. The gear is then judged by what the pinion cannot make, and its burst is taken out first.
    """
    z1, z2 = found.teeth
    result: dict[str, Localised | None] = dict.fromkeys(SHAFTS)
    if found.cycles / z2 >= FEWEST_GEAR_TURNS and z1 != z2:
        result["gear"] = localised(found.gear, z2, draws, seed=1)
    pinion = found.pinion
    if z2 % z1 == 0 and z1 != z2 and result["gear"] is not None and result["gear"].p < 0.05:
        pinion = _without_burst(found, result["gear"])
    elif z2 % z1:
        pinion = pinion * _own(found.teeth)[:, None]
    result["pinion"] = localised(pinion, z1, draws)
    return result


def _own(teeth: tuple[int, int]) -> NDArray[np.bool_]:
    """Tooth frequencies of the pinion that are none of the gear's."""
    frequency = np.arange(1, teeth[0] // 2 + 1)
    return (frequency * teeth[1]) % teeth[0] != 0


def _without_burst(found: Patterns, gear: Localised) -> NDArray[np.complex128]:
    """The pinion's pattern less what one tooth of the gear brings into it, once in z2 / z1 turns."""
    z1, z2 = found.teeth
    per = z2 // z1
    seen = series(found.gear, z2).ravel()  # what is left of a burst where its mean over the turns is taken out
    samples = len(seen) // z2
    begin = int((gear.tooth - 0.25) * samples)
    window = np.arange(begin, begin + int(BURST * samples))
    burst = np.zeros(z1 * samples)
    burst[window % len(burst)] = seen[window % len(seen)] / (1 - 1 / per) / per
    spectrum = np.fft.rfft(burst.reshape(z1, samples), axis=0)[1:] * (2 / z1)
    if z1 % 2 == 0:
        spectrum[-1] /= 2
    return found.pinion - spectrum


def presence(found: Patterns, shaft: str) -> Presence | None:
    """Compare the pattern of a shaft with what chance makes of the same turns with random signs."""
    place = SHAFTS.index(shaft)
    teeth = found.teeth[place]
    turns = found.cycles // teeth
    if turns < 3:
        return None
    number = np.arange(turns * teeth)
    pattern = series(found.shaft(shaft), teeth, RUNOUT + 1)
    own = found.rest[: len(number)] + pattern[number % teeth]
    own = own.reshape(turns, -1)
    own = own - own.mean(1, keepdims=True)
    gram = own @ own.T
    signs = np.random.default_rng(2).choice([-1.0, 1.0], (FLIPS, turns))
    drawn = np.einsum("ij,jk,ik->i", signs, gram, signs)
    whole = float(gram.sum())
    p = (1 + int(np.sum(drawn >= whole))) / (1 + FLIPS)
    return Presence(whole / float(drawn.mean()), max(p, 2.0 ** (1 - turns)), turns)
