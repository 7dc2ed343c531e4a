"""Runs with and without an effect, and what is left when one is taken from the other."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from gear_damping.physics.cause import SHAFTS
from gear_damping.physics.model import Model
from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import TANGENTIAL, Effect, MeshStiffness, Sensor
from gear_damping.reporting.effects_page import cases
from gear_damping.reporting.effects_page.cases import Case, Values
from gear_damping.signals.spectra import amplitude_spectrum
from gear_damping.simulation.driven import Driven
from gear_damping.simulation.observed import motion_of_shaft
from gear_damping.simulation.runs import Runs
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

Array = NDArray[np.float64]
Kinds = Mapping[str, type[Effect]]
MICRO = 1e6  # um in a m


@dataclass(frozen=True)
class Signature:
    """Two records of the same conditions.

    Args:
        place: Turns of the pinion since the first shown sample, or s for an oscillator, (time,).
        with_effect: Record with the effect, (time,), in `unit`.
        without: Record without it.
        unit: Unit of the records.
        orders: Orders of the pinion shaft, or Hz, (order,).
        amplitudes: Spectrum of the residual, peak amplitudes in `unit`.
        amplitudes_without: Spectrum of the record without the effect.
        n_teeth: Order of the mesh; None for an oscillator.
        gear_order: Order of the gear shaft; None for an oscillator.
        natural: The natural frequency on the axis of `orders`.
    """

    place: Array
    with_effect: Array
    without: Array
    unit: str
    orders: Array
    amplitudes: Array
    amplitudes_without: Array
    n_teeth: float | None
    gear_order: float | None
    natural: float

    @property
    def residual(self) -> Array:
        """What the effect adds, (time,)."""
        return self.with_effect - self.without


def signature(kind: type[Effect], known: Kinds, seed: int = 0) -> Signature:
    """The signature of an effect under its conditions (see `cases`).

    Args:
        kind: The effect.
        known: The catalogue, for the effects beside it.
        seed: Of what is drawn (noise).
    """
    case = cases.case_of(kind.name)
    if GearPair.has(*kind.needs):
        return _of_a_gear_pair(kind, known, case, seed)
    return _of_an_oscillator(kind, known, case, seed)


def _of_a_gear_pair(kind: type[Effect], known: Kinds, case: Case, seed: int) -> Signature:
    turns_per_second = case.speed_rpm / 60
    given = {"pinion_speed": 2 * pi * turns_per_second, **case.given}
    rate = cases.SAMPLES_PER_TURN * turns_per_second
    samples = (cases.SETTLING + cases.TURNS) * cases.SAMPLES_PER_TURN
    shown = slice(cases.SETTLING * cases.SAMPLES_PER_TURN, None)
    names = dict(cases.NOMINAL)
    on_shaft = issubclass(kind, Sensor) and kind.channel == TANGENTIAL
    grid = _Grid(rate, samples, seed, on_shaft)
    true = _run(GearPair(), _effects(known, _with(kind, names, case)), given, grid)
    plain = _effects(known, _without(kind, names, case))
    nominal = _run(GearPair(), plain, given, grid)
    scale, unit = MICRO, "µm"
    if on_shaft:
        records, scale, unit = (_across_radius(run, seed) for run in (true, nominal)), 1.0, "m/s²"
    elif issubclass(kind, Sensor) and kind.channel == "pinion_angle":
        angle = true.measured("pinion_angle", _generator(seed))
        # The record is that of the true motion; what differs is the simulation that follows the false angle.
        misled = _run(GearPair(), plain, given, grid, {"pinion_angle": angle})
        records = (nominal.record(_generator(seed)), misled.record(_generator(seed)))
    else:
        records = (true.record(_generator(seed)), nominal.record(_generator(seed)))
    measured, without = (scale * record[0, shown].numpy() for record in records)
    values, derived = nominal.values, nominal.derived
    teeth = float(values["n_teeth_pinion"][0])
    natural = float(derived["natural_frequency"][0]) / (2 * pi * turns_per_second)
    marks = (teeth, teeth / float(values["n_teeth_gear"][0]), natural)
    place = np.arange(len(measured)) / cases.SAMPLES_PER_TURN
    return _signature(place, measured, without, unit, cases.SAMPLES_PER_TURN, marks)


def _across_radius(run: Runs, seed: int) -> Tensor:
    """What an accelerometer records that sits on the pinion's base circle, (batch, time), m/s^2."""
    channel = f"{SHAFTS[0]}_acceleration"
    moves = run.derived["base_radius_pinion"].unsqueeze(1) * motion_of_shaft(run, channel)
    return run.behind_sensors(moves, _generator(seed), seen=[channel])


