"""A simulation as a hypothesis: base system, effects, what is known, what is free, and its fit to the evidence."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite

import torch
from torch import Tensor

from gear_damping.explanation.evidence.noise import Scatter
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.identification.output_error.least_squares import Fitted
from gear_damping.identification.output_error.problem import OutputErrorProblem, Prediction
from gear_damping.identification.output_error.records import SEPARATOR, FreeParameter
from gear_damping.identification.output_error.segments import Segments
from gear_damping.identification.output_error.unknowns import GAIN, is_of_model
from gear_damping.identification.time_scale import characteristic_time
from gear_damping.physics.model import Model
from gear_damping.physics.systems.base import System
from gear_damping.physics.terms import Effect

SEGMENT_TIMES = 5.0  # characteristic times of a segment of a record that cannot be predicted for longer
Given = dict[str, float | tuple[float, ...]]


@dataclass(frozen=True)
class Hypothesis:
    """A simulator with free parameters.

    Args:
        system: The base.
        effects: Its effects.
        given: Known values by flat name.
        free: What is fitted.
        causes: Names of the effects beyond the nominal model.
        gains: Of channels whose gain is known with an uncertainty only, as fitted.
        replaced: Free parameters that causes took the place of, by cause.
    """

    system: System
    effects: tuple[Effect, ...]
    given: Given
    free: tuple[FreeParameter, ...]
    causes: tuple[str, ...] = ()
    gains: Mapping[str, float] = field(default_factory=dict)
    replaced: Mapping[str, tuple[FreeParameter, ...]] = field(default_factory=dict)

    @property
    def common(self) -> tuple[FreeParameter, ...]:
        """Free parameters that all records share, in the order of the fit's coordinates."""
        return tuple(parameter for parameter in self.free if not parameter.per_record)

    @property
    def model(self) -> Model:
        """The simulator."""
        return Model(self.system, self.effects)

    def with_effect(
        self, effects: Sequence[Effect], given: Given, free: Sequence[FreeParameter], cause: str
    ) -> "Hypothesis":
        """The same with an effect more."""
        return replace(
            self,
            effects=(*self.effects, *effects),
            given=self.given | given,
            free=(*self.free, *free),
            causes=(*self.causes, cause),
        )


@dataclass(frozen=True)
class Outcome:
    """A fitted hypothesis and what it leaves.

    Args:
        hypothesis: With the fitted values as the starts of its free parameters.
        problem: The fit's statement.
        fitted: The fit.
        values: Fitted values by flat name.
        left_out: Residuals of fitted records, each operating condition by parameters fitted to the others, the channels
            of a record one after another: by these, models are compared. Where held-out records are not sealed they
            are those of these.
        fit_residuals: Residuals of fitted records.
        scatter: What errors of the parameters add to the residuals that are left out.
        error_amplification: How much an error of the initial state grows over a record, in the one where it grows most.
        holdout: Residuals of held-out records; empty until they are opened.
        own: What held-out records have of their own, by name.
        whitened: The linearisation made white where what is random hangs together; None where it is white.
    """

    hypothesis: Hypothesis
    problem: OutputErrorProblem
    fitted: Fitted
    values: dict[str, float]
    left_out: list[Tensor] = field(repr=False)
    fit_residuals: list[Tensor] = field(repr=False)
    scatter: Scatter = field(default_factory=Scatter)
    error_amplification: float = 0.0
    holdout: list[Tensor] = field(default_factory=list, repr=False)
    own: dict[str, float] = field(default_factory=dict, repr=False)
    whitened: Prediction | None = field(default=None, repr=False)

    @property
    def linearisation(self) -> Prediction:
        """Residuals and sensitivities that its parameters are known by."""
        return self.fitted.prediction if self.whitened is None else self.whitened

    @property
    def is_finite(self) -> bool:
        """Whether its motion, and that of every small change of its parameters, stays finite."""
        return bool(self.fitted.prediction.sensitivity.isfinite().all()) and isfinite(self.left_out_cost)

    @property
    def of_records(self) -> dict[str, float]:
        """What single fitted records have of their own, by name."""
        return {name: value for name, value in self.values.items() if SEPARATOR in name}

    @property
    def left_out_cost(self) -> float:
        """Sum of squares of what is left of conditions that are left out."""
        return sum(float(r.square().sum()) for r in self.left_out)

    def flat_given(self) -> Given:
        """Every value of the model by flat name, lists as tuples."""
        return placed(self.hypothesis.given, self.values)

    def values_of(self, effect: str) -> Given:
        """Those of an effect by own name."""
        own = f"{effect}."
        return {name.removeprefix(own): value for name, value in self.flat_given().items() if name.startswith(own)}


