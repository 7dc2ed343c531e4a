"""What candidates may depend on: the rig of the records, and the orders at which something is left of them."""

from collections.abc import Mapping, Sequence
from math import ceil, floor, log, pi, sqrt

import torch
from torch import Tensor

from gear_damping.explanation.evidence.declared_units import radian_of
from gear_damping.explanation.evidence.records import Evidence, all_stand
from gear_damping.explanation.model.driven_mode import driven_mode, opposed_mode
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.identification.oscillator.linear_model import moves_one_way
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.cause import SHAFTS, Rig
from gear_damping.physics.systems.traits import Trait

Residuals = Sequence[tuple[FitRecord, Tensor]]
MESHES = 3  # orders are looked at up to so many mesh orders
LINES = 8  # of the residual's order spectrum that are kept as candidates, the strongest first
POINTS = 10  # samples a tooth that are enough to see them
LEAST_TURNS = 1.0  # of the pinion in a record: less does not tell one order from the next
MOST_TURNS = 20.0  # of a record that are looked at
BAND = 1.02  # of a frequency, the width of a band in which energy is counted
OWN = 1.2  # of a frequency: nearer, a mode is not told from its neighbour by a spectrum
SWEPT = 2.0  # times the natural frequency: as far as an amplitude may pull that of the motion
BLURRED = 3.0  # over the length of a record: as far as the window spreads a line, and half as much again
WORTH = 0.02  # of what is left beside the orders: so little is nothing that a search goes on for
FLANKS = 6.0  # over the length of a record: farther off the window has taken a line down by 60 dB
HARMONICS = 5  # of the natural frequency that are no modes
AROUND, STANDS_OUT = 10, 5.0  # bands at either side; times their median, from which a line stands out
MODES = 2  # frequencies that are kept
SWELL_PERIODS = 1.0  # natural ones, over which an amplitude is taken: modes an eighth apart beat in eight of them
SWELLS = 2.0  # times what it had fallen to: noise beside a motion that is seen does not double it
SEEN = 0.1  # of the largest amplitude: less may be the noise behind the motion's end
HIGHEST = 0.45  # of the sampling rate
FEWEST_CYCLES = 4.0  # in a record: of fewer a band of its spectrum holds too few lines, and a slow drift looks the same
GEAR_ORDERS = 3  # of the gear's shaft


def rig_of(base: Hypothesis, evidence: Evidence, residuals: Residuals | None = None) -> Rig:
    """The rig of a calibrated model and its records.

    Args:
        base: The model.
        evidence: The records.
        residuals: What the model leaves of records, each (time,); where absent, no orders stand out.
    """
    prepared = base.model.prepare(base.model.values(1, **base.given))
    own = base.model.values(1, **base.given)
    values = {p.name: float(own[p.name][0]) for p in base.system.parameters}
    values |= {name: float(value[0]) for name, value in prepared.derived.items()}
    inputs = tuple(dict.fromkeys(name for record in evidence.fit for name in record.inputs))
    common = {"system": base.system.name, "traits": base.system.traits, "values": values}
    common |= {"spring": base.system.spring, "inputs": inputs, "records": len(evidence.fit)}
    common["band"] = min(record.sampling_rate for record in evidence.fit) / 2
    common["longest"] = evidence.duration
    if not base.system.has(Trait.SHAFTS):
        radian = radian_of(evidence)
        natural = values["natural_frequency"] / (2 * pi)
        lines = strongest_frequencies(residuals or (), natural)
        one_way = natural == 0 and all(moves_one_way(record) for record in evidence.fit)
        swells = natural > 0 and any(swells_again(record, natural) for record in evidence.fit)
        if natural == 0 and residuals:
            driven = evidence.fit, evidence.noise
            common |= {"mode": driven_mode(*driven), "opposed": opposed_mode(*driven)}
        return Rig(radian=radian, frequencies=lines, one_way=one_way, swells=swells, **common)
    values["contact_ratio"] = float(prepared.base["contact_ratio"][0])
    pinion, gear = round(values["n_teeth_pinion"]), round(values["n_teeth_gear"])
    lines = strongest_orders(residuals or (), pinion, gear, values["pinion_speed"])
    common["frequencies"] = ringing_frequencies(residuals or (), pinion, gear, values)
    harmonics = max(_harmonics(record, pinion, values["pinion_speed"]) for record in evidence.fit)
    teeth = {"n_teeth_pinion": pinion, "n_teeth_gear": gear, "indexed": evidence.has_index}
    teeth["standing"] = all_stand(evidence.fit)
    teeth["on_shafts"] = evidence.has_rates
    seen = {channel.shaft for record in evidence.fit for channel in record.channels if channel.is_tangential}
    teeth["accelerometers"] = tuple(shaft for shaft in SHAFTS if shaft in seen)
    return Rig(mesh_harmonics=harmonics, lines=lines, **teeth, **common)


