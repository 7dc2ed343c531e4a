"""Which shaft carries one tooth that stands out, and whether a shaft's pattern is there at all."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import ttest_1samp

from gear_damping.explanation.casing.cycles import SHAFTS, Patterns, series
from gear_damping.explanation.casing.localised import DRAWS, RUNOUT, Localised, localised

Array = NDArray[np.float64]
SUSPECT = 0.05  # chance below which a pattern of the gear is looked at again as one of the pinion
FLIPS = 2000  # draws of signs: p down to 1 in 2000
FEWEST_GEAR_TURNS = 2.5  # fewer do not tell the patterns of the two shafts apart


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
    the gear as well. The gear is then judged by what the pinion cannot make, and where it is suspect, a burst of the
    pinion must be there in each of the turns that it makes within one of the gear.
    """
    z1, z2 = found.teeth
    result: dict[str, Localised | None] = dict.fromkeys(SHAFTS)
    if found.cycles / z2 >= FEWEST_GEAR_TURNS and z1 != z2:
        result["gear"] = localised(found.gear, z2, draws, seed=1)
    gear = result["gear"]
    if z2 % z1 == 0 and gear is not None and gear.p < SUSPECT:
        whole = series(found.gear, z2) + np.tile(series(found.pinion, z1), (z2 // z1, 1))
        gear = result["gear"] = _strongest(whole, gear, z1)
        result["pinion"] = _in_every_turn(whole, gear, z1, draws)
    else:
        own = _own(found.teeth) if z2 % z1 else np.ones(z1 // 2)
        result["pinion"] = localised(found.pinion * own[:, None], z1, draws)
    for shaft, one in result.items():
        if one is not None:
            result[shaft] = replace(one, p=max(one.p, repeated(found, shaft, one)))
    return result


def _own(teeth: tuple[int, int]) -> NDArray[np.bool_]:
    """Tooth frequencies of the pinion that are none of the gear's."""
    frequency = np.arange(1, teeth[0] // 2 + 1)
    return (frequency * teeth[1]) % teeth[0] != 0


def _strongest(whole: Array, gear: Localised, z1: int) -> Localised:
    """The gear's place among those that are turns of the pinion apart, where all that repeats is strongest."""
    z2, samples = whole.shape
    window = np.arange(round(gear.window * samples))
    places = [(gear.tooth + turn * z1) % z2 for turn in range(z2 // z1)]
    energy = [np.sum(whole.ravel()[(round(place * samples) + window) % whole.size] ** 2) for place in places]
    return replace(gear, tooth=places[int(np.argmax(energy))])


def _in_every_turn(whole: Array, gear: Localised, z1: int, draws: int) -> Localised | None:
    """The test of the pinion in each of its turns within one of the gear; the least certain of them counts."""
    begin = round(gear.tooth) - z1 // 2  # the gear's burst in the middle of a turn
    tests = []
    for turn in np.roll(whole, -begin, axis=0).reshape(-1, z1, whole.shape[1]):
        spectrum = np.fft.rfft(turn, axis=0)[1:] * (2 / z1)
        if z1 % 2 == 0:
            spectrum[-1] /= 2
        tests.append(localised(spectrum, z1, draws))
    if any(test is None for test in tests):
        return None
    worst = max(tests, key=lambda test: test.p)
    return replace(worst, tooth=(worst.tooth + begin) % z1)


def turns_of(found: Patterns, shaft: str) -> Array:
    """(turn, tooth, t) whole turns of a shaft: its pattern without runout, and what is not synchronous."""
    teeth = found.teeth[SHAFTS.index(shaft)]
    own = found.asynchronous + series(found.shaft(shaft), teeth, RUNOUT + 1)[found.number % teeth]
    turns = len(own) // teeth
    return own[: turns * teeth].reshape(turns, teeth, -1)


def repeated(found: Patterns, shaft: str, one: Localised) -> float:
    """Probability that what stands out is no more than single impacts: it must be common to the turns.

    Each turn's window is compared with the mean of the other turns' windows; a single impact has nothing in common.
    """
    turns = turns_of(found, shaft)
    count, teeth, samples = turns.shape
    if count < 3:
        return 1.0
    begin = round((one.tooth - found.first) % teeth * samples)
    window = (begin + np.arange(round(one.window * samples))) % (teeth * samples)
    own = turns.reshape(count, -1)[:, window]
    others = (own.sum(0) - own) / (count - 1)
    return float(ttest_1samp((own * others).sum(1), 0.0, alternative="greater").pvalue)


def presence(found: Patterns, shaft: str) -> Presence | None:
    """Compare the pattern of a shaft with what chance makes of the same turns with random signs."""
    place = SHAFTS.index(shaft)
    teeth = found.teeth[place]
    turns = found.cycles // teeth
    if turns < 3:
        return None
    own = turns_of(found, shaft).reshape(turns, -1)
    own = own - own.mean(1, keepdims=True)
    gram = own @ own.T
    signs = np.random.default_rng(2).choice([-1.0, 1.0], (FLIPS, turns))
    drawn = np.einsum("ij,jk,ik->i", signs, gram, signs)
    whole = float(gram.sum())
    p = (1 + int(np.sum(drawn >= whole))) / (1 + FLIPS)
    return Presence(whole / float(drawn.mean()), max(p, 2.0 ** (1 - turns)), turns)
