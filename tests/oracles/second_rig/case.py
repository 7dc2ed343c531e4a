"""One made-up measurement: its rig, records, sensor, files, noise, and the effect that is hidden in it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from .files import Encoders, Record, Table, Wav, conditions, parameters, write_declaration
from .motion import Hidden, Run, simulate
from .pair import Rig
from .sensors import Noise, Sensor, shaken

OFFSETS = 60  # teeth by which a gear may be turned
TURNED = (50.0, 400.0)  # rad that a counter has seen when a record begins
ZERO_OF_GEAR = 6.0  # rad, the largest angle between the zeros of two counters
ENCODER_ZERO = 0.38  # mesh periods from the meeting of a pair to the zero of the pinion's counter
NULL, EFFECT, CONSTANT, OUTSIDE = "null", "effect", "constant", "outside"  # what there is to be found
CONSTANTS = ("damping_ratio", "mesh_modulation")  # declared wrong: calibration answers these, no effect does
FOREIGN = ("sensor_mount_resonance",)  # effects that the catalogue does not have


@dataclass(frozen=True)
class Stream:
    """Where the random numbers of a case begin in the stream of its set, so that it can be drawn alone.

    seed: of the stream. words: of 64 bit that the cases before it took. half: one of 32 bit that they left over.
    """

    seed: int
    words: int
    half: int | None = None

    def generator(self) -> np.random.Generator:
        """The source at this place."""
        source = np.random.PCG64(self.seed).advance(self.words)
        if self.half is not None:
            source.state = source.state | {"has_uint32": 1, "uinteger": self.half}
        return np.random.Generator(source)


@dataclass(frozen=True)
class Case:
    """A measurement before it is drawn.

    declared: the rig as the declaration has it, where that is not the true one. step: of the analogue-digital
    converter, in the unit of the file. said: further parameters of the declaration. assembled: whether the wheel is
    turned between records by whole turns of the pinion alone, as where nobody takes the gears apart.
    """

    rig: Rig
    runs: tuple[Run, ...]
    sensor: Sensor
    writer: Table | Wav | Encoders
    noise: Noise
    stream: Stream
    remarks: str
    hidden: Hidden | None = None
    declared: Rig | None = None
    gear_torque: str = "balanced"
    step: float | None = None
    said: Mapping[str, Any] = field(default_factory=dict)
    assembled: bool = False

    @property
    def to_find(self) -> str:
        """What a diagnosis should come to: nothing, an effect, another constant, or something it has no name for."""
        if self.hidden is None:
            return NULL
        return {**dict.fromkeys(CONSTANTS, CONSTANT), **dict.fromkeys(FOREIGN, OUTSIDE)}.get(self.hidden.name, EFFECT)


def drawn_runs(case: Case, rng: np.random.Generator) -> tuple[Run, ...]:
    """The records with the angles at which they happen to begin."""
    runs = tuple(_begun(run, rng) for run in case.runs)
    zero, ratio = (rng.uniform(0, ZERO_OF_GEAR), case.rig.teeth) if _one_wheel(case) else (0.0, (0, 0))
    if not isinstance(case.writer, Encoders):
        return tuple(_turned_on(run, zero, ratio, rng) for run in runs) if case.assembled else runs
    runs = tuple(replace(run, tooth=0) for run in runs) if case.assembled else runs
    angles = [rng.uniform(*TURNED) for _ in runs]
    return tuple(
        replace(run, pinion_angle=a, gear_angle=zero + a * ratio[0] / ratio[1], mesh_zero=ENCODER_ZERO)
        for run, a in zip(runs, angles, strict=True)
    )


def _one_wheel(case: Case) -> bool:
    return case.assembled or isinstance(case.writer, Encoders)


def _turned_on(run: Run, zero: float, teeth: tuple[int, int], rng: np.random.Generator) -> Run:
    """The record after some whole turns of the pinion; zero: rad between those of both shafts."""
    turns = int(rng.integers(teeth[1]))
    gear = zero + (run.pinion_angle + 2 * math.pi * turns) * teeth[0] / teeth[1]
    return replace(run, tooth=turns * teeth[0], gear_angle=gear)


def _begun(run: Run, rng: np.random.Generator) -> Run:
    """Angles, zero of the mesh where it has none, and place of the gear, in the order of the stream."""
    pinion, gear = rng.uniform(0, 2 * math.pi), rng.uniform(0, 2 * math.pi)
    zero = rng.uniform() if run.mesh_zero is None else run.mesh_zero
    return replace(run, pinion_angle=pinion, gear_angle=gear, mesh_zero=zero, tooth=int(rng.integers(0, OFFSETS)))


def measured(case: Case) -> tuple[list[Record], float]:
    """The records as the sensor gives them, and the standard deviation of its noise, in the unit of the file."""
    rng = case.stream.generator()
    runs = drawn_runs(case, rng)
    motions = [simulate(case.rig, run, case.hidden) for run in runs]
    if case.sensor.mount:
        clean = [shaken(case.sensor, case.rig, run) for run in runs]
    else:
        clean = [case.sensor.fluctuation(case.rig, motion) for motion in motions]
    std = case.noise.std(clean)
    records = []
    for run, motion, values in zip(runs, motions, clean, strict=True):
        noisy = values + case.noise.drawn(rng, values.size, std)
        seen = noisy if case.step is None else np.round(noisy / case.step) * case.step
        records.append(Record(run, motion, seen + case.sensor.mean(case.rig, motion)))
    return records, std


def write(case: Case, folder: str | Path) -> dict[str, Any]:
    """Write the files and measurement.yaml into a new folder, and return the truth, which stays out of it."""
    folder = Path(folder)
    folder.mkdir(parents=True)
    records, std = measured(case)
    speed, declared = case.writer.states_speed(case.sensor), []
    for number, record in enumerate(records, 1):
        said = case.writer.write(folder, number, record, case.rig, case.sensor)
        role = {"role": record.run.role} if record.run.role else {}
        declared.append(said | role | {"conditions": conditions(case.rig, record.run, case.gear_torque, speed)})
    write_declaration(folder, parameters(case.declared or case.rig) | dict(case.said), declared)
    return truth(case, std)


def truth(case: Case, std: float) -> dict[str, Any]:
    """What is hidden, and what it is hidden in; std: of the noise, in the unit of the file."""
    noise = {"kind": case.noise.kind, "snr_db": case.noise.snr_db, "std": std, "unit": case.sensor.unit}
    return {
        "hidden": case.hidden.name if case.hidden else None,
        "parameters": dict(case.hidden.values) if case.hidden else {},
        "to_find": case.to_find,
        "damping_ratio_percent": round(100 * case.rig.damping_ratio, 4),
        "teeth": list(case.rig.teeth),
        "sensor": "encoders" if isinstance(case.writer, Encoders) else case.sensor.channel,
        "noise": noise | {"step": case.step},
        "natural_frequency": case.rig.natural_frequency,
        "contact_ratio": case.rig.contact_ratio,
        "stiffness": {"law": case.rig.law, "one_pair": case.rig.one_pair, "two_pairs": case.rig.two_pairs},
        "remarks": case.remarks,
    }