def swells_again(record: FitRecord, natural: float) -> bool:
    """Whether a free motion grows again after it fell, as no dissipative law of one mode lets it.

    Args:
        record: Without an input; else it is not asked.
        natural: Natural frequency in Hz.
    """
    block = round(SWELL_PERIODS * record.sampling_rate / natural)
    if record.inputs or not 0 < block <= len(record.response) // 2:
        return False
    size = (record.response - record.response.mean()).unfold(0, block, block).square().mean(-1).sqrt()
    least, most = size.cummin(0).values[:-1], size.flip(0).cummax(0).values.flip(0)[1:]
    return bool(((most > SWELLS * least) & (most > SEEN * size.max())).any())


def strongest_frequencies(residuals: Residuals, natural: float) -> tuple[float, ...]:
    """Frequencies in Hz at which most is left, but for the natural one and its harmonics; the strongest first.

    Where the frequency depends on the amplitude, what lies between the natural one and that of the motion is the first
    mode's too.

    Args:
        residuals: Records with what is left of them, each (time,).
        natural: Natural frequency in Hz; 0 without a spring, where no frequency stands for a mode.
    """
    if not residuals or natural <= 0:
        return ()
    highest = min(HIGHEST * record.sampling_rate for record, _ in residuals)
    lowest = max(FEWEST_CYCLES * record.sampling_rate / len(record.response) for record, _ in residuals)
    if lowest * BAND >= highest:
        return ()
    edges = _edges(lowest, highest)
    middles = edges[:-1] * sqrt(BAND)
    energy, motion = torch.zeros(2, len(middles), dtype=torch.float64)
    for record, left in residuals:
        for total, series in ((energy, left[: len(record.response)]), (motion, record.response)):
            power, frequency = _power(series * record.weight, record.sampling_rate)
            total += _in_bands(power, frequency, edges)
    energy = torch.where(_stands_out(energy), energy, 0.0)
    multiples = (middles / natural).round().clamp(min=1)
    near = (middles / natural / multiples).log().abs() < torch.where(multiples > 1, log(BAND) * 2, log(OWN))
    energy[near & (multiples <= HARMONICS)] = 0
    moving = float(middles[int(motion.argmax())])
    if moving < SWEPT * natural and natural < SWEPT * moving:
        blurred = BLURRED * max(record.sampling_rate / len(record.response) for record, _ in residuals)
        low, high = min(moving, natural), max(moving, natural)
        energy[(middles > min(low / OWN, low - blurred)) & (middles < max(high * OWN, high + blurred))] = 0
    found = []
    for _ in range(MODES):
        best = int(energy.argmax())
        if float(energy[best]) <= 0:
            break
        found.append(float(middles[best]))
        energy[(middles / middles[best]).log().abs() < log(OWN)] = 0
    return tuple(found)


