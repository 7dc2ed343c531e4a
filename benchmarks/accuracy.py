"""Is the accuracy asked the accuracy delivered? Every effect in turn, over the range of a machine in the field."""

from math import pi

import torch
from torch import Tensor

from benchmarks.simulating import Log
from gear_damping.physics.catalogue import builtin_effects, effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.physics.terms import MeshStiffness, Sensor
from gear_damping.simulation.prior import Label, Prior, Uniform, draw_values
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

ASKED = (1e-3, 1e-4, 1e-5, 1e-6)
FINE = 192  # sub-steps of what counts as exact
SAMPLING_RATE, N_SAMPLES = 40e3, 400  # 0.01 s: about 50 natural periods
KEPT = ("exponent", "contact_ratio", "maximum", "minimum", "lines", "order")  # as declared
LAW = "power_law_damping"
NEEDED = {"squeeze_film_damping": ("backlash",), "unbalance": ("bearing_flexibility",)}
FIELD = {
    "pinion_torque": Uniform(0.7, 1.3, relative=True), "pinion_speed": Uniform(157.0, 628.0),
    "mesh_phase": Uniform(0.0, 2 * pi), "damping_ratio_percent": Uniform(0.1, 3.0),
    f"{LAW}.exponent": Uniform(1.2, 2.8),
}  # fmt: skip


def tried_effects() -> list[str]:
    """Every effect that takes part in the motion."""
    return sorted(name for name, effect in builtin_effects().items() if not issubclass(effect, Sensor))


def drawn(effect: str, batch: int, seed: int = 0) -> tuple[Model, dict[str, Tensor]]:
    """Gear pairs of the field with one effect more, its amplitudes within a factor of 3 of their defaults.

    An effect that gear pairs do not have is added to an oscillator.
    """
    generator = torch.Generator().manual_seed(seed)
    added = effect_class(effect)
    if not GearPair.has(*added.needs):
        model = Model(Oscillator(), [effect_class("viscous_damping")(), added()])
        values = model.values(batch, **{"viscous_damping.damping_coefficient": 0.02})
        values["initial_displacement"] = 0.2 + 0.8 * _share(batch, generator)
        return model, values | _drawn_parameters(effect, values, generator)
    mesh = [] if issubclass(added, MeshStiffness) else ["fourier_mesh_stiffness"]
    names = dict.fromkeys([*mesh, LAW, *NEEDED.get(effect, ()), effect])
    model = Model(GearPair(), [effect_class(name)() for name in names])
    values, _ = draw_values(model, {}, Prior("field", FIELD), batch, generator, Label(LAW))
    return model, values | ({} if effect == LAW else _drawn_parameters(effect, values, generator))


def _drawn_parameters(effect: str, values: dict[str, Tensor], generator: torch.Generator) -> dict[str, Tensor]:
    found = {}
    for parameter in effect_class(effect).parameters:
        name = f"{effect}.{parameter.name}"
        if parameter.unit != "s" and parameter.name not in KEPT:
            found[name] = _varied(parameter, values[name], generator)
    return found


def _varied(parameter: Parameter, nominal: Tensor, generator: torch.Generator) -> Tensor:
    share = _share(nominal.shape[-1], generator)
    if parameter.name in ("phase", "sine_phase"):
        return (2 * pi * share).expand(nominal.shape)
    return (nominal * 3 ** (2 * share - 1)).clamp(parameter.lower, parameter.upper)


def _share(batch: int, generator: torch.Generator) -> Tensor:
    return torch.rand(batch, generator=generator, dtype=torch.float64)


def delivered(effect: str, batch: int, asked: tuple[float, ...], n_samples: int = N_SAMPLES) -> list[Tensor]:
    """Relative L2 error of each member, (batch,), for each accuracy asked."""
    model, values = drawn(effect, batch)
    rate = SAMPLING_RATE if isinstance(model.system, GearPair) else 1.2  # Hz; the oscillator's rate is 1 rad/s

    def response(solver: Solver) -> Tensor:
        return simulate(model, values, sampling_rate=rate, n_samples=n_samples, solver=solver).response

    exact = response(Solver(substeps=FINE))
    return [(response(Solver(accuracy=a)) - exact).norm(dim=1) / exact.norm(dim=1) for a in asked]


def everything(quick: bool, log: Log) -> list[dict]:
    """Error at the median and the 90th percentile for each effect and each accuracy asked."""
    batch, names = (8, tried_effects()[:2]) if quick else (128, tried_effects())
    return [_row(name, batch, log) for name in names]


def _row(effect: str, batch: int, log: Log) -> dict:
    try:
        errors = delivered(effect, batch, ASKED)
    except Exception as problem:  # the map shows what fails beside what holds
        log(f"  {effect}: {type(problem).__name__}: {problem}")
        return {"effect": effect, "reason": f"{type(problem).__name__}: {problem}"[:200]}
    row: dict = {"effect": effect}
    for asked, error in zip(ASKED, errors, strict=True):
        row[f"p50 of {asked:g}"] = float(error.median())
        row[f"p90 of {asked:g}"] = float(error.quantile(0.9))
    worst = max(row[f"p90 of {asked:g}"] / asked for asked in ASKED)
    log(f"  {effect}: p90 at most {worst:.2g} times what was asked")
    return row | {"p90 / asked, at most": worst}
