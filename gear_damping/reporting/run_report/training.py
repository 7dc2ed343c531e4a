"""The report of task=train: the networks beside their controls."""

from collections.abc import Mapping
from typing import Any

from gear_damping.identification.controls import NO_BETTER
from gear_damping.reporting.numbers import number, percent
from gear_damping.reporting.page.picture import Picture
from gear_damping.reporting.page.table import Table
from gear_damping.reporting.run_report.report_schema import DOUBTFUL, FINE, Left, RunReport, Section
from gear_damping.reporting.tables import COLUMNS, results_rows

TABLE = (
    "Errors on test windows. RMSE in % of critical damping; skill is 1 where all is right and 0 where a network is as "
    "good as always saying the mean of the training labels; epochs until the lowest validation error."
)


def report_of(left: Left) -> RunReport:
    """What a training has come to."""
    results = left.read("results.json")
    doubts = control_sentences(results)
    sections = [
        Section(
            "Errors of the networks and their controls",
            [_protocol(results)],
            [errors_table(results)],
        ),
        Section("Run by run", pictures=_predictions(left, results)),
        Section("The simulated runs", [_runs(results)], pictures=_response(left)),
    ]
    lead = [_lead(results), *doubts]
    state = DOUBTFUL if len(doubts) == len(results["models"]) else FINE
    return RunReport("Training", f"Training of {left.name}", lead, state, sections)


def errors_table(results: Mapping[str, Any]) -> Table:
    """The table of the terminal."""
    return Table(TABLE, list(COLUMNS), results_rows(results))


def control_sentences(results: Mapping[str, Any]) -> list[str]:
    """What the controls say about the networks' figures."""
    blind = results["controls"]["white_noise"]["rmse_percent"]["mean"]
    errors = {name: found["rmse_percent"]["mean"] for name, found in results["models"].items()}
    return [
        f"{name} ({error:.4g} %) is no better than a network that was fed white noise ({blind:.4g} %): "
        "under this protocol its figure says nothing about damping"
        for name, error in errors.items()
        if error is not None and blind is not None and error > NO_BETTER * blind
    ]


def _lead(results: Mapping[str, Any]) -> str:
    errors = {name: found["rmse_percent"]["mean"] for name, found in results["models"].items()}
    known = {name: error for name, error in errors.items() if error is not None}
    if not known:
        return "No network says a number."
    best = min(known, key=known.__getitem__)
    mean = results["controls"]["mean"]["rmse_percent"]["mean"]
    return (
        f"`{best}` misses the damping ratio of test windows by {number(errors[best])} % of critical (RMSE); always "
        f"saying the mean of the training labels misses it by {number(mean)} %."
    )


def _protocol(results: Mapping[str, Any]) -> str:
    seeds = ", ".join(map(str, results["seeds"]))
    return f"Protocol `{results['protocol']}`, family `{results['family']}`, seeds {seeds}."


def _runs(results: Mapping[str, Any]) -> str:
    lost = results["n_diverged"]
    return f"{results['n_runs']} runs were simulated" + (
        f"; {lost} of them diverged and were left out." if lost else "."
    )


def _predictions(left: Left, results: Mapping[str, Any]) -> list[Picture]:
    scored = {**results["models"], **results["controls"]}
    errors = [f"{name} {number(found['rmse_percent']['mean'], 3)} %" for name, found in scored.items()]
    skills = [f"{n} {percent(f['median_relative_error'])}" for n, f in results["models"].items()]
    alt = (
        "Scatter plots of the predicted over the true damping ratio of each test run in % of critical, one panel a "
        f"network. RMSE over windows: {', '.join(errors)}. Median relative error: {', '.join(skills)}."
    )
    caption = (
        "Predicted against true damping ratio of each test run. On the dotted line a prediction is right; points "
        "along the dashed one say the mean, whatever the run."
    )
    return left.picture("predicted_against_true.png", caption, alt)


def _response(left: Left) -> list[Picture]:
    shown = (
        (
            "response.png",
            "The response of the first run as the networks hear it, with the noise of the sensor.",
            "Line charts of the response of the first simulated run over time, and of its spectrum over frequency.",
        ),
        (
            "scalogram.png",
            "Its wavelet transform; hatched, where the transform reaches beyond the record.",
            "Colour map of the wavelet transform of the first run: time from left to right, frequency from bottom to "
            "top; lines mark the mesh harmonics and the natural frequency.",
        ),
        (
            "mesh_stiffness.png",
            "The mesh stiffness that drives it.",
            "Line chart of the mesh stiffness of the first run over the mesh phase.",
        ),
    )
    return [picture for one in shown for picture in left.picture(*one)]
