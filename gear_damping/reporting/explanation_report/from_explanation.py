"""The report's input from a finished explanation: spectra, overlays and forces of the records at hand."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from gear_damping.explanation.answer.gain import parameters_of
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.explain import Explanation
from gear_damping.explanation.model.covariance import covariance_of
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.state import State
from gear_damping.reporting.explanation_report.render import render
from gear_damping.reporting.explanation_report.report_input import ReportInput
from gear_damping.reporting.explanation_report.residual_arrays import force_map, force_surface, spectrum
from gear_damping.reporting.figures import Overlay, overlay_figure, save
from gear_damping.reporting.numbers import pretty_unit
from gear_damping.reporting.page.render import words

MOST_OVERLAYS = 2  # records that are drawn in full, the worst first
REPORT, MAIN_FIGURE = "report.html", "explanation.png"


def write_report(folder: Path | str, explanation: Explanation, provenance: Mapping[str, str] | None = None) -> Path:
    """Write report.html and its main figure, explanation.png, into a run folder; returns the path of the report."""
    path, report = Path(folder) / REPORT, report_input(explanation, provenance)
    path.write_text(render(report), encoding="utf-8")
    if report.overlays:
        figure = overlay_figure(report.overlays[0], report.unit, report.quantity)
        save(figure, path.with_name(MAIN_FIGURE))
    return path


def report_input(explanation: Explanation, provenance: Mapping[str, str] | None = None) -> ReportInput:
    """What the report shows of an explanation.

    Args:
        explanation: As `explain` returned it.
        provenance: Name -> text for the end of the page.
    """
    content, found, evidence = explanation.content, explanation.found, explanation.evidence
    common = {"title": _title(content), "explanation": content, "provenance": provenance or {}}
    common["casing"] = explanation.casing
    if found is None or evidence is None:
        return ReportInput(**common)
    channel = evidence.channel
    order = worst_first(found)
    noise = content["noise"]["by_record"]
    return ReportInput(
        **common,
        quantity=words(channel.name),
        unit=pretty_unit(channel.declared_unit),
        overlays=[_overlay(found, evidence, i, noise) for i in order[:MOST_OVERLAYS]],
        spectrum=spectrum(found, evidence, order[0], noise[evidence.holdout[order[0]].name]),
        needed_share=evidence.settings.least_share,
        force_map=force_map(found.nominal, evidence),
        force_surface=force_surface(found.nominal, evidence),
        parameters=_parameters(found, evidence),
        equations={words(effect.name): effect.equation for effect in found.outcome.hypothesis.effects},
    )


def worst_first(found: State) -> list[int]:
    """Held-out records by what the nominal simulation leaves of them."""
    left = [float(residual.square().mean()) for residual in found.nominal.holdout]
    return sorted(range(len(left)), key=lambda i: -left[i])


def _title(content: Mapping[str, Any]) -> str:
    names = list(content.get("records") or {})
    count = f"{len(names)} records" if len(names) != 1 else f"record {names[0]}"
    return f"{words(str(content.get('system', 'rig'))).capitalize()}, {count}"


def _overlay(found: State, evidence: Evidence, place: int, noise: Mapping[str, float]) -> Overlay:
    record, factor = evidence.held[place], evidence.channel.declared_factor
    measured = record.response.numpy()
    nominal, extended = (measured - o.holdout[place][: len(measured)].numpy() for o in (found.nominal, found.outcome))
    return Overlay(
        f"{record.name}, held out",
        np.arange(len(measured)) / record.sampling_rate,
        measured / factor,
        nominal / factor,
        extended / factor if found.accepted else None,
        noise[record.name],
    )


def _parameters(found: State, evidence: Evidence) -> dict[str, dict[str, Any]]:
    """Every fitted parameter before and after, but for those of the causes, which have their own table."""
    before = _estimates(found.nominal, evidence)
    after = _estimates(found.outcome, evidence) if found.accepted else {}
    return {name: {"before": before[name], "after": after.get(name)} for name in before}


def _estimates(outcome: Outcome, evidence: Evidence) -> dict[str, Any]:
    covariances = covariance_of(outcome, evidence)
    declared = outcome.hypothesis.model.parameters()
    found = {}
    for owner in dict.fromkeys(p.name.partition(".")[0] for p in outcome.problem.free):
        if owner in declared or any(owner == effect.name for effect in outcome.hypothesis.effects):
            for own, entry in parameters_of(outcome, covariances, owner, evidence).items():
                found[f"{owner}, {own}" if own else owner] = entry
    return found
