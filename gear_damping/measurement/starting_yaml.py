"""A measurement.yaml to start from, for a bare file: what is guessed says so, what nobody can guess is ???."""

import json
import re
from collections.abc import Iterator, Mapping, Sequence

from gear_damping.measurement.angular_error import is_angle
from gear_damping.measurement.column_kinds import EDGES, ELSEWHERE
from gear_damping.measurement.files import UNKNOWN
from gear_damping.measurement.guessing import GEAR, Guess, is_linear_speed
from gear_damping.measurement.inspection import Inspection
from gear_damping.units import is_of_kind

_PLAIN = re.compile(r"^[A-Za-z_/][\w./*^-]*$")
_WORDS = ("y", "n", "yes", "no", "on", "off", "true", "false", "null")
_ENCODERS = ("pinion", "gear", "tacho")
_COUNTS = {"pinion": "counts_per_revolution", "gear": "counts_per_revolution", "tacho": "pulses_per_revolution"}
_GEOMETRY = {"n_teeth_pinion": None, "n_teeth_gear": None, "module": "mm", "pressure_angle": "deg"}
_WITH_TORQUE = {"transmission_error", "pinion_speed", "gear_speed", "gear"}  # responses that need a torque beside them
_ROLE = "fit, or holdout for a record to be judged by; without it task=explain holds out a part by itself"
_CASING = "taken as on a casing; on a shaft add mounting: tangential, shaft: pinion and radius: {value: …, unit: mm}"


def starting_yaml(found: Inspection, system: tuple[str, str], listed: Sequence[Guess]) -> str:
    """The text of a measurement.yaml that declares what was guessed.

    Args:
        found: What the file holds.
        system: The system and what it was guessed by.
        listed: What each column may be.
    """
    path, other = found.table.path.resolve(), "oscillator" if system[0] == GEAR else GEAR
    lines = [
        f"# Written by task=inspect from {path.name}. Correct what is a guess, and fill in every {UNKNOWN}.",
        "# docs/measurement.md lists every key. `task=inspect` on this file checks it.",
        f"system: {system[0]}   # guess: {system[1]}; else {other}",
        *_parameters(system[0], listed),
        "records:",
        f"  - name: {_scalar(re.sub(r'[^A-Za-z0-9_.-]+', '_', path.stem))}",
        f"    file: {_scalar(str(path))}",
        f"    # role: fit   # {_ROLE}",
        *_rows(found),
        "    channels:",
        *(f"      {line}" for line in (*_time(found), *_channels(found, system[0], listed))),
    ]
    if system[0] == GEAR:
        lines += _gear(found, listed)
    return "\n".join([*lines, *_left_out(found, listed)]) + "\n"


def _scalar(value: object) -> str:
    if isinstance(value, str) and (not _PLAIN.match(value) or value.lower() in _WORDS):
        return json.dumps(value, ensure_ascii=False)
    return str(value)


def _mapping(content: Mapping[str, object]) -> str:
    inner = (f"{key}: {_mapping(v) if isinstance(v, Mapping) else _scalar(v)}" for key, v in content.items())
    return "{" + ", ".join(inner) + "}"


def _rows(found: Inspection) -> list[str]:
    first, stop = found.rows
    if found.rows == (0, found.length):
        return [f"    # slice: [{first}, {stop}]   # rows; or window: {{from: …, to: …, unit: s}}"]
    why = found.taken or "the longest stretch without values that are not finite"
    return [f"    slice: [{first}, {stop}]   # {why}"]


def _time(found: Inspection) -> Iterator[str]:
    stamps, rate = found.time, found.rate
    if stamps is not None and found.columns[stamps.index].values.size == found.length and not found.faults:
        column = found.columns[stamps.index].reference
        by = f"   # guess: unit {stamps.unit}, {stamps.guessed}" if stamps.guessed else ""
        yield f"time: {_mapping({'column': column, 'unit': stamps.unit})}{by}"
        yield from (f"# {finding.message}" for finding in found.base.findings)
    elif found.faults:
        stated = {"value": float(f"{rate:.10g}") if rate else UNKNOWN, "unit": "Hz"}
        yield f"sampling_rate: {_mapping(stated)}   # guess: the mean of the time stamps, of which {found.faults[0]}"
    elif found.rate_of:
        stated = {"value": float(f"{rate:.10g}"), "unit": "Hz"}
        yield f"sampling_rate: {_mapping(stated)}   # guess: what the file calls {found.rate_of}"
    elif rate is None:
        stated = {"value": UNKNOWN, "unit": "Hz"}
        unread = found.unread_rate
        why = f"the file says '{unread}', which is not read" if unread else "nothing in the file says it"
        yield f"sampling_rate: {_mapping(stated)}   # {why}"
    else:
        yield f"# the file itself says {rate:.10g} Hz"


def _channels(found: Inspection, system: str, listed: Sequence[Guess]) -> Iterator[str]:
    used = {guess.channel for guess in listed if guess.used}
    for guess in listed:
        if guess.channel is not None and guess.channel not in _ENCODERS:
            said = f"{guess.channel}: {_declared(guess, system)}   # {_comment(guess, found, system)}"
            yield said if guess.used else f"# {said}"
    if system == GEAR:
        yield from _gear_channels(used)
    elif not used & {"displacement", "velocity", "acceleration"}:
        yield f"displacement: {_mapping({'column': UNKNOWN, 'unit': UNKNOWN})}   # or velocity, or acceleration"