def placed(given: Given, values: dict[str, float]) -> Given:
    """Known values with the fitted ones in their places."""
    merged: Given = dict(given)
    for name, value in values.items():
        flat, _, index = name.partition("[")
        if SEPARATOR in name:
            continue
        if index:
            listed = list(merged[flat])
            listed[int(index.rstrip("]"))] = value
            merged[flat] = tuple(listed)
        elif is_of_model(name):
            merged[name] = value
    return merged


def mean_free_places(hypothesis: Hypothesis, free: Sequence[FreeParameter]) -> list[list[int]]:
    """Places among free parameters of each list of which only the differences act."""
    return places_of([f"{effect.name}.{name}[" for effect in hypothesis.effects for name in effect.mean_free], free)


def places_of(starts: Sequence[str], free: Sequence[FreeParameter]) -> list[list[int]]:
    """Places among free parameters of those whose names begin with each of some texts, where there are any."""
    found = [[i for i, parameter in enumerate(free) if parameter.name.startswith(start)] for start in starts]
    return [places for places in found if places]


def settled_at(hypothesis: Hypothesis, values: dict[str, float]) -> Hypothesis:
    """A hypothesis with fitted values, by name, as its known ones and as the starts of its free parameters."""
    free = tuple(_settled(p, values.get(p.name, p.start)) for p in hypothesis.free)
    gains = {name: value for name, value in values.items() if name.startswith(f"{GAIN}.")}
    return replace(hypothesis, free=free, given=placed(hypothesis.given, values), gains=gains)


def _settled(parameter: FreeParameter, value: float) -> FreeParameter:
    expected = parameter.expected if parameter.expected is not None or not parameter.logarithmic else parameter.start
    return replace(parameter, start=value, expected=expected)


def segments_of(hypothesis: Hypothesis, evidence: Evidence) -> Segments:
    """How records are cut where they cannot be predicted from their start: as the file says, else by time scale."""
    return evidence.stated_segments or Segments(SEGMENT_TIMES * time_scale(hypothesis, evidence))


def time_scale(hypothesis: Hypothesis, evidence: Evidence) -> float:
    """Characteristic time of a model on these records in s."""
    frequency = 2 * torch.pi * natural_frequency_hz(hypothesis.model, hypothesis.given)
    damping = hypothesis.given.get("viscous_damping.damping_coefficient", 0.0)
    mass = hypothesis.model.prepare(hypothesis.model.values(1, **hypothesis.given)).derived["equivalent_mass"]
    return characteristic_time(evidence.records, frequency, float(damping) / float(mass[0]))


def slowest_time(hypothesis: Hypothesis, evidence: Evidence) -> float:
    """The same, or the period of a slower mode that one of its effects adds."""
    natural = natural_frequency_hz(hypothesis.model, hypothesis.given)
    slowest = slowest_frequency_hz(hypothesis.model, hypothesis.given)
    return 1 / slowest if slowest < natural else time_scale(hypothesis, evidence)


def natural_frequency_hz(model: Model, given: Given) -> float:
    """Natural frequency of a model in Hz."""
    derived = model.prepare(model.values(1, **given)).derived
    return float(derived["natural_frequency"][0]) / (2 * torch.pi)


def slowest_frequency_hz(model: Model, given: Given) -> float:
    """Natural frequency of a model in Hz, or that of a slower mode which one of its effects adds."""
    prepared = model.prepare(model.values(1, **given))
    rates = [float(term["slowest_rate"][0]) for term in prepared.terms.values() if "slowest_rate" in term]
    added = [rate / (2 * torch.pi * float(prepared.scales.time[0])) for rate in rates]
    return min([natural_frequency_hz(model, given), *added])