def _of_an_oscillator(kind: type[Effect], known: Kinds, case: Case, seed: int) -> Signature:
    rate, samples = cases.OSCILLATOR_RATE, cases.OSCILLATOR_SAMPLES
    names, given = dict(cases.OSCILLATOR_NOMINAL), dict(cases.OSCILLATOR_GIVEN)
    grid, inputs = _Grid(rate, samples, seed), {}
    if case.force:
        force = case.force[0] * torch.sin(2 * pi * case.force[1] * torch.arange(samples, dtype=torch.float64) / rate)
        inputs, given = {"force": force.unsqueeze(0)}, given | {"initial_displacement": 0.0}
    true = _run(Oscillator(), _effects(known, _with(kind, names, case)), given | dict(case.given), grid, inputs)
    nominal = _run(Oscillator(), _effects(known, _without(kind, names, case)), given, grid, inputs)
    measured, without = (run.record(_generator(seed))[0].numpy() for run in (true, nominal))
    natural = float(nominal.derived["natural_frequency"][0]) / (2 * pi)
    return _signature(np.arange(samples) / rate, measured, without, "rad", rate, (None, None, natural))


def _signature(
    place: Array,
    measured: Array,
    without: Array,
    unit: str,
    rate: float,
    marks: tuple[float | None, float | None, float],
) -> Signature:
    stack = torch.as_tensor(np.stack([measured - without, without - without.mean()]))
    # Whole turns: every order of the shafts is a line of its own without any window.
    window = "boxcar" if marks[0] else "hann"
    orders, (residual, nominal) = amplitude_spectrum(stack, rate, window)
    arrays = (orders.numpy(), residual.numpy(), nominal.numpy())
    return Signature(place, measured, without, unit, *arrays, *marks)


def _with(kind: type[Effect], nominal: dict[str, Values], case: Case) -> dict[str, Values]:
    """The nominal and further effects, with this one; a mesh stiffness takes the place of the nominal's."""
    if issubclass(kind, MeshStiffness):
        nominal = {name: values for name, values in nominal.items() if name != "fourier_mesh_stiffness"}
    return {**nominal, **case.also, kind.name: case.values}


def _without(kind: type[Effect], nominal: dict[str, Values], case: Case) -> dict[str, Values]:
    return {**nominal, **case.also, **case.without}


class _Grid(NamedTuple):
    """When a run is looked at: samples per second, how many, the seed of what is drawn, and what of it is kept."""

    rate: float
    samples: int
    seed: int
    acceleration: bool = False


def _effects(known: Kinds, chosen: Mapping[str, Values]) -> list[Effect]:
    """Effects with their parameters."""
    return [known[name](**values) for name, values in chosen.items()]


def _run(
    system: System, effects: list[Effect], given: Values, grid: _Grid, inputs: Mapping[str, Tensor] | None = None
) -> Runs:
    model = Model(system, effects)
    values = model.values(1, **given)
    if system.has(Trait.PRELOAD):
        derived = model.prepare(values).derived
        start = derived["mean_load"] / derived["mean_stiffness"]
        values = values | {"initial_displacement": start}
    driven = Driven(inputs or {}, seed=grid.seed)
    kept = Solver(acceleration=grid.acceleration)
    return simulate(model, values, sampling_rate=grid.rate, n_samples=grid.samples, inputs=driven, solver=kept)


def _generator(seed: int) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def strongest(found: Signature, most: int = 4) -> list[tuple[float, float]]:
    """The highest lines of the residual above order 0, highest first, as (order, amplitude in `unit`).

    Args:
        found: The signature.
        most: How many at most; lines below 3 % of the highest, and below 1e-9 of the record, are left out.
    """
    orders, amplitudes = found.orders, found.amplitudes
    inner = amplitudes[1:-1]
    peaks = 1 + np.flatnonzero((inner >= amplitudes[:-2]) & (inner > amplitudes[2:]))
    ranked = peaks[np.argsort(-amplitudes[peaks])][:most]
    if not len(ranked):
        return []
    least = max(0.03 * amplitudes[ranked[0]], 1e-9 * np.abs(found.without).max())
    return [(float(orders[i]), float(amplitudes[i])) for i in ranked if amplitudes[i] >= least]
