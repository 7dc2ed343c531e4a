"""A wave of negative amplitude is one of positive amplitude half a turn away: the one that is reported."""

from collections.abc import Iterable
from dataclasses import replace
from math import pi, remainder

from gear_damping.explanation.model.candidates import Candidate
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.identification.output_error.problem import Prediction
from gear_damping.identification.output_error.records import SEPARATOR


def phase_of_strength(candidate: Candidate) -> dict[str, str]:
    """The name of the phase of every strength that has one, shared by all records or each record's own."""
    common = [parameter.name for parameter in candidate.hypothesis.common]
    shared = {common[place]: common[phase] for place, phase in candidate.phases.items()}
    own = {} if candidate.own_levels else candidate.own_phases
    return shared | {common[place]: phase for place, phase in own.items()}


def positive(outcome: Outcome, candidates: Iterable[Candidate]) -> Outcome:
    """The same motion with positive amplitudes.

    Args:
        outcome: A fitted model.
        candidates: Its causes as they were tried.
    """
    phases = {name: phase for one in candidates for name, phase in phase_of_strength(one).items()}
    places = {parameter.name: place for place, parameter in enumerate(outcome.problem.free)}
    negative = [name for name in phases if name in places and outcome.values[name] < 0]
    return _turned(outcome, negative, {phases[name] for name in negative}) if negative else outcome


def _turned(outcome: Outcome, negative: Iterable[str], phases: set[str]) -> Outcome:
    values, shared = dict(outcome.values), outcome.fitted.shared.clone()
    predictions = [one and copied(one) for one in (outcome.fitted.prediction, outcome.whitened)]
    for place, parameter in enumerate(outcome.problem.free):
        name = parameter.name
        if name in negative:
            values[name] = -values[name]
            for one in filter(None, predictions):
                one.sensitivity[..., place] *= -1
        elif name.partition(SEPARATOR)[0] in phases:
            values[name] = remainder(values[name] + pi, 2 * pi)
        else:
            continue
        shared[place] = (values[name] - parameter.start) / parameter.scale
    own = {n: remainder(v + pi, 2 * pi) if n.partition(SEPARATOR)[0] in phases else v for n, v in outcome.own.items()}
    fitted = replace(outcome.fitted, shared=shared, prediction=predictions[0])
    return replace(outcome, fitted=fitted, values=values, own=own, whitened=predictions[1])


def copied(prediction: Prediction) -> Prediction:
    """The prediction with sensitivities of its own, which may be scaled."""
    return replace(prediction, sensitivity=prediction.sensitivity.clone())
