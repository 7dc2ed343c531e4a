"""The sentences a run says while it works."""

import logging
from collections.abc import Mapping
from typing import Any

import torch

from gear_damping.config.settings import Settings
from gear_damping.identification.trainer import Training
from gear_damping.physics.damping_ratio import is_far, log_decrement
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import (
    BearingForce,
    ContactChange,
    ElasticForce,
    ExtraStates,
    LoadPath,
    MeshForceFactor,
    StiffnessFactor,
    SystemChange,
)
from gear_damping.reporting.numbers import number, pretty_unit, quantity
from gear_damping.reporting.run_report.training import control_sentences
from gear_damping.simulation.floquet import floquet_multiplier, has_multiplier
from gear_damping.simulation.runs import Runs

# Effects that change stiffness, mass or degrees of freedom, of which a Floquet multiplier knows nothing.
BESIDE_THE_MESH = (
    BearingForce, ContactChange, ElasticForce, ExtraStates, LoadPath, MeshForceFactor, StiffnessFactor, SystemChange,
)  # fmt: skip
log = logging.getLogger("gear_damping").info


def log_budget(settings: Settings, training: Training) -> None:
    """What the run is about to spend."""
    s = settings.simulator
    seeds = f"{settings.seeds} seed" + ("s" if settings.seeds > 1 else "")
    names = ", ".join([*settings.model.names, "white_noise"])
    log(
        f"{settings.name}: {s.n_runs} runs of {s.n_samples} samples, family {s.family.name}, protocol "
        f"{settings.protocol['name']}; {names}, {seeds} from {settings.seed}, at most {training.max_epochs} "
        f"epochs each, batch {training.batch_size}, patience {training.patience}"
    )


def log_runs(settings: Settings, runs: Runs) -> None:
    """What the runs hold: the label in all its forms, at the amplitude that it belongs to."""
    log(_damping(runs, settings.simulator.damping_law))
    if runs.model.system.has(Trait.TEETH):
        _log_stability(runs)
    if runs.n_diverged:
        log(f"{runs.n_diverged} runs diverged and were left out")


def _damping(runs: Runs, law: str | None) -> str:
    """The damping ratios of the runs, or why there are none."""
    ratio = runs.damping_ratio_percent
    if not runs.damping_ratio_by_law:
        return "no damping ratio is stated: the model has no damping law"
    if bool((runs.derived["mean_stiffness"] == 0).any()):
        return "no damping ratio can be stated: there is no linear stiffness, so nothing is critical"
    if nameless := runs.laws_without_ratio:
        which = " and ".join(nameless)
        return f"no damping ratio can be stated: {which} has none that could be worked out at {_velocity(runs)}"
    low, high = float(ratio.min()), float(ratio.max())
    line = f"damping ratio {low:.3f} … {high:.3f} % of critical{_of_laws(runs)}"
    if high < 100:
        delta = log_decrement(torch.tensor([low, high]) / 100)
        line += f", log-decrement {delta[0]:.4f} … {delta[1]:.4f}"
    alpha = runs.values.get(f"{law}.coefficient")
    if alpha is not None:
        exponent = float(runs.values[f"{law}.exponent"][0])
        line += f", alpha {_shown(float(alpha.min()))} … {_shown(float(alpha.max()))}{_unit_of_law(runs, exponent)}"
    return f"{line}, at {_velocity(runs)}{_other_start(runs)}"


def _of_laws(runs: Runs) -> str:
    """What each law adds to the ratio, in brackets; "" where there is one law."""
    by_law = runs.damping_ratio_by_law
    parts = [f"{name} {float(one.min()):.3f} … {float(one.max()):.3f}" for name, one in by_law.items()]
    return f" ({', '.join(parts)})" if len(parts) > 1 else ""


def _velocity(runs: Runs) -> str:
    """The amplitude that ratios are stated at, in words."""
    return f"a velocity amplitude of {quantity(float(runs.reference_velocity[0]), runs.model.system.unit_of('m/s'))}"


def _other_start(runs: Runs) -> str:
    """What is said where an oscillator begins far from the amplitude that its damping ratio is stated at."""
    if not runs.model.system.has(Trait.REST):
        return ""
    stated, start = (float(runs.values[name][0]) for name in ("amplitude", "initial_displacement"))
    if not is_far(stated, start):
        return ""
    at, begins = (quantity(one, runs.model.system.unit_of("m")) for one in (stated, start))
    return (
        f", which is that of simulator.amplitude, {at}; the motion begins at {begins}, "
        "and a damping that depends on the amplitude is another one there"
    )


def _shown(coefficient: float) -> str:
    """A coefficient of a law; of a small one the digits that count."""
    return f"{coefficient:.1f}" if coefficient >= 1 else number(coefficient, 3)


def _unit_of_law(runs: Runs, exponent: float) -> str:
    """The unit of the coefficient of a power law, behind a space; "" where nobody knows it."""
    force, slowness = (runs.model.system.unit_of(unit) for unit in ("N", "s/m"))
    return f" {pretty_unit(force)} ({slowness})^{exponent:g}" if slowness else ""


def _log_stability(runs: Runs) -> None:
    """Whether the mesh of the least damped run makes the motion grow, where that mesh has a multiplier."""
    least = int(runs.damping_ratio_percent.argmin())
    if not has_multiplier(runs, least):
        return
    multiplier = floquet_multiplier(runs, least)
    growth = "its mesh makes the motion grow until contact is lost" if multiplier > 1 else "stable"
    missing = [effect.name for effect in runs.model.effects if isinstance(effect, BESIDE_THE_MESH)]
    without = f"; of its linear mesh alone, without {', '.join(missing)}" if missing else ""
    log(f"largest Floquet multiplier of the least damped run: {multiplier:.4f} ({growth}{without})")


def log_controls(results: Mapping[str, Any]) -> None:
    """What the controls say about the networks' figures."""
    for sentence in control_sentences(results):
        log(sentence)
