"""task=inspect: what a bare file or a measurement.yaml holds, a picture of it, and a YAML to start from.

Nothing is simulated or fitted here, and nothing that needs torch is imported.
"""

import logging
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gear_damping.config.light import InspectSettings
from gear_damping.config.measured import YAML_SUFFIXES
from gear_damping.config.shown import shown
from gear_damping.measurement.column import Column
from gear_damping.measurement.column_kinds import CONSTANT, ELSEWHERE
from gear_damping.measurement.encoders import FROM_ENCODERS
from gear_damping.measurement.files import UNKNOWN
from gear_damping.measurement.foretold import natural_frequency, of_record
from gear_damping.measurement.formats.registry import read_table, readers
from gear_damping.measurement.guessing import Guess, guessed
from gear_damping.measurement.inspection import Inspection, clock_of
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.record import Channel, Measurement, Record
from gear_damping.measurement.record_checks import MESH_RESPONSES
from gear_damping.measurement.resolution import step_of
from gear_damping.measurement.spectral_floor import FEWEST, Spectrum, spectrum_of
from gear_damping.measurement.starting_yaml import starting_yaml
from gear_damping.reporting.inspection import Curve, Panel, inspection_figure
from gear_damping.reporting.style import save
from gear_damping.tasks.run_folder import EDITED, RunFolder
from gear_damping.units import behind

YAML_NAME, TEXT_NAME, FIGURE_NAME = EDITED["inspect"], "inspection.txt", "inspection.png"
JSON_NAME = "inspection.json"  # what the report is made of
LISTED = 20  # of what a file holds besides real numbers, and of its columns where they are many
MOST_COLUMNS = 100  # that are listed one by one: what has more hides what is said of the file
LEVELS = 4  # between which a command switches: fewer than a converter has that rounds a motion
PARTS = 10  # of a record, in which a shaft's speed is told: fewer hide a run-up, more show how its counter rounds
STEADY = 0.01  # of the speed, by which it may change: what a drive holds its speed to
ROUNDED = 1e-9  # of the range: less is what a difference of large angles or a sum of many values is rounded by
log = logging.getLogger("gear_damping").info


def run(settings: InspectSettings, folder: RunFolder) -> dict[str, Any]:
    """Inspect; returns the metrics for run.json."""
    path = settings.measurement_path
    if path.suffix.lower() in YAML_SUFFIXES:
        return _declared(load_measurement(path, plugins=settings.measurement_plugins), folder)
    return _bare(path, settings.measurement_plugins, folder)


def _bare(path: Path, plugins: Sequence[str], folder: RunFolder) -> dict[str, Any]:
    start = folder.path / YAML_NAME
    found, system, listed = guessed(read_table(path, known=readers(plugins)))
    folder.add_inputs([path], "measurement.path")
    text = starting_yaml(found, system, listed)
    with start.open("x", encoding="utf-8") as file:
        file.write(text)
    save(inspection_figure(list(_panels(found, listed)), found.base is not None), folder.path / FIGURE_NAME)
    _log(folder, [*_file_lines(found), *_column_lines(found, listed)])
    blanks = sum(line.count(UNKNOWN) for line in text.splitlines() if not line.lstrip().startswith("#"))
    wanted = (
        f"fill in its {blanks} {UNKNOWN}, correct its guesses" if blanks else "nothing is left open; check its guesses"
    )
    folder.write_json(JSON_NAME, _file_content(found, listed) | {"open": blanks})
    log(f"\n{start} declares it: {wanted}, and go on with")
    again = [f"measurement.plugins=[{','.join(plugins)}]"] if plugins else []
    log(f"  {shown(['task=inspect', f'measurement.path={start}', *again])}")
    return {"system": system[0], "columns": len(found.columns), "sampling_rate": found.rate, "open": blanks}


def _log(folder: RunFolder, lines: Sequence[str]) -> None:
    text = "\n".join(lines)
    folder.write_text(TEXT_NAME, text + "\n")
    log(text)


def _file_lines(found: Inspection) -> Iterator[str]:
    table = found.table
    lengths = {column.values.size for column in found.columns if column.kind != ELSEWHERE}
    rows = f"{found.length} rows" if lengths == {found.length} else f"{min(lengths)} to {max(lengths)} rows"
    yield f"{table.path.name}: {len(found.columns)} columns in {len(table.shapes)} arrays, {rows}"
    if table.left_out:
        yield f"  no real numbers: {_few(table.left_out)}"
    yield from (f"  {note}" for note in table.notes)
    yield f"  time: {_time(found)}"
    notes = found.base.notes + tuple(finding.message for finding in found.base.findings) if found.base else ()
    yield from (f"  time: {said}" for said in (*notes, *found.faults))
    if found.rows != (0, found.length):
        first, last = found.rows[0], found.rows[1] - 1
        why = found.taken or "the longest stretch in which all that is declared is finite"
        yield f"  rows {first} to {last} are {why}"
    elif found.taken:
        yield f"  rows: {found.taken}"


