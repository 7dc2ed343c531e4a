"""Families of forces and lines without a name, which stand beside the catalogue in the test of what is visible.

Where one of them is visible and no effect of the catalogue takes it, something is wrong that nobody has named.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.shaft import Shaft, shaft_of
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.linear import linear_of
from gear_damping.identification.output_error.records import FitRecord

Array = NDArray[np.float64]
SHAFT_ORDERS = 4  # harmonics of either shaft
MESH_ORDERS = 6  # harmonics of the mesh
STATE_POWERS = 3  # of displacement and rate
TOOTH_WAVES = 2  # harmonics of the mesh that modulate the displacement
SIDE_ORDERS = 2  # of either shaft beside each of these


def unnamed_columns(outcome: Outcome, evidence: Evidence) -> dict[str, Tensor]:
    """Columns (samples, n) by family, in the order of the problem's weighted samples.

    Forces are seen through the linear oscillator that the model is on average, lines are seen as they are. They act on
    the motion that is predicted: what was measured holds the random part, which would follow itself.
    """
    problem = outcome.problem
    linear = linear_of(outcome)
    shown = problem.response.values - outcome.fitted.prediction.residual[0] / problem.response.weights.clamp(min=1e-300)
    channels = problem.response.channels
    first = [
        one.unflatten(0, (len(channels), -1))[channels.index(row.observed.name), : len(row.response)]
        for row, one in zip(problem.records, shown, strict=True)
    ]
    by_row = [_of_row(row, one.numpy(), evidence, linear) for row, one in zip(problem.records, first, strict=True)]
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


def _of_row(
    record: FitRecord, shown: Array, evidence: Evidence, linear: tuple[float, float, float]
) -> Mapping[str, Array]:
    """Columns of one record or segment by family, (time, n), from what its first channel is predicted to show."""
    order = record.observed.derivatives
    place, rate = _motion(shown, order)

    def moved(forces: Sequence[Array]) -> Array:
        return _through(np.stack(forces, 1), record.sampling_rate, linear, order)

    powers = [place**i * rate**j for i in range(STATE_POWERS + 1) for j in range(STATE_POWERS + 1 - i) if i + j > 1]
    found = {
        "force over the state": moved([*powers, np.sign(rate), np.abs(rate) * rate]),
        "drift": np.linspace(-1, 1, len(place))[:, None],
    }
    shaft = shaft_of(record, evidence)
    if shaft is not None:
        found |= _at_shafts(shaft, place, rate, moved)
    if "force" in record.inputs:
        force = record.inputs["force"].numpy()
        force = force / (force.std() or 1.0)
        found["force over the input"] = moved([force**2, force**3, np.gradient(force)])
    return found


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
        "force at sidebands of the pinion": moved(_beside(tooth, pinion[: 2 * SIDE_ORDERS])),
        "force at sidebands of the gear": moved(_beside(tooth, gear[: 2 * SIDE_ORDERS])),
        "stiffness over the turn": moved([w * place for w in (*pinion[:4], *gear[:4])]),
        "force over mesh phase and motion": moved([w * x for w in tooth for x in (place, rate)]),
    }


def _motion(shown: Array, order: int) -> tuple[Array, Array]:
    """Displacement and rate about their means, each of unit spread, from a derivative of the displacement."""
    values = shown - shown.mean()
    if order == 0:
        place, rate = values, np.gradient(values)
    elif order == 1:
        place, rate = _summed(values), values
    else:
        rate = _summed(values)
        place = _summed(rate)
    return place / (place.std() or 1.0), rate / (rate.std() or 1.0)


def _summed(values: Array) -> Array:
    """The integral without the drift that an offset leaves."""
    total = np.cumsum(values)
    slope = np.polynomial.polynomial.polyfit(np.linspace(-1, 1, len(total)), total, 1)
    return total - np.polynomial.polynomial.polyval(np.linspace(-1, 1, len(total)), slope)


def _through(forces: Array, rate: float, linear: tuple[float, float, float], order: int) -> Array:
    """What the linear oscillator makes of forces (time, n), differentiated `order` times; starts are not minded."""
    mass, damping, stiffness = linear
    count = len(forces)
    turn = 2j * np.pi * np.fft.rfftfreq(2 * count, 1 / rate)
    dynamic = mass * turn**2 + damping * turn + stiffness
    dynamic[np.abs(dynamic) == 0] = np.inf  # without a spring a steady force has no steady answer
    spectrum = np.fft.rfft(forces - forces.mean(0), n=2 * count, axis=0) * (turn**order / dynamic)[:, None]
    found = np.fft.irfft(spectrum, n=2 * count, axis=0)[:count]
    size = found.std(0)
    return found / np.where(size > 0, size, 1.0)


def _beside(carriers: Sequence[Array], waves: Sequence[Array]) -> list[Array]:
    """Every carrier modulated by every wave: sidebands of it."""
    return [carrier * wave for carrier in carriers for wave in waves]


def _waves(angle: Array, count: int) -> list[Array]:
    return [wave(h * angle) for h in range(1, count + 1) for wave in (np.cos, np.sin)]
