"""Is the pattern of a shaft one tooth that stands out, or the usual spread over all of its teeth?

Errors of sound teeth differ from tooth to tooth without order, whatever the path makes of each of them: the phases
of their tooth frequencies are random, and one phase is common to all samples of a cycle. Drawn anew, those phases
give patterns that the same gears might have had. What counts is the share of the pattern's energy that falls into
one window of the turn; runout (the first tooth frequencies) is left out.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

RUNOUT = 2  # tooth frequencies up to this are runout and its first harmonic
BLOCKS = 4  # parts of a cycle between which a window may begin
WINDOWS = (2, 4, 8)  # blocks: half a mesh period, one, two
COMPONENTS = 4  # principal components of each block
DRAWS = 2000  # of chance; the smallest probability that they tell is 1 in 2000
_CHUNK = 250  # draws at once: some MB


@dataclass(frozen=True)
class Localised:
    """How far one place in the turn stands out.

    Args:
        p: Probability of a share this high or higher in sound gears, over all windows.
        share: Share of the energy in the window that stands out most.
        usual: Its median in sound gears.
        limit: Its 99 % point in sound gears.
        window: Length of that window in mesh periods.
        tooth: Where it begins, in mesh periods after the zero of the angle.
    """

    p: float
    share: float
    usual: float
    limit: float
    window: float
    tooth: float


def localised(pattern: NDArray[np.complex128], teeth: int, draws: int = DRAWS, seed: int = 0) -> Localised | None:
    """Test a pattern (teeth // 2, t) of complex tooth frequencies; None where too few of them are known."""
    used = pattern.copy()
    used[:RUNOUT] = 0
    present = np.abs(used).sum(1) > 0
    if present.sum() < 3:
        return None
    blocks = _components(used, teeth)
    rng = np.random.default_rng(seed)
    own = _shares(blocks[None], teeth)  # (1, window, place)
    drawn = []
    for _ in range(0, draws, _CHUNK):
        phase = np.exp(2j * np.pi * rng.random((_CHUNK, len(used))))
        if teeth % 2 == 0:
            phase[:, -1] = np.sign(phase[:, -1].real)
        drawn.append(_shares(blocks[None] * phase[:, :, None, None], teeth).max(2))
    return _judged(own[0], np.concatenate(drawn))


def _components(pattern: NDArray, teeth: int) -> NDArray[np.complex128]:
    """(teeth // 2, block, component): the same energies in few numbers; drawing phases does not change them."""
    parts = []
    for part in np.array_split(pattern, BLOCKS, axis=1):
        turned = np.linalg.eigh((part.conj().T @ part).real)[1][:, -COMPONENTS:]
        kept = part @ turned
        parts.append(np.pad(kept, ((0, 0), (0, COMPONENTS - kept.shape[1]))))
    return np.stack(parts, 1)


def _shares(blocks: NDArray, teeth: int) -> NDArray[np.float64]:
    """(draw, window, place): share of the energy in windows that begin at each block of the turn."""
    full = np.zeros((len(blocks), teeth // 2 + 1, *blocks.shape[2:]), complex)
    full[:, 1:] = blocks
    if teeth % 2 == 0:
        full[:, -1] *= 2  # it has no mirror image
    series = np.fft.irfft(full, teeth, axis=1)
    energy = (series**2).sum(3).reshape(len(blocks), -1)
    total = energy.sum(1, keepdims=True)
    padded = np.concatenate([np.zeros((len(blocks), 1)), np.cumsum(np.tile(energy, (1, 2)), 1)], 1)
    count = energy.shape[1]
    return np.stack([(padded[:, w : w + count] - padded[:, :count]) / total for w in WINDOWS], 1)


def _judged(own: NDArray, drawn: NDArray) -> Localised:
    """The window that is least likely, and how likely its like is in any window."""
    share = own.max(1)
    above = (drawn[:, :, None] >= share[None, :, None]).sum(0)[:, 0]
    rank = np.argsort(np.argsort(-drawn, axis=0), axis=0) + 1  # 1: the highest of the draws
    least = rank.min(1)
    window = int(above.argmin())
    p = (1 + np.sum(least <= above[window])) / (1 + len(drawn))
    return Localised(
        float(p), float(share[window]), float(np.median(drawn[:, window])), float(np.quantile(drawn[:, window], 0.99)),
        WINDOWS[window] / BLOCKS, float(own[window].argmax() / BLOCKS),
    )  # fmt: skip
