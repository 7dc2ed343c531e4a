"""The report of task=simulate: the rig, what differs between its runs, what they hold."""

from collections.abc import Mapping
from typing import Any

from gear_damping.reporting.numbers import number, pretty_unit, quantity
from gear_damping.reporting.page.picture import Picture
from gear_damping.reporting.page.render import words
from gear_damping.reporting.page.table import Table
from gear_damping.reporting.run_report.report_schema import DOUBTFUL, FINE, Left, RunReport, Section

NAME = "simulation.json"
MOST_RUNS = 20  # rows of the table of runs; runs.npz has all


def report_of(left: Left) -> RunReport:
    """What a simulation has come to."""
    content = left.read(NAME)
    lost = content["diverged"]
    lead = [_lead(content), *([f"{lost} runs diverged and were left out."] if lost else [])]
    sections = [
        Section("One of the runs", pictures=_shown(left, content)),
        Section("What they hold", [_files(content)], [_channels(content)]),
        Section("Run by run", _not_listed(content), [_runs(content)]),
        Section("The model", [f"Base system `{content['system']}`."], [_effects(content)]),
    ]
    return RunReport("Simulation", f"Simulation of {left.name}", lead, DOUBTFUL if lost else FINE, sections)


def _lead(content: Mapping[str, Any]) -> str:
    seconds = quantity(content["duration_s"], "s")
    size = f"{content['samples']} samples, {seconds} at {content['sampling_rate_hz']:.6g} Hz"
    low, high = content["damping_ratio_percent"]
    ratio = "" if low is None else f"; damping ratio {_span(low, high)} % of critical"
    return f"{content['runs']} {'run' if content['runs'] == 1 else 'runs'} of {size}{ratio}."


def _span(low: float, high: float) -> str:
    return number(low) if number(low) == number(high) else f"{number(low)} … {number(high)}"


def _files(content: Mapping[str, Any]) -> str:
    text = "`runs.npz` holds every channel of every run in SI, and the parameters of each."
    return text + (" `measurement/measurement.yaml` declares them as measured records." if content["measured"] else "")


def _channels(content: Mapping[str, Any]) -> Table:
    rows = [
        (f"`{name}`", *(quantity(one[key], one["unit"]) for key in ("low", "high", "mean", "deviation")))
        for name, one in content["channels"].items()
    ]
    headings = ("channel", "lowest", "highest", "mean", "standard deviation")
    return Table("The channels over all runs, sensors included.", headings, rows)


def _runs(content: Mapping[str, Any]) -> Table:
    varied = content["varied"]
    named = [f"{words(name)} / {pretty_unit(unit)}" for name, unit in varied.items()]
    response = f"RMS of the {words(content['response'])}"
    rows = [
        (
            str(count),
            number(one["damping_ratio_percent"]),
            *(number(one["values"][name]) for name in varied),
            quantity(one["rms"], content["unit"]),
        )
        for count, one in enumerate(content["each"][:MOST_RUNS], start=1)
    ]
    headings = ("run", "damping ratio / %", *named, response)
    return Table("What differs from run to run, and what follows. RMS about the mean.", headings, rows)


def _not_listed(content: Mapping[str, Any]) -> list[str]:
    left = content["runs"] - min(MOST_RUNS, len(content["each"]))
    return [f"{left} more runs stand in `runs.npz`."] if left else []


def _effects(content: Mapping[str, Any]) -> Table:
    rows = [(f"`{name}`", equation) for name, equation in content["effects"].items()]
    return Table("Its effects.", ("effect", "equation"), rows or [("none", "–")], [])


def _shown(left: Left, content: Mapping[str, Any]) -> list[Picture]:
    name, first = words(content["response"]), content["each"][0]
    alt = (
        f"Line charts of the {name} of run 1 of {content['runs']} over time, its spectrum, and its phase plane of "
        f"velocity over {name}; RMS {quantity(first['rms'], content['unit'])}."
    )
    caption = f"The {name} of the first run behind the sensors: over time, its spectrum, its phase plane."
    return left.picture("simulation.png", caption, alt)
