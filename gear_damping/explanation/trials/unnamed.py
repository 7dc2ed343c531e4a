"""Families of forces and lines without a name, which stand beside the catalogue in the test of what is visible.

Where one of them is visible and no effect of the catalogue takes it, something is wrong that nobody has named.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.signal import fftconvolve
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.shaft import Shaft, shaft_of
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.linear import linear_of
from gear_damping.explanation.trials.motion import motions
from gear_damping.identification.output_error.records import FitRecord

Array = NDArray[np.float64]
SHAFT_ORDERS = 4  # harmonics of either shaft
MESH_ORDERS = 6  # harmonics of the mesh
STATE_POWERS = 3  # of displacement and rate
TOOTH_WAVES = 2  # harmonics of the mesh that modulate the displacement
SIDE_ORDERS = 2  # of either shaft beside each of these
POLES = tuple(0.1 * 1.4**k for k in range(13))  # natural frequencies at which the motion is remembered, 0.1 to 5.7
MEMORY_DAMPING = 0.17  # damping ratio of a memory: neighbours meet at half their power
BANDWIDTH = 2.0  # rad in a sample, a third of the rate: what is faster is not seen


def unnamed_columns(outcome: Outcome, evidence: Evidence) -> dict[str, Tensor]:
    """Columns (samples, n) by family, in the order of the problem's weighted samples.

    Forces are seen through the linear oscillator that the model is on average, lines are seen as they are. They act on
    the motion that is predicted: what was measured holds the random part, which would follow itself.
    """
    problem = outcome.problem
    linear = linear_of(outcome)
    common = _common(problem.records, evidence, linear)
    by_row = [
        _of_row(row, *motion, evidence, common) for row, motion in zip(problem.records, motions(outcome), strict=True)
    ]
    families = dict.fromkeys(name for row in by_row for name in row)
    found = {}
    for family in families:
        width = max(row[family].shape[1] for row in by_row if family in row)
        shape = len(problem.response.channels), problem.response.length
        stacked = torch.zeros(len(by_row), *shape, width, dtype=torch.float64)
        for place, row in enumerate(by_row):
            if family in row:
                channel = problem.response.channels.index(problem.records[place].observed.name)
                stacked[place, channel, : len(row[family])] = torch.as_tensor(row[family])
        weighted = stacked.flatten(1, 2) * problem.response.weights.unsqueeze(-1)
        found[family] = weighted.flatten(0, 1)
    return found


@dataclass(frozen=True)
class _Common:
    """What families need of all records.

    Args:
        linear: Mass, damping coefficient and stiffness of the model on average.
        speed: Mean speed of the pinion; 0 of an oscillator.
        load: Mean torque on it.
        force: Standard deviation of a measured force.
    """

    linear: tuple[float, float, float]
    speed: float
    load: float
    force: float


def _common(records: Sequence[FitRecord], evidence: Evidence, linear: tuple[float, float, float]) -> _Common:
    shafts = [shaft_of(record, evidence) for record in records]
    speeds = [_speed(record, shaft).mean() for record, shaft in zip(records, shafts, strict=True) if shaft]
    forces = [float(record.inputs["force"].var(unbiased=False)) for record in records if "force" in record.inputs]
    load = float(np.mean([_load(record).mean() for record in records]))
    return _Common(linear, float(np.mean(speeds or [0.0])), load, float(np.mean(forces or [0.0])) ** 0.5)


def _of_row(record: FitRecord, place: Array, rate: Array, evidence: Evidence, common: _Common) -> Mapping[str, Array]:
    """Columns of one record or segment by family, (time, n), from what it is predicted to do."""

    def moved(forces: Sequence[Array]) -> Array:
        return _through(np.stack(forces, 1), record.sampling_rate, common.linear, record.observed.derivatives)

    time = np.linspace(-1, 1, len(place))
    powers = [place**i * rate**j for i in range(STATE_POWERS + 1) for j in range(STATE_POWERS + 1 - i) if i + j > 1]
    found = {
        "force over the state": moved([*powers, np.sign(rate), np.abs(rate) * rate]),
        "force that follows earlier motion": moved(_remembered(place, record.sampling_rate, common.linear)),
        "drift": time[:, None],
    }
    shaft = shaft_of(record, evidence)
    if shaft is not None or record.inputs:  # what dies away by itself is small late: any law of the amplitude drifts
        found["stiffness or damping that drifts"] = moved([time * place, time * rate])
    if shaft is not None:
        found |= _at_shafts(shaft, place, rate, moved)
        found["force over speed and load"] = moved(_operated(record, shaft, place, rate, common))
    if "force" in record.inputs:
        force = record.at_samples("force").numpy() / (common.force or 1.0)
        found["force over the input"] = moved([force**2, force**3, np.gradient(force) * record.sampling_rate])
    return found


def _operated(record: FitRecord, shaft: Shaft, place: Array, rate: Array, common: _Common) -> list[Array]:
    """Forces, and parts of stiffness and damping, that change with the speed of the shaft or with the load."""
    speed, load = _relative(_speed(record, shaft), common.speed), _relative(_load(record), common.load)
    return [level * part for level in (speed, speed**2, load) for part in (np.ones_like(place), place, rate)]


def _relative(values: Array, mean: float) -> Array:
    return values / mean - 1 if mean else values


def _speed(record: FitRecord, shaft: Shaft) -> Array:
    return np.gradient(shaft.angle) * record.sampling_rate


def _load(record: FitRecord) -> Array:
    name = "pinion_torque"
    known = record.at_samples(name) if name in record.inputs else record.conditions.get(name, 0.0)
    return np.broadcast_to(np.asarray(known, dtype=float), len(record.response))


def _at_shafts(shaft: Shaft, place: Array, rate: Array, moved: object) -> dict[str, Array]:
    """Families that go with the angles of the shafts."""
    ratio, mesh = shaft.teeth[0] / shaft.teeth[1], shaft.angle * shaft.teeth[0]
    pinion, gear = _waves(shaft.angle, SHAFT_ORDERS), _waves(shaft.angle * ratio, SHAFT_ORDERS)
    teeth, tooth = _waves(mesh, MESH_ORDERS), _waves(mesh, TOOTH_WAVES)
    return {
        "lines at the pinion's order": np.stack(pinion, 1),
        "lines at the gear's order": np.stack(gear, 1),
        "lines at the mesh order": np.stack(teeth, 1),
        "force at the pinion's order": moved(pinion),
        "force at the gear's order": moved(gear),
        "force at the mesh order": moved(teeth),
        "force at sidebands of the pinion": moved(_orthogonal(tooth, pinion[: 2 * SIDE_ORDERS])),
        "force at sidebands of the gear": moved(_orthogonal(tooth, gear[: 2 * SIDE_ORDERS])),
        "stiffness over the turn": moved([w * place for w in (*pinion[:4], *gear[:4])]),
        "force over mesh phase and motion": moved([w * x for w in tooth for x in (place, rate)]),
    }


def _through(forces: Array, rate: float, linear: tuple[float, float, float], order: int) -> Array:
    """What the linear oscillator makes of forces (time, n), differentiated `order` times; starts are not minded."""
    mass, damping, stiffness = linear
    count = len(forces)
    turn = 2j * np.pi * np.fft.rfftfreq(2 * count, 1 / rate)
    dynamic = mass * turn**2 + damping * turn + stiffness
    dynamic[np.abs(dynamic) == 0] = np.inf  # without a spring a steady force has no steady answer
    mean = forces.mean(0)
    spectrum = np.fft.rfft(forces - mean, n=2 * count, axis=0) * (turn**order / dynamic)[:, None]
    steady = mean / stiffness if stiffness > 0 and order == 0 else 0.0
    return np.fft.irfft(spectrum, n=2 * count, axis=0)[:count] + steady


def _remembered(place: Array, rate: float, linear: tuple[float, float, float]) -> list[Array]:
    """The motion as modes of many frequencies remember it: what any force that is linear in its past is made of.

    A basis of exponentials (Kautz 1954; Heuberger, Van den Hof & Bosgra 1995, IEEE Trans. Automatic Control 40): the
    motion of a hidden mode, a delayed force, a relaxation.
    """
    mass, _, stiffness = linear
    time, found = np.arange(len(place)) / rate, []
    for pole in POLES:
        angular = pole * (stiffness / mass) ** 0.5
        kept = np.exp((-MEMORY_DAMPING + 1j) * angular * time) * (angular < BANDWIDTH * rate)
        both = fftconvolve(place, kept)[: len(place)]
        found += [both.real, both.imag]
    return found


def _orthogonal(carriers: Sequence[Array], waves: Sequence[Array]) -> list[Array]:
    """Every carrier modulated by every wave: sidebands of it."""
    return [carrier * wave for carrier in carriers for wave in waves]


def _waves(angle: Array, count: int) -> list[Array]:
    return [wave(h * angle) for h in range(1, count + 1) for wave in (np.cos, np.sin)]