def _gear_channels(used: set[str | None]) -> Iterator[str]:
    if "pinion_torque" in used and "gear_torque" not in used:
        yield "gear_torque: balanced   # guess: it follows the pinion's; or held, or its channel"
    responses = {"transmission_error", "pinion_speed", "gear_speed", "acceleration"}
    if not used & responses and not {"pinion", "gear"} <= used:
        yield f"transmission_error: {_mapping({'column': UNKNOWN, 'unit': 'um'})}   # or another response"


def _declared(guess: Guess, system: str) -> str:
    stated = {"column": guess.column.reference, "unit": guess.unit}
    clock = {"time": {"column": guess.clock.reference, "unit": guess.clock.stamps.unit}} if guess.clock else {}
    mounted = {"mounting": "tangential"} if guess.channel == "acceleration" else {}
    needed = mounted | {"shaft": UNKNOWN} if _is_of_a_shaft(guess, system) else {}
    if is_linear_speed(guess.channel, guess.unit):
        needed = {"radius": {"value": UNKNOWN, "unit": "mm"}}
    return _mapping(stated | needed | clock)


def _is_of_a_shaft(guess: Guess, system: str) -> bool:
    """Whether it is an angle, or the acceleration of one, of which only the user knows whose."""
    if guess.channel == "acceleration":
        return system == GEAR and is_of_kind(guess.unit, "rad/s^2")
    return guess.channel == "transmission_error" and is_angle(guess.unit)


def _comment(guess: Guess, found: Inspection, system: str) -> str:
    said = f"guess: {guess.why}"
    if guess.unit == UNKNOWN:
        said += f"; fill in its unit{': ' + guess.unit_by if guess.unit_by else ''}"
    elif guess.unit_by:
        said += f"; unit {guess.unit}: {guess.unit_by}"
    if _is_of_a_shaft(guess, system):
        said += "; shaft: whose it is, pinion or gear"
    elif guess.channel == "acceleration" and guess.used and any(c.kind != "signal" for c in found.measured):
        said += f"; {_CASING}"
    if found.table.full_scale is not None:
        said += "; range: {value: …, unit: …} says what full scale stands for"
    return said


def _parameters(system: str, listed: Sequence[Guess]) -> list[str]:
    """The geometry, which the transmission error of two encoders needs."""
    if system != GEAR:
        return []
    needed = {"pinion", "gear"} <= {guess.channel for guess in listed if guess.used}
    mark = "" if needed else "# "
    lines = [f"{mark}parameters:   # {'needed with two encoders' if needed else 'where it differs from the usual rig'}"]
    for name, unit in _GEOMETRY.items():
        value = {"value": UNKNOWN} | ({"unit": unit} if unit else {})
        lines.append(f"{mark}  {name}: {_mapping(value)}")
    return lines


def _gear(found: Inspection, listed: Sequence[Guess]) -> Iterator[str]:
    """Encoders, and the conditions that a gear pair needs where nothing measured them."""
    used = {guess.channel: guess for guess in listed if guess.used}
    encoders = [name for name in _ENCODERS if name in used]
    edges = [column for column in found.columns if column.kind == EDGES]
    if encoders or edges:
        yield "    encoders:"
    free = [name for name in _ENCODERS if name not in encoders]
    for name, column in zip(free, edges, strict=False):
        stated = {"timestamps": column.reference, "unit": column.unit or UNKNOWN, _COUNTS[name]: UNKNOWN}
        yield f"      {name}: {_mapping(stated)}   # guess: its values {column.says}; or {' or '.join(_others(name))}"
    if "gear" in used and "pinion" not in used:
        yield f"      pinion: {_mapping({'column': UNKNOWN, 'counts_per_revolution': UNKNOWN})}   # beside the gear's"
    for name in encoders:
        stated = {"column": used[name].column.reference, _COUNTS[name]: used[name].counts or UNKNOWN}
        stated |= {"index": used[name].index.reference} if used[name].index else {}
        twice = "# " if name == "tacho" and "pinion" in used else ""
        yield f"      {twice}{name}: {_mapping(stated)}   # guess: {used[name].why}"
    missing = {}
    if not edges and not used.keys() & {"pinion_angle", "pinion_speed", "pinion", "gear", "tacho"}:
        missing["pinion_speed"] = "rpm"
    is_casing = "acceleration" in used and not _is_of_a_shaft(used["acceleration"], GEAR)
    if "pinion_torque" not in used and (not is_casing or used.keys() & _WITH_TORQUE):
        missing["pinion_torque"] = "N*m"
    if missing:
        yield "    conditions:"
    for name, unit in missing.items():
        yield f"      {name}: {_mapping({'value': UNKNOWN, 'unit': unit})}   # no column looks like it"


def _others(name: str) -> list[str]:
    return [one for one in _ENCODERS if one != name]


def _left_out(found: Inspection, listed: Sequence[Guess]) -> Iterator[str]:
    """What the YAML says nothing of, as comments."""
    stamps = found.columns[found.time.index] if found.time else None
    told = {id(guess.column): guess for guess in listed}
    others = [_scalar(column.reference) for column in found.columns if column.kind == ELSEWHERE]
    if others:
        yield f"    # further records: {', '.join(others)}"
    numbers = [column for column in found.columns if column.values.size == 1 and found.length > 1]
    if numbers:
        yield f"    # not declared: single numbers: {', '.join(_scalar(column.reference) for column in numbers)}"
    for column in found.columns:
        if column in numbers or column.kind in (EDGES, ELSEWHERE):
            continue
        guess = told.get(id(column))
        if column is stamps or (guess is not None and guess.channel):
            continue
        if guess is None and column.values.size not in (0, found.length):
            said = f"{column.values.size} values, not {found.length}"
        else:
            said = column.says if guess is None else guess.why or "nothing says what it is"
        yield f"    # not declared: column {_scalar(column.reference)}: {said}"
