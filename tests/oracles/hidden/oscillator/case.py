"""Draw hidden oscillators: excitation, sensor, units, rates; size the effect for the channel that is written."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field, replace

import numpy as np

from ..effect import between as log_uniform
from ..sensor import coloured
from .calibrate import Seen, excess
from .inputs import KINDS, NONE, Input, drawn
from .laws import OSCILLATOR_EFFECTS, Law, Params, Scales, members
from .motion import STEP, Motion, move, reading

CHANNELS = ("displacement", "velocity", "acceleration")
# unit of the reading, with one natural amplitude of it: low and high
UNITS: dict[str, dict[str, tuple[float, float]]] = {
    "displacement": {"mm": (0.2, 8.0), "m": (2e-4, 2e-2), "V": (0.05, 4.0), "deg": (4.0, 40.0), "rad": (0.07, 0.7)},
    "velocity": {
        "mm/s": (5.0, 400.0), "m/s": (5e-3, 0.4), "V": (0.05, 4.0), "rad/s": (0.2, 4.0), "deg/s": (10.0, 200.0)},
    "acceleration": {"m/s^2": (0.5, 50.0), "gn": (0.05, 5.0), "V": (0.05, 4.0), "rad/s^2": (1.0, 40.0)},
}  # fmt: skip
FORCE_UNITS = ("N", "V", "N*m")
ANGLES = {"deg": 180.0 / np.pi, "rad": 1.0, "deg/s": 180.0 / np.pi, "rad/s": 1.0, "rad/s^2": 1.0}
LADDER = 6  # sizes on trial
NEEDS_AN_INPUT = ("sensor_delay", "sensor_lowpass")  # a free decay that comes late is a free decay
RATES = (200.0, 250.0, 333.0, 500.0, 1000.0, 2000.0, 5000.0)


@dataclass(frozen=True, eq=False)
class OscillatorRecord:
    """One record in own units: stamps / s, response and force (n,), role; even: whether the stamps are."""

    name: str
    role: str
    rate: float
    time: np.ndarray
    response: np.ndarray
    force: np.ndarray | None
    even: bool


@dataclass(frozen=True, eq=False)
class OscillatorCase:
    """A measurement of an oscillator with something hidden in it; `truth` is JSON-able and tells everything."""

    stratum: str
    seed: int
    channel: str
    unit: str
    force_unit: str
    arbitrary: bool
    records: tuple[OscillatorRecord, ...]
    nominal: dict[str, dict[str, float | str]]
    truth: dict[str, object] = field(repr=False)

    @property
    def first(self) -> tuple[OscillatorRecord, ...]:
        """All records: none are added later."""
        return self.records


@dataclass
class _Draft:
    law: Law | None
    params: Params
    zeta: float
    frequency: float
    channel: str
    unit: str
    arbitrary: bool
    forces: list[Input]
    start: np.ndarray  # (2, record)
    lengths: np.ndarray  # natural time
    held_out: list[bool]
    kind: str

    @property
    def order(self) -> int:
        return CHANNELS.index(self.channel)


def draw_oscillator(
    stratum: str,
    seed: int,
    *,
    channel: str | None = None,
    kind: str | None = None,
    periods: float | None = None,
    snr_db: float | None = None,
    target_excess: float | None = None,
    unit: str | None = None,
    force_snr_db: float | None = None,
) -> OscillatorCase:
    """A case; the same arguments draw the same case.

    stratum: an effect, or `null`. channel: displacement, velocity or acceleration; kind: multisine, random, sweep or
    decay; periods: of each record; snr_db; target_excess: D / % in that channel; unit: all drawn where None.
    force_snr_db: of the measured force, white; none where None.
    """  # fmt: skip
    if stratum != "null" and stratum not in OSCILLATOR_EFFECTS:
        raise ValueError(f"no oscillator {stratum!r}; choose null or one of {', '.join(OSCILLATOR_EFFECTS)}")
    source = np.random.default_rng([zlib.crc32(f"oscillator {stratum}".encode()), seed])
    rig, sizes, writing, noise = source.spawn(4)
    draft = _draft(stratum, rig, channel, kind, periods, unit)
    target = log_uniform(sizes, 0.5, 20.0) if target_excess is None else target_excess
    level = float(sizes.uniform(20.0, 40.0)) if snr_db is None else snr_db
    sized = _sized(draft, target)
    desk = _desk(draft, sized, level, writing)
    records = _with_noise(_records(draft, sized, desk, writing, noise), force_snr_db, noise)
    truth = {"stratum": stratum, "seed": seed} | _truth(draft, sized, desk, target)
    truth |= {"snr_db": level, "rates": [r.rate for r in records], "even": records[0].even}
    nominal = _nominal(truth, writing)
    return OscillatorCase(stratum, seed, draft.channel, draft.unit, desk.force_unit, draft.arbitrary, records, nominal,
                          truth)  # fmt: skip


def _draft(stratum, rng, channel, kind, periods, unit) -> _Draft:
    law = OSCILLATOR_EFFECTS.get(stratum)
    params = law.draw(rng) if law else {}
    zeta, frequency = log_uniform(rng, 0.003, 0.05), log_uniform(rng, 0.3, 200.0)
    drawn_channel, drawn_kind = str(rng.choice(CHANNELS)), str(rng.choice((*KINDS, "decay")))
    channel, kind = channel or drawn_channel, kind or drawn_kind
    if stratum in NEEDS_AN_INPUT and kind == "decay":
        kind = "random"
    units = [u for u in UNITS[channel] if law is None or not law.units or u in ANGLES]
    drawn_unit, arbitrary = str(rng.choice(units)), channel == "displacement" or rng.random() < 0.4
    free = kind == "decay"
    levels = np.array([0.5, 0.75, 1.0, 0.65, 0.9])[: 4 if free else 5]
    length = periods or (min(60.0, np.log(8.0) / (2.0 * np.pi * zeta)) if free else rng.uniform(25.0, 50.0))
    lengths = 2.0 * np.pi * max(length, 8.0) * rng.uniform(0.9, 1.1, levels.size)
    forces = [NONE if free else drawn(kind, level, zeta, span, rng)
              for level, span in zip(levels, lengths, strict=True)]  # fmt: skip
    turn = rng.uniform(0.0, 2.0 * np.pi, levels.size)
    start = levels * np.stack([np.cos(turn), np.sin(turn)]) * (1.2 if free else 0.3)
    held_out = [level in (0.65, 0.9) for level in levels]
    return _Draft(law, params, zeta, frequency, channel, unit or drawn_unit, arbitrary, forces, start, lengths,
                  held_out, kind)  # fmt: skip


def _moved(draft: _Draft, trials: list[Params]) -> tuple[Motion, dict[str, np.ndarray]]:
    """The records with each of these parameters, all members together."""
    count = len(draft.forces)
    knobs = [{"zeta": draft.zeta} | (draft.law.knobs(p) if draft.law else {}) for p in trials]
    p = members([k for k in knobs for _ in range(count)])
    start = np.tile(draft.start, len(trials))
    return move(p, draft.forces * len(trials), start, float(draft.lengths.max())), p


def _excess(draft: _Draft, motion: Motion, p: dict[str, np.ndarray], first: int) -> float:
    """Of the members from `first` on."""
    responses, forces = [], []
    for i, span in enumerate(draft.lengths):
        t = motion.time[: int(span / STEP)]
        responses.append(reading(motion, p, first + i, t, draft.order))
        forces.append(draft.forces[i](t))
    return excess(Seen(responses, forces, draft.held_out, draft.order, draft.arbitrary, draft.zeta))


@dataclass
class _Sized:
    """Parameters of the effect, the motion with them, members of its knobs, and the excess / %."""

    params: Params
    motion: Motion
    knobs: dict[str, np.ndarray]
    reached: float


def _sized(draft: _Draft, target: float) -> _Sized:
    """Parameters whose excess is the target, or the nearest on trial."""
    if draft.law is None:
        motion, p = _moved(draft, [{}])
        return _Sized({}, motion, p, _excess(draft, motion, p, 0))
    sizes = np.geomspace(draft.law.least, 1.0, LADDER)
    motion, p = _moved(draft, [draft.law.at(draft.params, s) for s in sizes])
    left = np.array([_excess(draft, motion, p, i * len(draft.forces)) for i in range(LADDER)])
    sound = np.cumprod(np.isfinite(left)).astype(bool)
    logs = np.log(sizes[sound]), np.maximum.accumulate(np.log(left[sound] + 1e-9)) + 1e-9 * np.arange(sound.sum())
    size = float(np.exp(np.interp(np.log(target), logs[1], logs[0])))
    for attempt in range(3):
        params = draft.law.at(draft.params, size)
        motion, p = _moved(draft, [params])
        reached = _excess(draft, motion, p, 0)
        if attempt == 2 or 0.8 < reached / target < 1.25:
            break
        logs = tuple(np.sort(np.append(log, np.log(new))) for log, new in zip(logs, (size, reached), strict=True))
        size = float(np.exp(np.interp(np.log(target), logs[1], logs[0])))
    return _Sized(params, motion, p, reached)


@dataclass
class _Desk:
    """How the motion is written down: scales of all units, noise (natural, and its correlation), zero, sampling."""

    scales: Scales
    force_unit: str
    force_scale: float
    sigma: float
    colour: float
    datum: float
    dense: float  # samples a natural period
    mixed: bool  # rates differ from record to record
    jitter: bool


def _desk(draft: _Draft, sized: _Sized, snr_db: float, rng: np.random.Generator) -> _Desk:
    scales = _scales(draft, sized.params, rng)
    clean = [reading(sized.motion, sized.knobs, i, sized.motion.time[: int(span / STEP)], draft.order)
             for i, span in enumerate(draft.lengths)]  # fmt: skip
    sigma = float(np.sqrt(np.mean([np.var(y) for y in clean]))) * 10.0 ** (-snr_db / 20.0)
    return _Desk(
        scales, str(rng.choice(FORCE_UNITS)), log_uniform(rng, 0.1, 50.0), sigma,
        colour=float(rng.choice([0.0, 0.0, 0.3, 0.6])),
        datum=float(rng.uniform(-4.0, 4.0)) if draft.arbitrary else 0.0,
        dense=float(rng.uniform(10.0, 18.0)), mixed=bool(rng.random() < 0.5), jitter=bool(rng.random() < 0.4),
    )  # fmt: skip


def _records(draft: _Draft, sized: _Sized, desk: _Desk, rng, noise) -> tuple[OscillatorRecord, ...]:
    records = []
    for i, span in enumerate(draft.lengths):
        denser = float(rng.choice([1.0, 1.25, 1.667])) if desk.mixed else 1.0
        rate = _rate(desk.dense * denser * draft.frequency)
        t = np.arange(int(span / (2.0 * np.pi * draft.frequency) * rate)) / rate
        stamps = t + (rng.uniform(-0.07, 0.07, t.size) / rate if desk.jitter else 0.0)
        stamps = stamps - stamps[0]
        own = stamps * desk.scales.rate
        added = desk.sigma * coloured(noise.normal(size=(t.size, 1)), desk.colour)[:, 0]
        zero = desk.datum + (0.01 * noise.normal() if draft.arbitrary else 0.0)
        y = (reading(sized.motion, sized.knobs, i, own, draft.order, added) + zero) * desk.scales.reading
        force = None if draft.kind == "decay" else draft.forces[i](own) * desk.force_scale
        role = "holdout" if draft.held_out[i] else "fit"
        records.append(OscillatorRecord(f"run_{i + 1}", role, rate, stamps, y, force, not desk.jitter))
    return tuple(records)


def _with_noise(records: tuple[OscillatorRecord, ...], snr_db: float | None, noise) -> tuple[OscillatorRecord, ...]:
    """Records whose measured force has noise of its own."""
    if snr_db is None:
        return records
    share = 10.0 ** (-snr_db / 20.0)
    return tuple(replace(r, force=r.force + share * r.force.std() * noise.normal(size=r.force.size)) for r in records)


def _truth(draft: _Draft, sized: _Sized, desk: _Desk, target: float) -> dict[str, object]:
    """Everything in the units of the file; per mass."""
    scales, law = desk.scales, draft.law
    effects = [] if law is None else [
        {"name": law.name, "parameters": law.own(sized.params, scales), "target_percent": target,
         "excess_percent": sized.reached, "invariants": {}}]  # fmt: skip
    return {
        "system": "oscillator", "channel": draft.channel, "kind": draft.kind, "unit": draft.unit, "fault": None,
        "noise_std": desk.sigma * scales.reading, "colour": desk.colour, "in_catalogue": True,
        "damping_ratio_percent": 100.0 * draft.zeta, "natural_frequency": draft.frequency,
        "stiffness": scales.rate**2, "damping_coefficient": 2.0 * draft.zeta * scales.rate,
        "force_gain": scales.amplitude * scales.rate**2 / desk.force_scale, "excess_percent": sized.reached,
        "effects": effects,
    }  # fmt: skip


def _scales(draft: _Draft, params: Params, rng) -> Scales:
    """One natural unit of everything; a pendulum's amplitude is an angle that its law knows."""
    rate = 2.0 * np.pi * draft.frequency
    drawn_reading = log_uniform(rng, *UNITS[draft.channel][draft.unit])
    if draft.law is not None and draft.law.units:
        drawn_reading = params["angle"] * ANGLES[draft.unit] * rate**draft.order
    return Scales(drawn_reading / rate**draft.order, rate, drawn_reading)


def _rate(wanted: float) -> float:
    """A rate that a logger has, or three digits."""
    near = [rate for rate in RATES if 0.9 < rate / wanted < 1.15]
    return near[0] if near else float(f"{wanted:.3g}")


def _nominal(truth, rng) -> dict[str, dict[str, float | str]]:
    """What the user says of the rig: in half of the cases nothing, else it is a few per cent wrong."""
    if rng.random() < 0.5:
        return {}
    stated = {"stiffness": ("1/s^2", 0.06), "damping_coefficient": ("1/s", 0.3)}
    return {name: {"value": float(truth[name] * (1.0 + rng.uniform(-off, off))), "unit": unit}
            for name, (unit, off) in stated.items()}  # fmt: skip
