"""What every test would tell, as information matrices: the part of a plan that simulates."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from gear_damping.identification.test_plan.asked import PlannedSensor, PlannedTests, Unknown
from gear_damping.identification.test_plan.information import information, shared_information
from gear_damping.identification.test_plan.rig import Rig, members_at, settings_of
from gear_damping.identification.test_plan.slopes import STEP, Recorder, scales_of, slopes
from gear_damping.identification.test_plan.starts import AT_ONCE, INITIAL, InitialState, initial_state, settling_time
from gear_damping.simulation.runs import effect_state_units
from gear_damping.simulation.solver_settings import Progress

GROWTH = 8.0  # from the second quarter of a record to the last: squares of time make 5.4
ROUNDED = 1e-5  # of a slope, below which it is what rounding left
FARTHEST = 1e4  # of a slope at the beginning; at 1e6 an error of a step has grown as far as it can
BEGINNING = 16  # samples that a record's slopes are compared with further on


@dataclass(frozen=True)
class Names:
    """What is unknown: of the rig, the same in all tests, and of each test."""

    shared: tuple[str, ...]
    own: tuple[str, ...]
    prior: dict[str, Unknown]

    @property
    def all(self) -> tuple[str, ...]:
        """Shared ones first."""
        return self.shared + self.own


@dataclass(frozen=True)
class Survey:
    """What tests would tell.

    Args:
        rig: The rig.
        tests: The tests.
        sensors: The sensors.
        names: What is unknown; every unknown counts in its scale.
        settings: Values of each setting by name of the parameter.
        lengths: Samples of the records, ascending.
        whole: Information, (sensors, settings, lengths, unknowns, unknowns); of offsets, the last ones, too.
        noise: Standard deviations, (sensors, settings).
        own_prior: Precision of the tests' own unknowns beforehand, (settings, own).
        shared_prior: Precision of the shared ones, (shared,).
        gradient: Of the damping ratio in % by the shared ones, (shared,).
        start: Where the records begin, a member for each setting.
        fine: Tests whose motion neither diverges nor is irregular, (settings, lengths); others promise nothing.
    """

    rig: Rig
    tests: PlannedTests
    sensors: tuple[PlannedSensor, ...]
    names: Names
    settings: tuple[dict[str, float], ...]
    lengths: tuple[int, ...]
    whole: Tensor
    noise: Tensor
    own_prior: Tensor
    shared_prior: Tensor
    gradient: Tensor
    start: InitialState
    fine: Tensor

    @property
    def ratio_percent(self) -> float:
        """The true damping ratio, % of critical."""
        return float(self.rig.ratio_percent(self.rig.values))

    @property
    def exponent_place(self) -> int | None:
        """Which of the shared unknowns the exponent is."""
        return 1 if self.rig.exponent else None

    def told(self, chosen: Sequence[int]) -> Tensor:
        """Information on the shared unknowns by tests with these sensors, (settings, lengths, shared, shared)."""
        found = shared_information(self.whole[list(chosen)].sum(0), len(self.names.shared), self.own_prior[:, None])
        return torch.where(self.fine[..., None, None], found, 0.0)


def survey(
    rig: Rig,
    tests: PlannedTests,
    sensors: Sequence[PlannedSensor],
    unknown: Sequence[Unknown] = (),
    progress: Progress | None = None,
) -> Survey:
    """Simulate every test with its slopes; those of a setting that differ in length share a simulation."""
    settings, names = settings_of(tests.speeds, tests.torques, tests.amplitudes), names_of(rig, unknown)
    lengths = tuple(sorted(round(duration * tests.sampling_rate) for duration in tests.durations))
    start = initial_state(rig, members_at(rig, settings), settling_time(rig, tests.settle), tests.sampling_rate)
    recorder = Recorder(rig, tests.sampling_rate, lengths[-1], tuple(sensor.sees for sensor in sensors))
    scales, solver = scales_of(recorder, start, names.all), recorder.solver(start.values)
    chunks = torch.arange(len(settings)).split(max(1, AT_ONCE // (lengths[-1] * (2 * len(scales) + 1))))
    parts, levels, regular = [], [], []
    begins = [names.all.index(name) for name in INITIAL]
    for number, chunk in enumerate(chunks):
        found = slopes(recorder, picked(start, chunk), {n: s[chunk] for n, s in scales.items()}, solver)
        levels.append(noise_of(sensors, found.records[..., : lengths[0]]))
        regular.append(is_regular(found.by[:, :, begins], lengths) & found.straight[:, None])
        parts.append(information(_with_offsets(found.by, sensors, levels[-1]), levels[-1], list(lengths)))
        if progress:
            progress(number + 1, len(chunks))
    whole, noise = torch.cat(parts, 1), torch.cat(levels, 1)
    fine = start.fine[:, None] & whole.flatten(3).isfinite().all(-1).all(0) & torch.cat(regular)
    whole = torch.where(fine[None, ..., None, None], whole, 0.0)
    prior = {name: _precision(names.prior.get(name), scales[name]) for name in names.all}
    offsets = [torch.zeros(len(settings), dtype=torch.float64) for sensor in sensors if sensor.offset]
    own = torch.stack([*(prior[name] for name in names.own), *offsets], -1)
    shared = torch.stack([prior[name][0] for name in names.shared])
    gradient = gradient_of(rig, names.shared)
    return Survey(rig, tests, tuple(sensors), names, tuple(settings), lengths, whole, noise, own, shared, gradient,
                  start, fine)  # fmt: skip


def names_of(rig: Rig, unknown: Sequence[Unknown]) -> Names:
    """The damping first, then the exponent where there is one; of a test the start behind what was named."""
    law = [rig.coefficient, *([rig.exponent] if rig.exponent else [])]
    shared = [*law, *(one.name for one in unknown if not one.each)]
    own = [*(one.name for one in unknown if one.each), *INITIAL, *effect_state_units(rig.model)]
    return Names(tuple(shared), tuple(own), {one.name: one for one in unknown})


def picked(start: InitialState, members: Tensor) -> InitialState:
    """Some of the members."""
    values = {name: value[..., members] for name, value in start.values.items()}
    initial_perturbations = {name: value[members] for name, value in start.initial_perturbations.items()}
    return replace(start, values=values, initial_perturbations=initial_perturbations, fine=start.fine[members])


def noise_of(sensors: Sequence[PlannedSensor], records: Tensor) -> Tensor:
    """Standard deviation of the noise of each sensor, (sensors, batch), from what it sees, (sensors, batch, time)."""
    levels = [
        torch.full_like(record[:, 0], sensor.noise)
        if sensor.snr_db is None
        else record.std(-1, correction=0) * 10 ** (-sensor.snr_db / 20)
        for sensor, record in zip(sensors, records, strict=True)
    ]
    return torch.where((level := torch.stack(levels)) > 0, level, torch.nan)  # without motion there is no ratio to it


def is_regular(slopes: Tensor, lengths: Sequence[int]) -> Tensor:
    """Whether an error of the start does not grow faster than by a power of time over records, (batch, lengths).

    Where it does, the motion is irregular: likelihoods have many peaks, and no estimate stays near the right one.

    Args:
        slopes: By what a record begins with, (channels, batch, unknowns, time).
        lengths: Of the records in samples.
    """
    found, first = [], slopes[..., :BEGINNING].square().mean(-1).sqrt()
    for length in lengths:
        quarters = [part.square().mean(-1).sqrt() for part in slopes[..., :length].tensor_split(4, -1)]
        floor = ROUNDED * quarters[0]
        slow = quarters[3] <= GROWTH * torch.maximum(quarters[1], floor)
        near = torch.stack(quarters).amax(0) <= FARTHEST * first
        found.append((slow & near).all(-1).all(0))
    return torch.stack(found, -1)


def gradient_of(rig: Rig, shared: Sequence[str]) -> Tensor:
    """Of the damping ratio in % by the shared unknowns over their scales, (shared,)."""
    slopes_found = []
    for name in shared:
        value = rig.values[name]
        step = STEP * torch.where(value != 0, value.abs(), 1.0)
        ends = [rig.ratio_percent(rig.values | {name: value + side * step}) for side in (1, -1)]
        slopes_found.append(float(ends[0] - ends[1]) / (2 * STEP))
    return torch.tensor(slopes_found, dtype=torch.float64)


def _with_offsets(found: Tensor, sensors: Sequence[PlannedSensor], noise: Tensor) -> Tensor:
    """The slopes with those by the zeros of the sensors, whose scale is the noise."""
    moved = [number for number, sensor in enumerate(sensors) if sensor.offset]
    more = found.new_zeros(*found.shape[:2], len(moved), found.shape[-1])
    for place, number in enumerate(moved):
        more[number, :, place] = noise[number, :, None]
    return torch.cat([found, more], 2)


def _precision(known: Unknown | None, scale: Tensor) -> Tensor:
    """Of what is known beforehand, over the scale, (batch,)."""
    if known is None or (known.deviation is None and known.percent is None):
        return torch.zeros_like(scale)
    if known.percent is not None:  # the scale of a value that is not 0 is its size
        return torch.full_like(scale, (100 / known.percent) ** 2)
    return (scale / known.deviation).square()
