"""What changed between the reference records of a casing and the others.

Each record is cut into blocks of whole turns. A level (mesh, pattern of a shaft, rest) has one value a block, and two
records differ where Welch's test on those values says so: the blocks carry the scatter of speed and load. It counts
as a change of the gears only from a factor of two on (6 dB, the step of machinery diagnostics), because the path and
the load make smaller ones.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import ttest_ind

from gear_damping.explanation.casing.averages import by_revolution
from gear_damping.explanation.casing.cycles import Patterns, series
from gear_damping.explanation.casing.localised import RUNOUT
from gear_damping.explanation.casing.shafts import turns_of
from gear_damping.explanation.casing.study import Study

Array = NDArray[np.float64]
BLOCKS = 8  # stretches of a record, each long against what its turns have in common
FACTOR = 2.0  # of an amplitude, 6 dB: less is what mounting and temperature do
SAME_SPEED = 0.03  # relative; a path is another one at another speed
AT_MESH, PINION, GEAR, ASYNCHRONOUS = (
    "at the mesh", "once per turn of the pinion", "once per turn of the gear", "asynchronous",
)  # fmt: skip


@dataclass(frozen=True)
class Change:
    """A level beside its reference.

    Args:
        what: In words.
        family: Which family it belongs to.
        record: The record.
        reference: Level of the reference.
        now: Level of the record.
        unit: Of both.
        p: Probability of such a difference between blocks of the same level.
        factor: now / reference.
    """

    what: str
    family: str
    record: str
    reference: float
    now: float
    unit: str
    p: float
    factor: float


def changes(study: Study, references: Sequence[Study]) -> list[Change]:
    """The levels of a record beside those of its references."""
    found = []
    for what, family, level, power in _LEVELS:
        now = _blocks(level(study))
        before = np.concatenate([_blocks(level(one)) for one in references])
        if len(now) < 3 or len(before) < 3:
            continue
        root = (lambda v: float(np.sqrt(max(v, 0.0)))) if power else float
        least = float(before.std() / np.sqrt(len(before)))
        old, new = root(before.mean()), root(now.mean())
        p = float(ttest_ind(now, before, equal_var=False).pvalue)
        factor = new / max(old, root(least), 1e-300)
        found.append(Change(what, family, study.heard.name, old, new, study.heard.unit if power else "1", p, factor))
    return found


def at_one_speed(study: Study, references: Sequence[Study]) -> bool:
    """Whether the references turn as fast as the record."""
    return all(abs(study.heard.speed / one.heard.speed - 1) <= SAME_SPEED for one in references)


def na4(study: Study, references: Sequence[Study], shaft: str) -> float:
    """Fourth moment of a shaft's residual over the square of the references' second."""
    own = _residual(study.plain, shaft)
    square = np.mean([np.mean(_residual(one.plain, shaft) ** 2) for one in references])
    return float(np.mean(own**4) / square**2)


def _residual(found: Patterns, shaft: str) -> Array:
    return series(found.shaft(shaft), found.teeth[shaft == "gear"], RUNOUT + 1).ravel()


def _blocks(values: Array) -> Array:
    """Means of up to `BLOCKS` stretches of turns."""
    return np.array([part.mean() for part in np.array_split(values, min(BLOCKS, len(values)))])


def _mesh(study: Study) -> Array:
    """(turn,) mean square of the mesh's own cycle."""
    return _mean_square(_turns(study.plain.cut, study.heard.teeth[0]).mean(1))


def _asynchronous(study: Study) -> Array:
    return _mean_square(_turns(study.plain.asynchronous, study.heard.teeth[0]))


def _kurtosis(study: Study) -> Array:
    return by_revolution(study.sharp)[0]


def _pattern(shaft: str) -> Callable[[Study], Array]:
    def level(study: Study) -> Array:
        """(turn,) power of the pattern that a turn shares with all others: chance has none on the average."""
        turns = turns_of(study.plain, shaft)
        turns = turns.reshape(len(turns), -1)
        if len(turns) < 2:
            return np.zeros(len(turns))
        others = (turns.sum(0) - turns) / (len(turns) - 1)
        return (turns * others).mean(1)

    return level


def _turns(cut: Array, teeth: int) -> Array:
    """(turn, tooth, t)."""
    turns = len(cut) // teeth
    return cut[: turns * teeth].reshape(turns, teeth, -1)


def _mean_square(values: Array) -> Array:
    values = values.reshape(len(values), -1)
    return (values**2).mean(1)


_LEVELS = (
    ("level of the mesh", AT_MESH, _mesh, True),
    ("pattern of the pinion's teeth", PINION, _pattern("pinion"), True),
    ("pattern of the gear's teeth", GEAR, _pattern("gear"), True),
    ("what is not synchronous", ASYNCHRONOUS, _asynchronous, True),
    ("kurtosis by revolution", ASYNCHRONOUS, _kurtosis, False),
)
