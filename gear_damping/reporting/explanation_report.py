"""report.html of an explanation: one self-contained page, read from top to bottom."""

import base64
import html
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gear_damping.explanation.explain import Explanation
from gear_damping.explanation.hypothesis import natural_frequency_hz
from gear_damping.reporting.figures.candidates import candidates_figure
from gear_damping.reporting.figures.misfit import misfit_figure
from gear_damping.reporting.figures.overlay import overlay_figure
from gear_damping.reporting.figures.residual_orders import residual_frequencies_figure
from gear_damping.reporting.style import styled

STYLE = (
    "body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}"
    "table{border-collapse:collapse;margin:1rem 0}td,th{padding:.25rem .8rem;border-bottom:1px solid #ddd;"
    "text-align:left}td.n{text-align:right;font-variant-numeric:tabular-nums}img{max-width:100%}"
    ".verdict{font-size:1.4rem;font-weight:600}"
)


def write_report(folder: Path, explanation: Explanation) -> Path:
    """Write report.html into a run folder; returns its path."""
    content = explanation.content
    body = [_head(content), _causes(content), _figures(explanation), _records(content), _damping(content)]
    body += [_observable(content), _next(content), _findings(content)]
    title = f"Explanation: {content['verdict'].replace('_', ' ')}"
    page = (
        f"<!doctype html><html lang='en'><meta charset='utf-8'><title>{title}</title>"
        f"<style>{STYLE}</style><body>{''.join(body)}</body></html>"
    )
    path = folder / "report.html"
    path.write_text(page, encoding="utf-8")
    return path


def _head(content: Mapping[str, Any]) -> str:
    lines = "".join(f"<p>{html.escape(sentence)}</p>" for sentence in content["sentences"])
    return f"<h1>What the simulation misses</h1><p class='verdict'>{content['verdict'].replace('_', ' ')}</p>{lines}"


def _table(header: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    if not rows:
        return ""
    head = "".join(f"<th>{html.escape(cell)}</th>" for cell in header)
    body = "".join("<tr>" + "".join(_cell(cell) for cell in row) + "</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def _cell(value: object) -> str:
    if isinstance(value, float):
        return f"<td class='n'>{value:.4g}</td>"
    return f"<td>{html.escape(str(value))}</td>"


def _causes(content: Mapping[str, Any]) -> str:
    rows = []
    for cause in content["causes"]:
        alike = ", ".join(cause["confusable_with"]) or "none"
        for name, found in cause["parameters"].items() or [("", {"value": "", "unit": "", "interval95": ("", "")})]:
            low, high = found["interval95"]
            bounds = f"{low:.4g} … {high:.4g}" if isinstance(low, float) else ""
            rows.append((cause["name"], cause["status"], name, found["value"], bounds, found["unit"], alike))
    header = ("cause", "status", "parameter", "value", "95 % interval", "unit", "not told apart from")
    return "<h2>Causes</h2>" + (_table(header, rows) or "<p>No cause is named.</p>")


def _figures(explanation: Explanation) -> str:
    if explanation.found is None:
        return ""
    found, evidence = explanation.found, explanation.evidence
    channel, content = evidence.channel, explanation.content
    worst = max(range(len(evidence.holdout)), key=lambda i: float(found.nominal.holdout[i].square().mean()))
    record, factor = evidence.holdout[worst], channel.declared_factor
    measured = record.response.numpy() / factor
    before, after = (outcome.holdout[worst].numpy() / factor for outcome in (found.nominal, found.outcome))
    extended = measured - after if found.accepted else None
    time = np.arange(len(measured)) / record.sampling_rate
    overlay = overlay_figure(
        time, measured, measured - before, extended, unit=channel.declared_unit, quantity=channel.name
    )
    shown = [(f"Held out: {record.name}", overlay), ("Candidates", candidates_figure(content["candidates"]))]
    shown += [("Misfit by record", misfit_figure(content["misfit"]["records"]))]
    frequency, spectra = _spectra(record.sampling_rate, before, after, measured)
    natural = natural_frequency_hz(found.nominal.hypothesis.model, found.nominal.flat_given())
    shown.append(
        (
            "Spectrum of the residual",
            residual_frequencies_figure(
                frequency,
                spectra[0],
                spectra[1] if found.accepted else None,
                unit=channel.declared_unit,
                measured=spectra[2],
                natural_frequency_hz=natural,
            ),
        )
    )
    return "".join(f"<h2>{html.escape(title)}</h2>{_picture(figure)}" for title, figure in shown)


def _spectra(rate: float, *series: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Amplitudes of Hann-windowed series."""
    window = np.hanning(len(series[0]))
    found = [2 * np.abs(np.fft.rfft((s - s.mean()) * window)) / window.sum() for s in series]
    return np.fft.rfftfreq(len(window), 1 / rate)[1:], [amplitude[1:] for amplitude in found]


def _picture(figure: Figure) -> str:
    buffer = io.BytesIO()
    with styled():
        figure.savefig(buffer, format="png")
    return f"<img alt='' src='data:image/png;base64,{base64.b64encode(buffer.getvalue()).decode()}'>"


def _records(content: Mapping[str, Any]) -> str:
    rows = [
        (name, record["role"], record["rmse"]["before"], record["rmse"]["after"], record["rmse"]["unit"])
        for name, record in content["records"].items()
        if "rmse" in record
    ]
    header = ("record", "role", "residual before", "after", "unit")
    return f"<h2>Records</h2>{_table(header, rows)}" if rows else ""


def _damping(content: Mapping[str, Any]) -> str:
    if not content["gain"]:
        return ""
    found = content["gain"]["damping_ratio_percent"]
    rows = [
        (words, found[key]["value"], " … ".join(f"{end:.4g}" for end in found[key]["interval95"]))
        for key, words in (("before", "nominal model"), ("after", "extended model"))
    ]
    return "<h2>Damping ratio, % of critical</h2>" + _table(("model", "value", "95 % interval"), rows)


def _observable(content: Mapping[str, Any]) -> str:
    rows = [(found["name"], found["smallest"], found["unit"]) for found in content["not_observable"]]
    rows = [row for row in rows if row[1] is not None and np.isfinite(row[1])]
    text = "<p>Smaller effects than these would not have shown in these data.</p>"
    return "<h2>What could not be seen</h2>" + text + _table(("effect", "smallest size", "unit"), rows) if rows else ""


def _next(content: Mapping[str, Any]) -> str:
    if not content["next_experiment"]:
        return ""
    return f"<h2>Next experiment</h2><p>{html.escape(content['next_experiment']['what'])}.</p>"


def _findings(content: Mapping[str, Any]) -> str:
    rows = [(f["record"], f["channel"], f["message"]) for f in content["findings"]]
    return "<h2>About the data</h2>" + _table(("record", "channel", "finding"), rows) if rows else ""
