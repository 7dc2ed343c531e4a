"""Networks asked about runs with an effect that the configured simulator does not have, one effect after another."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from statistics import fmean
from typing import Any

import torch
from torch import Tensor

from gear_damping.config.simulator import SENSOR_NOISE
from gear_damping.errors import InputError, Problem, nearest
from gear_damping.identification.asked import estimates_of
from gear_damping.identification.bench import noise_of
from gear_damping.identification.evaluation import scores
from gear_damping.identification.known_model.estimate import Estimates
from gear_damping.identification.lightning_module import DampingModule
from gear_damping.physics.catalogue import catalogue
from gear_damping.physics.model import Model
from gear_damping.physics.terms import Effect
from gear_damping.simulation.plan import SimulationPlan, run_plan

KEY, CHOICE = "evaluation.effects", ":"  # between an effect and one of its forms, torque_variation:ramp
FIGURES = ("rmse_percent", "median_relative_error", "coverage90")
Modules = Mapping[str, Sequence[DampingModule]]  # of several seeds, by what they are called


def plans_with(plan: SimulationPlan, names: Sequence[str]) -> dict[str, SimulationPlan]:
    """The plan with each of these effects added at its declared values, by the name that was asked for.

    Raises:
        InputError: an effect or a form is unknown, is there already, or does not go with the model.
    """
    found, problems, known = {}, [], catalogue(plan.plugins)
    for name in names:
        effect = _effect(name, known)
        if isinstance(effect, Problem):
            problems.append(effect)
            continue
        try:
            found[name] = replace(plan, model=Model(plan.model.system, (*plan.model.effects, effect)))
        except InputError as error:
            problems += [replace(problem, key=f"{KEY}: {name}") for problem in error.problems]
    if problems:
        raise InputError(problems)
    return found


def _effect(asked: str, known: Mapping[str, type[Effect]]) -> Effect | Problem:
    """An effect, in one of its forms where that is said."""
    name, _, form = asked.partition(CHOICE)
    if name not in known:
        return Problem(KEY, "no such effect", name, nearest(name, list(known)))
    forms = {str(choice): {option.name: choice} for option in known[name].options for choice in option.choices}
    if form and form not in forms:
        return Problem(KEY, f"{name} has no such form", form, nearest(form, list(forms)))
    return known[name](**forms.get(form, {}))


def asked_with_effects(
    plans: Mapping[str, SimulationPlan], modules: Modules, levels: Sequence[float], mean: float
) -> dict[str, Any]:
    """Error, coverage and share of strange records of every network, by effect and level of noise.

    Args:
        plans: By effect.
        modules: The networks.
        levels: Signal-to-noise ratios of the sensor, dB.
        mean: Of the family's damping ratios, in %.
    """
    found: dict[str, Any] = {}
    for name, plan in plans.items():
        runs = run_plan(plan)
        signals = runs.record(torch.Generator().manual_seed(plan.seed + 2), skip=(SENSOR_NOISE,))
        true = runs.stated_ratio_percent.double()  # what networks learn; an effect that damps adds nothing to it
        found[name] = {}
        for snr in levels:
            noise = signals.std(-1, correction=0) * 10 ** (-snr / 20)
            records = signals + noise[:, None] * noise_of(signals.shape, plan.seed, snr)
            rows = {key: _of_seeds(own, records, true, mean) for key, own in modules.items()}
            nothing = scores(true, Estimates.without_interval(torch.full_like(true, mean)), None, mean)
            found[name][f"{snr:g}"] = rows | {"mean": {key: nothing[key] for key in FIGURES}}
    return found


def _of_seeds(own: Sequence[DampingModule], records: Tensor, true: Tensor, mean: float) -> dict[str, float | None]:
    """Means over the trainings of one estimator."""
    each = []
    for module in own:
        figures = scores(true, estimates_of(module, records), None, mean)
        strange = strange_share(module, records)
        each.append({key: figures[key] for key in FIGURES} | ({} if strange is None else {"strange": strange}))
    return {key: None if each[0][key] is None else fmean(one[key] for one in each) for key in each[0]}


def strange_share(module: DampingModule, records: Tensor) -> float | None:
    """The share of records (runs, time) that a network calls unlike its training; None where it cannot tell."""
    if module.components is None or records.shape[1] < module.components.samples:
        return None
    return float(module.components.strange(records).double().mean())
