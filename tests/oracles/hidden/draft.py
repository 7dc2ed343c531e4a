"""What a case will be before anything is integrated: plan, rig, effects, targets, errors of the nominal values."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from . import pair
from .catalogue import EFFECTS, FAULTS, FOREIGN, HIDDEN, PAIRS, STRATA
from .effect import Effect, Params, between, phase
from .knobs import Knobs, stack
from .pair import USUAL, Rig
from .plans import PLANS, Condition
from .rigs import rig_of
from .scales import carried_over
from .setup import Setup, setup_of
from .stiffness import mean_stiffness

CATALOGUE = HIDDEN | FOREIGN
SETTLE = 250  # samples of the usual rig before the record begins


@dataclass(frozen=True)
class Wanted:
    """What is asked for.

    duration: s on the usual rig; elsewhere as many natural periods, or as many turns of the gear. snr_db, target: of
    the channel, and excess / %; drawn where None. rig: see rigs.rig_of; sensors: see setup.setup_of. chosen:
    parameters of the first effect that are not left to chance. size: of every effect, as a share of its largest, in
    the place of the excess. gear_apart: between the records the pinion has turned by whole turns that nobody counted.
    """

    stratum: str
    seed: int
    duration: float = 0.05
    snr_db: float | None = None
    target: float | None = None
    rig: str | Rig | None = None
    sensors: str | Setup | None = None
    chosen: Mapping[str, float | str] = field(default_factory=dict)
    size: float | None = None
    gear_apart: bool = False


@dataclass
class Draft:
    """A case to be sized and run. params are at the largest size; targets in %, None where there is no size."""

    stratum: str
    seed: int
    plan: str
    conditions: list[Condition]
    records: list[Knobs]  # without the effects, but with what the nominal model has of them
    effects: list[Effect]
    params: list[Params]
    targets: list[float | None]
    snr_db: float
    fault: str | None
    nominal: dict[str, dict[str, float | str]]
    shape: dict[str, float]
    start: np.ndarray  # (2, record): off the equilibrium, in shares of deflection and speed
    noise: np.random.Generator
    rig: Rig
    setup: Setup
    n: int  # samples of each record
    usual: bool  # neither rig nor sensors were asked for

    @property
    def settle(self) -> int:
        """Samples before the record begins."""
        return round(SETTLE * self.rig.rate / USUAL.rate * self.rig.scale(time=1))


def draft(wanted: Wanted) -> Draft:
    """Draw a case; the same arguments draw the same case."""
    stratum, seed = wanted.stratum, wanted.seed
    if stratum not in STRATA and stratum not in FOREIGN:
        raise ValueError(f"no stratum {stratum!r}; choose one of {', '.join((*STRATA, *FOREIGN))}")
    source = np.random.default_rng([zlib.crc32(stratum.encode()), seed])
    choice, rig, plan_source, sizes, nominal_source, noise = source.spawn(6)
    further = [np.random.default_rng([zlib.crc32(stratum.encode()), seed, i]) for i in (1, 2, 3)]
    names, plan = _contents(stratum, seed, choice)
    bench = rig_of(wanted.rig, further[0])
    setup = setup_of(wanted.sensors, bench, names, further[1])
    n = _samples(wanted, bench, further[2])
    duration = wanted.duration if bench is USUAL else n / bench.rate
    effects = [CATALOGUE[name] for name in names]
    plan = plan or next((effect.plan for effect in effects if effect.plan != "full"), "full")
    given = {name: value * bench.scale(length=1) for effect in effects for name, value in effect.given.items()}
    conditions = [_on(bench, condition) for condition in PLANS[plan](plan_source)]
    shape = _rig(rig, plan, stratum, bench)
    if wanted.sensors is not None and setup.name != "full":
        shape["held"] = 0.0
    records = [bench.knobs() | shape | given | _record(rig, condition, duration, bench) for condition in conditions]
    if wanted.gear_apart:
        records = [record | {"gear_phase": record["gear_phase"] + turned} for record, turned in
                   zip(records, _uncounted(wanted, bench, len(records)), strict=True)]  # fmt: skip
    targets = [_target(sizes, wanted.target) if effect.has_size else None for effect in effects]
    if stratum == "unbalance":
        targets[0] = 2.0  # the bearing that it needs
    params = [_params(effect, sizes, duration, bench, setup) for effect in effects]
    if effects:
        params[0] |= wanted.chosen
    if wanted.size is not None:
        params = [effect.at(drawn, wanted.size) for effect, drawn in zip(effects, params, strict=True)]
        targets = [None for _ in effects]
    return Draft(
        stratum, seed, plan, conditions, records, effects, params,
        targets, float(sizes.uniform(20.0, 40.0)) if wanted.snr_db is None else wanted.snr_db,
        FAULTS[seed % len(FAULTS)] if stratum == "data_fault" else None,
        _nominal(nominal_source, shape, given, bench), shape, 0.03 * noise.normal(size=(2, len(conditions))), noise,
        bench, setup, n, wanted.rig is None and wanted.sensors is None,
    )  # fmt: skip


def _uncounted(wanted: Wanted, bench: Rig, records: int) -> list[float]:
    """Angles of the gear / rad by whole turns of the pinion, of a source of their own."""
    source = np.random.default_rng([zlib.crc32(wanted.stratum.encode()), wanted.seed, 4])
    turns = source.integers(0, bench.teeth[1], records)
    return [float(2.0 * np.pi * turn * bench.teeth[0] / bench.teeth[1]) for turn in turns]


def _samples(wanted: Wanted, bench: Rig, rng: np.random.Generator) -> int:
    """Of each record; on other rigs so many that the gear turns about as far."""
    usual = round(wanted.duration * USUAL.rate)
    if replace(bench, either_shaft=False) == USUAL:
        return usual
    longer = bench.scale(time=1) * bench.teeth[1] / USUAL.teeth[1] * rng.uniform(0.9, 1.3)
    return round(wanted.duration * longer * bench.rate)


def _on(bench: Rig, condition: Condition) -> Condition:
    """The condition at the same share of the natural frequency and the same share of the largest load."""
    faster, stronger = bench.scale(turn=-1), bench.scale(force=1, radius=1)
    return replace(condition, speed=condition.speed * faster, torque=condition.torque * stronger,
                   swing=condition.swing * stronger)  # fmt: skip


def _params(effect: Effect, rng: np.random.Generator, duration: float, bench: Rig, setup: Setup) -> Params:
    params = effect.draw(rng, duration)
    if bench.either_shaft and effect.on_rig is not None:
        params |= effect.on_rig(rng, bench)
    return carried_over(effect.name, params, bench, setup.reading(bench))


def _contents(stratum: str, seed: int, choice: np.random.Generator) -> tuple[list[str], str | None]:
    """Names of the effects, and the plan where the stratum says it."""
    ordinary = [name for name in EFFECTS if HIDDEN[name].plan == "full" and name != "unbalance"]
    if stratum == "unbalance":
        return ["bearing_flexibility", "unbalance"], None
    if stratum in CATALOGUE:
        return [stratum], None
    if stratum == "pairs":
        return list(PAIRS[seed % len(PAIRS)]), None
    if stratum == "outside":
        return [tuple(FOREIGN)[seed % len(FOREIGN)]], None
    if stratum == "tacho_error":
        companions = [name for name in ordinary if name != "shaft_angle_error"]
        return ["shaft_angle_error", *([str(choice.choice(companions))] if seed % 2 else [])], None
    if stratum in ("one_record", "one_condition"):
        return [str(choice.choice(ordinary))], stratum
    return [], None


def _target(rng: np.random.Generator, target: float | None) -> float:
    """Excess aimed at / %: mostly 0.5 to 20, a quarter of the cases 0.1 to 0.5."""
    drawn = between(rng, 0.5, 20.0) if rng.random() < 0.75 else between(rng, 0.1, 0.5)
    return drawn if target is None else target


def _rig(rng: np.random.Generator, plan: str, stratum: str, bench: Rig) -> dict[str, float]:
    """The true pair: stiffness, its shape, damping, phases; a null differs from the nominal by shape alone."""
    loose = 1.6 if stratum == "null" else 1.0
    shape = {
        "one_pair": bench.one_pair * rng.uniform(0.9, 1.1), "contact_ratio": rng.uniform(*bench.contact_ratio),
        "edge": rng.uniform(0.06, 0.2 * loose), "crown": rng.uniform(0.0, 0.15 * loose),
        "lean": rng.uniform(-0.1, 0.1) * loose, "mesh_phase": phase(rng), "gear_phase": phase(rng),
        "held": float(rng.random() < 0.5),
    }  # fmt: skip
    shape["two_pairs"] = shape["one_pair"] * rng.uniform(1.7, 2.05)
    ratio = between(rng, 0.006, 0.015) if plan == "light" else between(rng, 0.015, 0.05)
    shape["viscous"] = 2.0 * ratio * float(np.sqrt(true_mean_stiffness(shape) * bench.mass))
    return {name: float(value) for name, value in shape.items()}


def true_mean_stiffness(shape: Knobs) -> float:
    """Mean stiffness / (N/m) of a rig."""
    return float(mean_stiffness(stack([shape]))[0])


def _record(rng: np.random.Generator, condition: Condition, duration: float, bench: Rig) -> Knobs:
    speed = pair.rpm(condition.speed * rng.uniform(0.997, 1.003))
    sway = 2.0 * np.pi * rng.uniform(2.0, 6.0)
    return {
        "speed": speed, "angle": float(rng.uniform(0.0, 2.0 * np.pi)), "mass": bench.mass,
        "wander": 1e-4 * speed / sway, "wander_rate": sway, "wander_phase": phase(rng),
        "torque": condition.torque, "flutter": 0.002 * rng.uniform(0.3, 1.0),
        "flutter_rate": 2.0 * np.pi * rng.uniform(2.0, 8.0), "flutter_phase": phase(rng),
        "swing": condition.swing, "swing_rate": 2.0 * np.pi / duration, "swing_phase": phase(rng),
    }  # fmt: skip


def _nominal(rng: np.random.Generator, shape: Knobs, given: Knobs, bench: Rig) -> dict[str, dict[str, float | str]]:
    """What the user states: teeth and inertias as they are, the mesh a few per cent wrong, the phase not at all."""
    mean = true_mean_stiffness(shape)
    ratio = shape["viscous"] / (2.0 * np.sqrt(mean * bench.mass))
    contact_ratio = shape["contact_ratio"] + rng.uniform(-0.05, 0.05)
    contrast = (shape["two_pairs"] - shape["one_pair"]) * (1.0 + rng.uniform(-0.08, 0.08))
    low = mean * (1.0 + rng.uniform(-0.04, 0.04)) - contrast * (contact_ratio - 1.0)
    stated = {
        "n_teeth_pinion": (bench.teeth[0], "1"), "n_teeth_gear": (bench.teeth[1], "1"),
        "module": (bench.module * 1e3, "mm"), "pressure_angle": (round(np.degrees(bench.pressure_angle), 9), "deg"),
        "inertia_pinion": (bench.inertia[0], "kg*m^2"), "inertia_gear": (bench.inertia[1], "kg*m^2"),
        "mesh_stiffness_max": (low + contrast, "N/m"), "mesh_stiffness_min": (low, "N/m"),
        "contact_ratio": (contact_ratio, "1"), "damping_ratio": (ratio * rng.uniform(0.75, 1.3), "1"),
    }  # fmt: skip
    if "gap" in given:
        stated["backlash_gap"] = (given["gap"] * 1e6, "um")
    return {name: {"value": float(value), "unit": unit} for name, (value, unit) in stated.items()}