def _few(names: Sequence[str]) -> str:
    """Some of what a file holds, and how many there are."""
    more = f", and {len(names) - LISTED} more" if len(names) > LISTED else ""
    return ", ".join(names[:LISTED]) + more


def _file_content(found: Inspection, listed: Sequence[Guess]) -> dict[str, Any]:
    """What the lines say, for the page."""
    notes = [line.strip() for line in _file_lines(found)][1:]
    columns = [
        {
            "column": str(column.reference), "shape": shape, "unit": _unit(column, guess), "kind": column.kind,
            "guess": f"{guess.channel}: {guess.why}" if guess is not None and guess.channel else "",
            "looks": [line for line in _looks(column, found) if line],
        }
        for column, shape, guess in _told(found, listed)
    ]  # fmt: skip
    time, others = f"time: {_time(found)}", {"columns": columns, "rows": found.length, "file": found.table.path.name}
    return others | {"time": _time(found), "notes": [f"{note}." for note in notes if note != time]}


def _told(found: Inspection, listed: Sequence[Guess]) -> Iterator[tuple[Column, str, Guess | None]]:
    """Every column with its shape and what it may be."""
    guess_of = {id(guess.column): guess for guess in listed}
    shapes = {name: " x ".join(map(str, shape)) for name, shape in found.table.shapes if name}
    for column in found.columns:
        shape = shapes.get(str(column.reference).split("[")[0], str(column.values.size))
        yield column, shape, guess_of.get(id(column))


def _time(found: Inspection) -> str:
    if found.time is None and found.rate is None:
        said = f"what the file says, '{found.unread_rate}', is not read: write what it means, sampling_rate: 2 kHz"
        return f"no column looks like time stamps, and {said if found.unread_rate else 'no rate is read from the file'}"
    n = found.rows[1] - found.rows[0]
    lasts = f"{found.rate:.6g} Hz, {n / found.rate:.4g} s" if found.rate else "no rate"
    if found.rate_of:
        return f"{lasts}, a guess: what the file calls {found.rate_of}"
    if found.time is None:
        return f"{lasts}, as the file says"
    guessed = f", a guess: {found.time.guessed}" if found.time.guessed else ""
    name = found.columns[found.time.index].reference
    return f"{lasts}; column '{name}' {found.time.says}; its unit is {found.time.unit}{guessed}"


def _column_lines(found: Inspection, listed: Sequence[Guess]) -> Iterator[str]:
    told = list(_told(found, listed))
    shown = told if len(told) <= MOST_COLUMNS else told[:LISTED]
    for column, shape, guess in shown:
        yield f"column {_name(column, found)} ({shape}), {_unit(column, guess)}: {column.kind}"
        yield from (f"    {line}" for line in _looks(column, found) if line)
        if guess is not None and guess.channel:
            yield f"    may be {guess.channel}: {guess.why}"
    if len(shown) < len(told):
        yield f"and {len(told) - len(shown)} columns more, which {JSON_NAME} lists"


def _name(column: Column, found: Inspection) -> str:
    """Its name, or its number where it has none of its own."""
    if isinstance(column.reference, str):
        return f"'{column.reference}'"
    name = found.table.names[column.reference]
    return f"{column.reference}, one of several named '{name}'," if name else str(column.reference)


def _unit(column: Column, guess: Guess | None) -> str:
    if guess is None or guess.unit == UNKNOWN:
        return f"in '{column.unit}'" if column.unit else "unit not known"
    return f"in {guess.unit}, a guess: {guess.unit_by}" if guess.unit_by else f"in {guess.unit}"


def _looks(column: Column, found: Inspection) -> Iterator[str]:
    values = column.inside
    yield column.says
    missing = int(np.sum(~np.isfinite(column.values)))
    if missing:
        yield f"{missing} of {column.values.size} values are not finite"
    if values.size and column.kind != CONSTANT:
        yield f"from {values.min() + 0.0:.5g} to {values.max() + 0.0:.5g}, offset (mean) {_mean(values):.5g}"  # no -0
    yield _noise(values, column.spectrum, column.step, column.rate)


