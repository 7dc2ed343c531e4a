"""A casing record made ready: the signal, the smoothed angle of the pinion, the teeth."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from gear_damping.errors import InputError, Problem
from gear_damping.identification.observation import response_names
from gear_damping.measurement.record import Measurement, Record
from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.traits import Trait

TURN = 2 * np.pi  # rad in one turn of a shaft
FEWEST_TURNS = 8  # of the pinion: fewer leave no order between those of a shaft to take the floor from
FEWEST_SAMPLES = 8  # in a mesh period: its first harmonics are then below half the sampling rate
NAMES = ("n_teeth_pinion", "n_teeth_gear")


@dataclass(frozen=True, eq=False)
class Heard:
    """A casing record.

    Args:
        name: Of the record.
        role: As the file says it.
        values: (n,) acceleration without its mean.
        unit: Of the acceleration.
        rate: Samples per second in Hz.
        turn: (n,) turns of the pinion, increasing, smoothed over one turn.
        teeth: Of pinion and gear.
    """

    name: str
    role: str | None
    values: NDArray[np.float64]
    unit: str
    rate: float
    turn: NDArray[np.float64]
    teeth: tuple[int, int]

    @property
    def turns(self) -> float:
        """Turns of the pinion in the record."""
        return float(self.turn[-1] - self.turn[0])

    @property
    def speed(self) -> float:
        """Turns of the pinion per second."""
        return self.turns / (len(self.turn) - 1) * self.rate

    @property
    def fluctuation(self) -> float:
        """Range of the speed over its mean, over parts of the record that hold about a turn."""
        parts = self.turn[:: max(1, round(self.rate / self.speed))]
        steps = np.diff(parts)
        return float(np.ptp(steps) / steps.mean()) if len(steps) > 1 else 0.0

    @property
    def orders(self) -> dict[str, float]:
        """Orders of the shafts and of the mesh, in cycles per turn of the pinion."""
        return {"pinion": 1.0, "gear": self.teeth[0] / self.teeth[1], "mesh": float(self.teeth[0])}


def is_casing(measurement: Measurement) -> bool:
    """Whether a gear pair was heard through its casing and nothing else was measured of its response."""
    if not measurement.base.has(Trait.TEETH):
        return False
    heard = [record.on_casing for record in measurement.records]
    return any(heard) and not any(_has_response(record, measurement.base) for record in measurement.records)


def heard_of(measurement: Measurement) -> list[Heard]:
    """The casing records.

    Raises:
        InputError: a record has no shaft angle, is too short, or is sampled too slowly for its mesh.
    """
    usual = {parameter.name: parameter.default for parameter in measurement.base.parameters}
    stated = {name: quantity.value for name, quantity in measurement.parameters.items()}
    teeth = tuple(round(stated.get(name, usual[name])) for name in NAMES)
    problems: list[Problem] = []
    made = [_heard(record, teeth, problems) for record in measurement.records if record.on_casing]
    if problems:
        raise InputError(problems)
    return [one for one in made if one is not None]


def _has_response(record: Record, base: type[System]) -> bool:
    """Whether a simulation can be compared with the record; a speed beside a casing is what it is heard at."""
    names = set(response_names(record, base))
    return bool(names - {"pinion_speed"} if record.on_casing else names)


def _heard(record: Record, teeth: tuple[int, int], problems: list[Problem]) -> Heard | None:
    channel, angle = record.channels["acceleration"], record.channels.get("pinion_angle")
    source = str(record.file)
    if angle is None:
        rule = "an accelerometer on a casing is read by the angle of the shaft, and this record has none"
        remedy = "declare the tacho, encoders: {tacho: {column: tacho, pulses_per_revolution: 1}}"
        problems.append(Problem(f"{record.name}.encoders", rule, None, remedy, source))
        return None
    turn = _smoothed(np.asarray(angle.values) / TURN)
    turn = turn + np.gradient(turn) * angle.delay * record.sampling_rate
    values = channel.values - channel.values.mean()
    heard = Heard(record.name, record.role, values, channel.unit, record.sampling_rate, turn, teeth)
    problem = _unfit(heard)
    if problem:
        problems.append(Problem(f"{record.name}.acceleration", *problem, source))
        return None
    return heard


def _unfit(heard: Heard) -> tuple[str, None, str] | None:
    if heard.turns < FEWEST_TURNS:
        rule = f"the record lasts {heard.turns:.3g} turns of the pinion, and at least {FEWEST_TURNS} are needed"
        return rule, None, f"record at least {FEWEST_TURNS / heard.speed if heard.turns > 0 else np.inf:.3g} s"
    samples = heard.rate / (heard.speed * heard.teeth[0])
    if samples < FEWEST_SAMPLES:
        rule = f"there are {samples:.3g} samples in a mesh period, and at least {FEWEST_SAMPLES} are needed"
        return rule, None, f"sample at {FEWEST_SAMPLES * heard.speed * heard.teeth[0]:.4g} Hz or faster"
    if np.any(np.diff(heard.turn) <= 0):
        return "the shaft stands still or turns back within the record", None, "cut the record with slice"
    return None


def _smoothed(turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turns that increase, without the jitter of pulses and the steps of counts."""
    turn = turn if turn[-1] >= turn[0] else -turn
    whole = float(turn[-1] - turn[0])
    if whole < 2:
        return turn
    width = int(len(turn) / whole) | 1
    if width < 5:
        return turn
    line = np.linspace(turn[0], turn[-1], len(turn))
    return line + savgol_filter(turn - line, width, 2)