def ringing_frequencies(residuals: Residuals, pinion: int, gear: int, values: Mapping[str, float]) -> tuple[float, ...]:
    """The frequency in Hz below that of the mesh at which most is left away from orders of the shafts; or none.

    Orders move with the speed, and what rings after a step of the torque stays.

    Args:
        residuals: Records with what is left of them, each (time,).
        pinion: Teeth of the pinion.
        gear: Teeth of the gear.
        values: Those of the rig, with its natural frequency and the speed where a record does not say it.
    """
    highest = values["natural_frequency"] / (2 * pi) / OWN
    lowest = max((FEWEST_CYCLES * r.sampling_rate / len(r.response) for r, _ in residuals), default=highest)
    if lowest * BAND >= highest:
        return ()
    edges = _edges(lowest, highest)
    energy, whole = torch.zeros(len(edges) - 1, dtype=torch.float64), 0.0
    for record, left in residuals:
        angle = shaft_angle(record, values["pinion_speed"])[: len(record.response)]
        turning = torch.diff(angle).abs() * record.sampling_rate / (2 * pi)
        slowest, fastest = float(turning.min()), float(turning.max())
        power, frequency = _power(left[: len(record.response)] * record.weight, record.sampling_rate)
        width = FLANKS * record.sampling_rate / len(record.response)
        orders = [k * one for one in (1.0, pinion / gear) for k in range(1, GEAR_ORDERS + 1)]
        for order in [*orders, *(k * pinion for k in range(1, HARMONICS + 1))]:
            power[(frequency > order * slowest - width) & (frequency < order * fastest + width)] = 0
        whole += float(power.sum())
        energy += _in_bands(power, frequency, edges)
    best = int(torch.where(_stands_out(energy), energy, 0.0).argmax())
    return (float(edges[best]) * sqrt(BAND),) if float(energy[best]) > WORTH * whole else ()


def _edges(lowest: float, highest: float) -> Tensor:
    """Frequencies between which the energy of a spectrum is counted, each a little above the one before."""
    return lowest * BAND ** torch.arange(floor(log(highest / lowest) / log(BAND)) + 1, dtype=torch.float64)


def _in_bands(power: Tensor, frequency: Tensor, edges: Tensor) -> Tensor:
    """The power (lines,) between each two edges, (edges - 1,)."""
    inside = (frequency >= edges[0]) & (frequency < edges[-1])
    total = torch.zeros(len(edges) - 1, dtype=torch.float64)
    return total.index_add_(0, torch.bucketize(frequency[inside], edges, right=True) - 1, power[inside])


def _power(series: Tensor, rate: float) -> tuple[Tensor, Tensor]:
    """Power of a series about its mean and the frequencies in Hz."""
    window = torch.hann_window(len(series), dtype=torch.float64)
    power = torch.fft.rfft((series - series.mean()) * window).abs().square()
    return power, torch.fft.rfftfreq(len(series), 1 / rate, dtype=torch.float64)


def _stands_out(energy: Tensor) -> Tensor:
    """Where the energy of a band is many times that of the bands about it: a line, and no flank of another."""
    wide = torch.nn.functional.pad(energy.reshape(1, 1, -1), (AROUND, AROUND), mode="replicate")[0, 0]
    return energy > STANDS_OUT * wide.unfold(0, 2 * AROUND + 1, 1).median(1).values


