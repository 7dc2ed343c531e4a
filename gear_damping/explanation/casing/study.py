"""All that is looked at in one casing record."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gear_damping.explanation.casing import averages, orders
from gear_damping.explanation.casing.averages import Average, Modulation
from gear_damping.explanation.casing.cycles import SHAFTS, Patterns, patterns
from gear_damping.explanation.casing.heard import Heard
from gear_damping.explanation.casing.localised import Localised
from gear_damping.explanation.casing.orders import Asynchronous, Line
from gear_damping.explanation.casing.shafts import Presence, one_tooth, presence

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Study:
    """What was found in a record.

    Args:
        heard: The record.
        plain: Its parts in the unit of the acceleration.
        sharp: The same with the ringing of the path shortened.
        orders: (k,) orders of the pinion.
        amplitude: (k,) order spectrum.
        lines: The lines that have a name.
        one_tooth: By shaft: whether one tooth stands out; None where it cannot be said.
        presence: By shaft: whether its pattern is more than chance.
        asynchronous: The strongest line that belongs to no shaft.
        averages: Synchronous averages by shaft, of `sharp`.
        modulation: Of the strongest mesh harmonic, by shaft.
        kurtosis: (turn,) of each turn of the pinion, of `sharp`.
        kurtosis_limit: Its 99 % point in noise.
        envelope: Relative amplitude of the squared envelope at the shafts' orders.
    """

    heard: Heard
    plain: Patterns
    sharp: Patterns
    orders: Array
    amplitude: Array
    lines: list[Line]
    one_tooth: dict[str, Localised | None]
    presence: dict[str, Presence | None]
    asynchronous: Asynchronous | None
    averages: dict[str, Average]
    modulation: dict[str, Modulation]
    kurtosis: Array
    kurtosis_limit: float
    envelope: dict[str, float]


def study(heard: Heard, draws: int) -> Study:
    """Look at a record; `draws` surrogates for the test of one tooth."""
    plain, sharp = patterns(heard, whiten=False), patterns(heard)
    places, amplitude = orders.spectrum(heard)
    kurtosis, limit = averages.by_revolution(sharp)
    shafts = {name: heard.orders[name] for name in SHAFTS}
    return Study(
        heard, plain, sharp, places, amplitude,
        lines=orders.lines(heard, places, amplitude),
        one_tooth=one_tooth(sharp, draws),
        presence={name: presence(sharp, name) for name in SHAFTS},
        asynchronous=orders.asynchronous(sharp),
        averages={name: averages.average(sharp, name) for name in SHAFTS},
        modulation={name: averages.modulation(plain.cut, heard.teeth, name) for name in SHAFTS},
        kurtosis=kurtosis,
        kurtosis_limit=limit,
        envelope=averages.envelope_orders(sharp, shafts),
    )  # fmt: skip
