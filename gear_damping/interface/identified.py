"""Damping and everything else that is free, from measured records by output error."""

from collections.abc import Callable, Sequence
from functools import cached_property
from types import ModuleType
from typing import Any

from matplotlib.figure import Figure

from gear_damping.errors import InputError, Problem
from gear_damping.explanation.explain import NOBODY, Listener
from gear_damping.interface import identified_gears, identified_oscillator
from gear_damping.interface.arguments import (
    names,
    refuse_no_model,
    refuse_other,
    refuse_other_call,
    refuse_other_solver,
)
from gear_damping.interface.model import Model
from gear_damping.interface.rig_unit import in_the_unit_of
from gear_damping.measurement.record import Measurement
from gear_damping.physics.systems.traits import Trait
from gear_damping.simulation.solver_settings import Progress, Solver

Fitted = identified_gears.Fitted | identified_oscillator.Fitted


class Identification:
    """What was identified: `content`, as in identification.json, a `table()` and a `plot()` of it."""

    def __init__(self, measurement: Measurement, fitted: Fitted) -> None:
        """Hold a fit."""
        self.measurement, self.fitted = measurement, fitted

    @property
    def _words(self) -> ModuleType:
        """What puts it into words: that of its kind of fit."""
        linear = isinstance(self.fitted, identified_oscillator.Fitted)
        return identified_oscillator if linear else identified_gears

    @cached_property
    def content(self) -> dict[str, Any]:
        """Parameters with 95 % intervals, damping ratio, natural frequency, residuals, lack of fit."""
        return self._words.content_of(self.measurement, self.fitted)

    @property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """Every fitted parameter by name: `value`, `interval95`, `unit`."""
        return self.content["parameters"]

    @property
    def damping_ratio_percent(self) -> dict[str, Any] | None:
        """`value` and `interval95` in % of critical; None where nothing is critical."""
        return self.content["damping_ratio_percent"]

    @property
    def converged(self) -> bool:
        """Whether the search converged."""
        return self.content["converged"]

    @property
    def model(self) -> Model | None:
        """The model with the fitted values, in the unit of the records; None of the linear oscillator.

        The parameters of that one say it all.
        """
        if isinstance(self.fitted, identified_oscillator.Fitted):
            return None
        outcome = self.fitted.outcome
        return in_the_unit_of(self.fitted.evidence, outcome.hypothesis.model, outcome.flat_given())

    def table(self) -> str:
        """The parameters with their intervals, and what is missing, as text."""
        return self._words.table_of(self.content)

    def plot(self) -> Figure:
        """Measured and simulated records with their residuals."""
        return self._words.figure_of(self.fitted, self.content)

    def __repr__(self) -> str:
        return self.table()

    def _repr_html_(self) -> str:
        return f"<pre>{self.table()}</pre>"


def identify(
    measurement: Measurement,
    model: Model | None = None,
    free: str | Sequence[str] = (),
    *,
    log: Callable[[str], None] | None = None,
    progress: Progress | None = None,
    solver: Solver | None = None,
) -> Identification:
    """Fit a simulation to the records that are to be fitted, and predict the held-out ones.

    Held out is what `role` declares; where it declares none, a part of the records of a gear pair, and nothing of those
    of an oscillator.

    Args:
        measurement: As `load` gives it.
        model: What is fitted; the linear oscillator, or the nominal gear pair, where absent. Values in another unit
            than that of the records, as SI, are converted.
        free: Its free parameters, by flat name (`backlash.gap`); `damping_ratio` stands for the coefficient of its one
            damping law. Where absent, every number that its effects were given, and an oscillator's stiffness,
            viscous damping, gains and strengths of effects, given or not. What the file states with an uncertainty is
            free too, about what it states; initial states and unknown zeros of channels always are.
        log: Told what is found on the way.
        progress: Told (done, total) of the fit of an oscillator or a gear pair, but not of a `model` of one's own.
        solver: Settings of the solver.

    Raises:
        InputError: the data are damaged, nothing can be fitted, a name is unknown, what scales the motion of an
            oscillator is neither free nor known, or the units of model and records are of different kinds.
    """
    refuse_faults(measurement)
    refuse_other_solver(solver)
    refuse_other_call("log", log)
    refuse_other_call("progress", progress)
    log = log or NOBODY.log
    free = names("free", free)
    if model is None and free:
        raise InputError(Problem("free", "names parameters of a model", list(free), "give the model too"))
    if model is not None:
        refuse_no_model(model, Model)
        return Identification(measurement, identified_gears.own_fit(measurement, model, free, log, solver))
    if measurement.base.has(Trait.REST):
        return Identification(measurement, identified_oscillator.linear_fit(measurement, progress, solver))
    listener = Listener(log, progress or NOBODY.progress)
    return Identification(measurement, identified_gears.nominal_fit(measurement, listener, solver))


def refuse_faults(measurement: Measurement) -> None:
    """Damaged data give no damping figure.

    Raises:
        InputError: with every fault.
    """
    refuse_other(measurement)
    found = [finding for finding in measurement.findings if finding.severity == "data_problem"]
    if found:
        raise InputError(
            [
                Problem(f"{f.record}.{f.channel}".strip("."), f"{f.kind}: {f.message}", source=str(measurement.source))
                for f in found
            ]
        )