def strongest_orders(residuals: Residuals, pinion: int, gear: int, speed: float) -> tuple[float, ...]:
    """Orders of the pinion's shaft, up to three meshes, that take most of what is left; the strongest first.

    One after another, each beside those before it, because few turns do not part neighbours. Orders of the mesh and
    low orders of the gear's shaft are taken out first.

    Args:
        residuals: Records with what is left of them, each (time,).
        pinion: Teeth of the pinion.
        gear: Teeth of the gear.
        speed: Of the pinion in rad/s, where a record does not say.
    """
    orders = [order for order in range(1, MESHES * pinion + 1) if order % pinion]
    removed = [order * pinion for order in range(MESHES + 1)]
    removed += [order * pinion / gear for order in range(1, GEAR_ORDERS + 1) if order * pinion % gear]
    parts = [part for record, left in residuals if (part := _by_angle(record, left, pinion, speed)) is not None]
    bases = [torch.linalg.qr(_waves(angle, removed)).Q for angle, _ in parts]
    columns = [_waves(angle, orders).reshape(len(angle), 2, -1) for angle, _ in parts]
    found: list[float] = []
    for _ in range(min(LINES, len(orders)) if parts else 0):
        power = torch.zeros(len(orders), dtype=torch.float64)
        for basis, column, (_, left) in zip(bases, columns, parts, strict=True):
            power += _taken(basis, column, left)
        power[[orders.index(order) for order in found]] = 0
        best = int(power.argmax())
        if float(power[best]) <= 0:
            break
        found.append(float(orders[best]))
        bases = [_with(basis, column[..., best]) for basis, column in zip(bases, columns, strict=True)]
    return tuple(found)


def _by_angle(record: FitRecord, left: Tensor, teeth: int, speed: float) -> tuple[Tensor, Tensor] | None:
    """Shaft angle and residual in blocks that are short beside a tooth; None where the shaft hardly turns."""
    left = left[: len(record.response)] * record.weight
    angle = shaft_angle(record, speed)[: len(left)]
    turns = float((angle[-1] - angle[0]).abs()) / (2 * pi)
    if turns < LEAST_TURNS:
        return None
    kept = ceil(len(left) * min(1.0, MOST_TURNS / turns))
    angle, left, turns = angle[:kept], left[:kept], min(turns, MOST_TURNS)
    block = max(1, floor(len(left) / turns / (POINTS * teeth)))
    count = len(left) // block * block
    return tuple(series[:count].reshape(-1, block).mean(1) for series in (angle, left))


def shaft_angle(record: FitRecord, speed: float) -> Tensor:
    """Angle of the pinion in rad at the samples, (time,): as measured, or at the record's constant speed."""
    if "pinion_angle" in record.inputs:
        return record.at_samples("pinion_angle")
    speed = float(record.conditions.get("pinion_speed", speed))
    return speed / record.sampling_rate * record.instants


def _waves(angle: Tensor, orders: Sequence[float]) -> Tensor:
    """Cosines, then sines, of multiples of an angle, (time, 2 * orders)."""
    turned = angle.unsqueeze(1) * torch.tensor(orders, dtype=torch.float64)
    return torch.cat([torch.cos(turned), torch.sin(turned)], 1)


def _taken(basis: Tensor, columns: Tensor, left: Tensor) -> Tensor:
    """Energy that the pair of waves of each order takes, a basis projected out, (orders,)."""
    left = left - basis @ (basis.T @ left)
    flat = columns.flatten(1)
    orthogonal = (flat - basis @ (basis.T @ flat)).reshape(columns.shape)
    even, odd = orthogonal.unbind(1)
    # Two columns made orthogonal; what the basis holds already takes nothing.
    scale = columns.square().sum(0).amax(0)
    odd = odd - even * (even * odd).sum(0) / even.square().sum(0).clamp(min=1e-12)
    total = torch.zeros_like(scale)
    for column in (even, odd):
        size = column.square().sum(0)
        total += torch.where(size > 1e-6 * scale, (left @ column).square() / size.clamp(min=1e-300), 0.0)
    return total


def _with(basis: Tensor, columns: Tensor) -> Tensor:
    return torch.linalg.qr(torch.cat([basis, columns], 1)).Q


def _harmonics(record: FitRecord, teeth: int, speed: float) -> int:
    """Harmonics of the mesh below half the sampling rate."""
    angle = shaft_angle(record, speed)
    turns_per_sample = float((angle[-1] - angle[0]).abs()) / (2 * pi * max(len(angle) - 1, 1))
    return floor(0.5 / max(teeth * turns_per_sample, 1e-6))