def _noise(values: NDArray, spectrum: Spectrum | None, step: float, rate: float | None) -> str:
    """The floor of a spectrum, its highest line, and the step with the noise that it makes; of a command its levels."""
    if step and 1 < (levels := np.unique(values).size) <= LEVELS:
        return f"switches between {levels} levels"
    parts = []
    if spectrum is not None:
        parts.append(f"noise {spectrum.noise:.3g} (floor of the spectrum)")
        if spectrum.strongest is not None:
            parts.append(f"strongest at {spectrum.strongest:.4g} {'Hz' if rate else 'cycles a sample'}")
    if step:
        parts.append(f"steps of {step:.4g}, whose rounding makes {step / 12**0.5:.2g}")
    return ", ".join(parts)


def _panels(found: Inspection, listed: Sequence[Guess]) -> Iterator[Panel]:
    units = {id(guess.column): guess.unit for guess in listed if guess.unit != UNKNOWN}
    for column in found.measured:
        time = np.arange(found.length, dtype=float)
        if found.base is not None:
            time = (time - found.rows[0]) / found.rate + found.base.time[0]
            if found.base.time.size == found.rows[1] - found.rows[0]:
                time[found.rows[0] : found.rows[1]] = found.base.time
        if clock := clock_of(found, column):
            time = clock.stamps.in_seconds * clock.values
        name = str(column.reference)
        yield Panel(name, units.get(id(column), ""), (_curve(name, time, column.values, column.spectrum),))


def _curve(label: str, time: np.ndarray, values: np.ndarray, spectrum: Spectrum | None) -> Curve:
    if spectrum is None:
        return Curve(label, time, values)
    return Curve(label, time, values, spectrum.frequency, spectrum.density, spectrum.floor)


def _declared(measurement: Measurement, folder: RunFolder) -> dict[str, Any]:
    folder.add_inputs(measurement.files)
    lines = list(_measurement_lines(measurement))
    content: dict[str, Any] = {"says": [line.strip() for line in lines[1:]], "records": []}
    curves: dict[tuple[str, str], list[Curve]] = {}
    for record in measurement.records:
        own = [*_record_lines(record)]
        if told := of_record(measurement, record):
            own.append(f"    by what is stated {told}")
        lines += own
        said: list[tuple[str, str]] = []
        for channel in record.channels.values():
            spectrum = _spectrum(record, channel)
            values = channel.values / channel.declared_factor
            said.append((channel.name, _channel(record, channel, values, spectrum)))
            drawn = curves.setdefault((channel.name, channel.declared_unit), [])
            drawn.append(_curve(record.name, record.time, values, spectrum))
        found = [*_findings(record)]
        lines += [f"    {line}" for line in (*(f"{name}: {text}" for name, text in said), *found)]
        notes = [line.strip() for line in own[1:]] + found
        says = own[0].split(": ", 1)[1]
        content["records"].append({"name": record.name, "says": says, "channels": said, "notes": notes})
    panels = [Panel(*named, tuple(drawn)) for named, drawn in curves.items()]
    save(inspection_figure(panels), folder.path / FIGURE_NAME)
    _log(folder, lines)
    faults = sum(finding.severity == "data_problem" for finding in measurement.findings)
    known = {"file": measurement.source.name, "system": measurement.system, "data_problems": faults}
    folder.write_json(JSON_NAME, content | known)
    return {"system": measurement.system, "records": len(measurement.records), "data_problems": faults}


def _spectrum(record: Record, channel: Channel) -> Spectrum | None:
    constant = np.ptp(channel.values) == 0
    return None if constant else spectrum_of(channel.values / channel.declared_factor, record.sampling_rate)


def _mean(values: np.ndarray) -> float:
    """The mean; 0 where it is what is left of one that was taken out."""
    mean = float(values.mean())
    return mean if abs(mean) > ROUNDED * float(np.ptp(values)) else 0.0


