"""What a simulation gets wrong of a measurement, and its name."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from html import escape
from math import inf
from pathlib import Path
from typing import Any

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.explanation import explain as explaining
from gear_damping.explanation.budget import Budget
from gear_damping.explanation.explain import NOBODY, Listener
from gear_damping.explanation.settings import SearchSettings
from gear_damping.interface.arguments import (
    file_path,
    names,
    plain,
    refuse_other,
    refuse_other_listener,
    refuse_other_solver,
)
from gear_damping.interface.model import Model
from gear_damping.interface.new_file import written_anew
from gear_damping.interface.rig_unit import in_the_unit_of
from gear_damping.measurement.record import Measurement
from gear_damping.own_files import plugin_paths
from gear_damping.physics.catalogue import catalogue
from gear_damping.reporting.explanation_report import render, report_input
from gear_damping.reporting.explanation_report.sentences import in_short
from gear_damping.simulation.solver_settings import Solver

PAGES = ("", ".html", ".htm")  # ends of names of files that hold a page
ARGUMENTS = ("minutes", "ruled_out", "plugins", "listener", "solver")  # of `explain`, beside its thresholds


class Answer:
    """An explanation: `verdict`, `sentences`, `causes`, the extended `model`, and all of it as `content`."""

    def __init__(self, found: explaining.Explanation) -> None:
        """Hold what `gear_damping.explanation.explain` found."""
        self.found = found

    @property
    def content(self) -> dict[str, Any]:
        """What stands in explanation.json (docs/explanation.md)."""
        return self.found.content

    @property
    def verdict(self) -> str:
        """`consistent`, `explained`, `ambiguous`, `partly_explained`, `unexplained` or `data_problem`."""
        return self.content["verdict"]

    @property
    def sentences(self) -> list[str]:
        """The verdict in words, the most important sentence first."""
        return self.content["sentences"]

    @property
    def causes(self) -> list[dict[str, Any]]:
        """Every cause with `name`, `status`, `parameters` and their intervals, `confusable_with`."""
        return self.content["causes"]

    @property
    def model(self) -> Model | None:
        """The simulation with its causes and values, in the unit of the records; None where nothing was fitted."""
        if self.found.found is None:
            return None
        outcome = self.found.found.outcome
        return in_the_unit_of(self.found.evidence, outcome.hypothesis.model, outcome.flat_given())

    @property
    def damping_ratio(self) -> dict[str, Any] | None:
        """The damping ratio with the causes: `value` in % of critical, `interval95`, `reference_velocity`.

        `conditional` where something is left that has no name, so that it may lie outside all the same. None where
        nothing was fitted, or without a spring.
        """
        found = (self.content.get("gain") or {}).get("damping_ratio_percent")
        return found and found["after"] | {"conditional": found["conditional"]}

    def report(self, path: Path | str) -> Path:
        """Write the report as one HTML file; an existing one stays.

        Raises:
            InputError: it is no path, or that of another kind of file.
            FileExistsError: there is such a file.
        """
        path = file_path("path", path, "the new HTML file, for example report.html")
        if path.suffix.lower() not in PAGES:
            rule, remedy = "a report is an HTML file", f"write {path.with_suffix('.html')}, which a browser can print"
            raise InputError(Problem("path", rule, str(path), remedy))
        return written_anew(path, render(report_input(self.found)))

    def __repr__(self) -> str:
        return f"<{self.verdict}: {self.sentences[0]}>"

    def __str__(self) -> str:
        """The verdict, how large each cause is, and the damping, a line each."""
        return "\n".join([self.verdict, *in_short(self.content)])

    def _repr_html_(self) -> str:
        lines = "".join(f"<li>{escape(sentence)}</li>" for sentence in in_short(self.content))
        return f"<p><b>{escape(self.verdict)}</b></p><ul>{lines}</ul>"


def explain(
    measurement: Measurement,
    *,
    minutes: float = inf,
    ruled_out: str | Sequence[str] = (),
    plugins: str | Path | Sequence[str | Path] = (),
    listener: Listener = NOBODY,
    solver: Solver | None = None,
    **thresholds: float,
) -> Answer:
    """Find what the simulation of a measured rig misses.

    Args:
        measurement: As `load` gives it.
        minutes: Time of the search; when it is over, the best answer so far says what was not tried.
        ruled_out: Names of effects that are known not to be there.
        plugins: Files of one's own effects, which are tried as causes too.
        listener: Who is told on the way: `gd.Listener(print)`.
        solver: Settings of the solver.
        thresholds: Of the search, by name (conf/explain/default.yaml: `accepted_t=3`).

    Raises:
        InputError: the measurement cannot be explained, or a name is unknown.
    """
    known = catalogue(plugin_paths(plugins))
    refuse_other(measurement)
    refuse_other_solver(solver)
    refuse_other_listener(listener)
    minutes, thresholds = plain(minutes), {name: plain(value) for name, value in thresholds.items()}
    wrong, ruled_out = _wrong_minutes(minutes), names("ruled_out", ruled_out)
    wrong += [Problem("ruled_out", "no such effect", n, nearest(n, list(known))) for n in ruled_out if n not in known]
    wrong += _wrong(thresholds)
    if wrong:
        raise InputError(wrong)
    library = {name: kind for name, kind in known.items() if name not in ruled_out}
    budget, settings = Budget(minutes), SearchSettings(**thresholds)
    return Answer(explaining.explain(measurement, listener or NOBODY, solver, library, budget, settings))


def _wrong_minutes(minutes: object) -> list[Problem]:
    if isinstance(minutes, int | float) and not isinstance(minutes, bool) and minutes > 0:
        return []
    return [Problem("minutes", "must be a positive number", minutes, "leave it out, or write for example minutes=5")]


def _wrong(thresholds: Mapping[str, float]) -> list[Problem]:
    """What is wrong with thresholds: their names, and values out of range."""
    known, problems = {one.name: one.metadata for one in fields(SearchSettings)}, []
    usual = {one.name: one.default for one in fields(SearchSettings)}
    for name, value in thresholds.items():
        if name not in known:
            problems.append(Problem(name, "no argument and no threshold", remedy=nearest(name, [*known, *ARGUMENTS])))
        elif isinstance(value, bool) or not isinstance(value, int | float):
            problems.append(Problem(name, "must be a number", value, f"for example {name}={usual[name]:g}"))
        elif not known[name]["lower"] <= value <= known[name]["upper"]:
            rule = f"must lie within {known[name]['lower']:g} … {known[name]['upper']:g}"
            problems.append(Problem(name, rule, value, "see conf/explain/default.yaml"))
    return problems
