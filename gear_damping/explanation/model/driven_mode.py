"""A mass on a spring behind a driven one that no spring holds, from what the load makes of the motion.

Where nothing holds the first mass, its motion has no frequency of its own beside which a line could stand. What the
load does to it says all the same where the other mass swings alone: there it holds the first one still.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.cause import Mode

Array = NDArray[np.complex128]
FORCE = "force"
PLACES = 120  # between the lowest and the highest frequency that the load holds: fits find the way from one to the next
MOST_LINES = 2000  # of a record: more tell the place of a resonance no better
DAMPED = (0.003, 0.03, 0.2)  # damping ratios that are tried, the width of a resonance apart
BRAKED = (0.1, 0.3, 1.0)  # of the mass by the ground, over its frequency: from a line to none
DRIVEN = 1e-3  # of the largest power of the load in any line: less drives nothing
SEEN = 0.99  # of the power of the rate beyond the noise, which grows with the frequency: above there is hardly any
ABOVE = 2.0  # times the power of the noise: what one mass leaves is more of the motion than of the sensor
TAKES = 0.5  # of what a simpler one leaves: where less is of the other mass, something else is missed, as a friction
SIZE = 2  # place of the size of what is beside one mass, behind those of the load and of damping
LOWEST = 3  # lines of a record: below, the window's own width blurs the motion into its rates


@dataclass(frozen=True)
class _Lines:
    """What a record holds at its frequencies.

    Args:
        angular: Frequencies, rad/s, (lines,).
        load: The load, (lines,).
        rate: The motion as a rate, (lines,).
        noise: Power of the sensor's noise in all rates.
    """

    angular: NDArray[np.float64]
    load: Array
    rate: Array
    noise: float

    @property
    def power(self) -> float:
        """Of all rates."""
        return float(np.sum(np.abs(self.rate) ** 2))


def driven_mode(records: Sequence[FitRecord], noise: float) -> Mode | None:
    """The mass on a spring with which loads and motions agree best; None where none takes most of what one mass leaves.

    Mass times rate, damping and the pull of the other mass are summed at each frequency by least squares, with the
    frequency of that mass tried all along the band that the load holds. Nothing of it is a result: fits begin from it,
    and delays and filters of sensors are left to them.

    Args:
        records: Those without a load, or with uneven stamps, say nothing.
        noise: Standard deviation of the sensor's noise, of a record of weight 1.
    """
    seen = _Seen.of(records, noise)
    if seen is None:
        return None
    free, braked = (
        min(seen.tried(PULL, at, zeta, brake * at) for at, zeta in seen.places for brake in brakes)
        for brakes in ((0.0,), BRAKED)
    )
    takes = (1 - TAKES) * (free[0] - seen.sensor)
    return seen.mode(*(braked if braked[0] - seen.sensor < takes else free))


def opposed_mode(records: Sequence[FitRecord], noise: float) -> Mode | None:
    """The second mode, of a residue of the other sign, with which they agree best; arguments and None as above.

    Its `mass_ratio` is that of the residues.
    """
    seen = _Seen.of(records, noise)
    return None if seen is None else seen.mode(*min(seen.tried(OPPOSED, *place) for place in seen.places))


@dataclass(frozen=True)
class _Seen:
    """What records hold at all of their frequencies, and what one mass leaves of it.

    Args:
        lines: Of every record.
        places: Frequencies in rad/s all along the band that the load holds, each with damping ratios.
        sensor: Share of the sensor's noise in the power of all rates.
        alone: Share that one mass leaves.
    """

    lines: list[_Lines]
    places: list[tuple[float, float]]
    sensor: float
    alone: float

    @classmethod
    def of(cls, records: Sequence[FitRecord], noise: float) -> "_Seen | None":
        """Of records; None where none has a load, or one mass leaves hardly more than noise."""
        even = (record for record in records if FORCE in record.inputs and record.stamps is None)
        lines = [one for record in even if (one := _lines(record, noise)) is not None]
        if not lines:
            return None
        low, high = min(one.angular[0] for one in lines), max(one.angular[-1] for one in lines)
        places = [(float(at), zeta) for at in np.geomspace(low, high, PLACES) for zeta in DAMPED]
        sensor = sum(one.noise for one in lines) / sum(one.power for one in lines)
        alone, _ = _left(lines)
        return None if alone < ABOVE * sensor else cls(lines, places, sensor, alone)

    def tried(self, beside: "_Beside", *place: float) -> tuple[float, ...]:
        """Share that is left beside something at a place, its size over what its columns are of, and the place."""
        left, sizes = _left(self.lines, beside, place)
        of = max(sizes[0], 1e-300) if SIZE in beside.of_load else 1.0
        return left, float(sizes[SIZE] / of), *place

    def mode(self, left: float, ratio: float, angular: float, damping: float, drag: float = 0.0) -> Mode | None:
        """One that was tried, where it takes most of what one mass leaves."""
        if left - self.sensor >= (1 - TAKES) * (self.alone - self.sensor):
            return None
        return Mode(angular / (2 * pi), ratio, damping, drag)


@dataclass(frozen=True)
class _Beside:
    """What a rate may hold beside the motion of one mass.

    Args:
        columns: Of a record's lines at a place, none of which may be negative; the first one has the size.
        of_load: Places of columns behind those of the load and of damping that go with the load, and have its sign.
    """

    columns: Callable[..., list[Array]]
    of_load: tuple[int, ...] = ()


def _pull(one: _Lines, natural: float, zeta: float, drag: float) -> list[Array]:
    """What a mass on a spring pulls at the driven one, which the ground brakes by `drag` in 1/s."""
    spring = natural**2 + 2j * zeta * natural * one.angular
    inert = 1j * drag * one.angular - one.angular**2
    return [one.rate * spring * inert / (one.angular**2 * (spring + inert))]


def _opposed(one: _Lines, natural: float, zeta: float) -> list[Array]:
    """What a mode that moves the other way takes from the rate, and from what brakes it."""
    held = natural**2 - one.angular**2 + 2j * zeta * natural * one.angular
    return [-1j * one.angular * one.load / held, -one.load / held]


PULL, OPPOSED = _Beside(_pull), _Beside(_opposed, (SIZE, SIZE + 1))  # both of its columns are of the load


def _lines(record: FitRecord, noise: float) -> _Lines | None:
    """The lines of a record at frequencies at which its load holds power; None where that holds none."""
    order, series = record.observed.derivatives, record.response.numpy()
    if order == 0:  # a place that wanders far leaks through any window, and its rate does not
        order, series = 1, np.gradient(series) * record.sampling_rate
    window = np.hanning(len(series))
    load, motion = (np.fft.rfft(window * (one - one.mean())) for one in (record.inputs[FORCE].numpy(), series))
    angular = 2 * pi * np.fft.rfftfreq(len(series), 1 / record.sampling_rate)
    rate = motion * np.where(angular > 0, 1j * angular, 1.0) ** (1 - order)
    sensor = (noise / record.weight) ** 2 * float(np.sum(window**2))
    sensor *= np.where(angular > 0, angular, 1.0) ** (2.0 - 2.0 * record.observed.derivatives)
    moved = np.cumsum(np.abs(rate) ** 2 - sensor)
    power = np.abs(load) ** 2
    kept = (np.arange(len(angular)) >= LOWEST) & (power > DRIVEN * power.max())
    kept &= np.arange(len(angular)) <= int(np.argmax(moved >= SEEN * moved.max()))
    kept = np.flatnonzero(kept)[:: 1 + int(kept.sum()) // MOST_LINES]
    if not kept.size:
        return None
    weight = record.weight
    return _Lines(angular[kept], weight * load[kept], weight * rate[kept], weight**2 * float(sensor[kept].sum()))


def _left(
    lines: Sequence[_Lines], beside: _Beside | None = None, place: Sequence[float] = ()
) -> tuple[float, NDArray[np.float64]]:
    """Share of the power of all rates that is left, and the sizes of the load, of damping and of what is beside them.

    Args:
        lines: Of all records.
        beside: What is beside one mass; nothing where absent.
        place: Where that is.
    """
    columns, wanted = [], []
    for one in lines:
        own = [one.load / (1j * one.angular), -one.rate / (1j * one.angular)]
        own += beside.columns(one, *place) if beside is not None else []
        *known, rate = (np.r_[column.real, column.imag] for column in (*own, one.rate))
        columns.append(np.stack(known, 1))
        wanted.append(rate)
    matrix, target = np.concatenate(columns), np.concatenate(wanted)
    scale = np.linalg.norm(matrix, axis=0)
    signs = np.ones((2, len(scale)))
    signs[1, [0, *(beside.of_load if beside is not None else ())]] = -1.0  # the gain of a load may have either
    sizes, norm = min((nnls(sign * matrix / scale, target) for sign in signs), key=lambda one: one[1])
    return float(norm**2 / (target @ target)), sizes / scale