def _measurement_lines(measurement: Measurement) -> Iterator[str]:
    yield f"{measurement.source.name}: {measurement.system}, {len(measurement.records)} records"
    for name, quantity in measurement.parameters.items():
        yield f"  {name}: {_quantity(quantity)}"
    if frequency := natural_frequency(measurement):
        nyquist = max(record.sampling_rate for record in measurement.records) / 2
        beyond = f", above half of every sampling rate ({nyquist:g} Hz): are their units right?"
        yield f"  natural frequency, by these: {frequency:.4g} Hz{beyond if frequency > nyquist else ''}"
    for role, word in (("fit", "fitted"), ("holdout", "held out"), ("reference", "compared with")):
        named = [record.name for record in measurement.with_role(role)]
        if named:
            yield f"  {word}: {', '.join(named)}"
    free = [record.name for record in measurement.with_role(None)]
    casings = all(_is_casing_alone(record) for record in measurement.records)
    if free:
        held_out = _CASINGS if casings else _AUTOMATIC
        yield f"  role not said: {', '.join(free)}" + ("" if len(free) < len(measurement.records) else held_out)
    if not free and measurement.with_role("fit") and not measurement.with_role("holdout") and not casings:
        yield "  none is held out: task=explain holds out a part of each by itself"
    if not free and not measurement.with_role("fit"):
        yield "  none is fitted: task=identify and task=explain need a record of role: fit"
    if measurement.segment_s:
        yield f"  segments of exactly {measurement.segment_s:g} s are fitted and scored"
    else:
        yield f"  segments: none stated; {_DRIFTS if _drifts(measurement) else _CUT}"


_CUT = "records are cut only where the system or the model needs it"
_DRIFTS = "without a spring a displacement drifts away from any simulation: segments: {value: …, unit: s} begin anew"
_AUTOMATIC = "; task=explain holds out a part of them by itself, and so does task=identify of a gear pair"
_CASINGS = "; task=explain looks into all of them, and task=identify finds no damping behind a casing"


def _drifts(measurement: Measurement) -> bool:
    """Whether nothing holds a measured displacement in its place."""
    spring = measurement.parameters.get("stiffness")
    springless = spring is not None and spring.value == 0
    return springless and any("displacement" in record.channels for record in measurement.records)


def _is_casing_alone(record: Record) -> bool:
    """Whether a casing is all that was heard in a record."""
    return record.on_casing and not {*record.channels} & {*MESH_RESPONSES}


def _record_lines(record: Record) -> Iterator[str]:
    even = "" if record.uniform else ", uneven"
    yield (
        f"record '{record.name}', {record.role or 'role not said'}: {record.file.name}, {record.time.size} samples, "
        f"{record.sampling_rate:.6g} Hz{even}, {record.duration:.4g} s from {record.time[0]:.10g} s on"
    )
    for name, quantity in record.conditions.items():
        yield f"    {name}: constant, {_quantity(quantity)}"
    if record.gear_torque_mode:
        yield f"    gear_torque: {record.gear_torque_mode}"


def _channel(record: Record, channel: Channel, values: np.ndarray, spectrum: Spectrum | None) -> str:
    said = f"{values.min() + 0.0:.5g} to {values.max() + 0.0:.5g}{behind(channel.declared_unit)}"  # no -0
    if channel.name == "pinion_angle":  # what is left of a ramp is neither a tone nor a converter's step
        return f"{said}, {_turning(channel.values / (2 * np.pi), record.sampling_rate)}"
    said += f", offset (mean) {_mean(values):.5g}"
    is_difference = channel.name == "transmission_error" and FROM_ENCODERS in record.notes
    step = 0.0 if is_difference else step_of(values)  # what the steps of two encoders divide by is no step of either
    noise = _noise(values, spectrum, step, record.sampling_rate)
    datum = "" if channel.datum == "absolute" else ", datum arbitrary"
    return f"{said}{datum}{', ' if noise else ''}{noise}"


def _turning(turns: np.ndarray, rate: float) -> str:
    """How far and how fast a shaft turns; where its speed changes, that of the slowest and the fastest part too."""
    said = f"{turns[-1] - turns[0]:.4g} turns, on average {_rpm(turns, rate):.5g} rpm"
    if turns.size < FEWEST:
        return said
    parts = [_rpm(part, rate) for part in np.array_split(turns, PARTS)]
    if np.ptp(parts) <= STEADY * max(np.abs(parts)):
        return said
    return f"{said}, its tenths between {min(parts):.4g} and {max(parts):.4g} rpm"


def _rpm(turns: np.ndarray, rate: float) -> float:
    return 60 * rate * float(turns[-1] - turns[0]) / max(turns.size - 1, 1)


def _findings(record: Record) -> Iterator[str]:
    yield from (f"note: {note}" for note in record.notes)
    for finding in record.findings:
        word = "data problem" if finding.severity == "data_problem" else "note"
        yield f"{word}: {finding.kind}: {finding.message}"


def _quantity(quantity: Any) -> str:
    known = f" ± {100 * quantity.uncertainty:g} %" if quantity.uncertainty else ""
    return f"{quantity.value:.6g}{behind(quantity.unit)}{known}"
