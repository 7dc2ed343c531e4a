"""Which channel of a measurement.yaml each column of a bare file may be: by its name, its unit and its looks."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError
from gear_damping.measurement.column import Column
from gear_damping.measurement.column_kinds import (
    COUNTER,
    EDGES,
    PULSES,
    TURNING,
    counts_of_turn,
    rises,
    turn_of,
    unit_of_turn,
)
from gear_damping.measurement.files import UNKNOWN
from gear_damping.measurement.formats.table import Table
from gear_damping.measurement.inspection import Inspection, clock_of, inspect_table, of_columns
from gear_damping.measurement.named_units import NAMED_UNITS, unit_of_name
from gear_damping.measurement.staircase import is_staircase, rests_between_jumps
from gear_damping.measurement.vocabulary import INPUTS
from gear_damping.units import parse_unit

GEAR, OSCILLATOR = "gear_pair", "oscillator"
_OF_THE_PINION = r"pinion|ritzel|_?1$|drive|(?<![a-z])in"
_OF_THE_GEAR = r"gear|wheel|_?2$|driven|(?<![a-z])out"
_PINION = re.compile(r"pinion|ritzel|pignon|piñ[oó]n|pinhão|pignone")  # what only a gear pair has
_TACHO = re.compile(r"tach|keyphas")  # what only a shaft that turns has, and no relay
# Roots of words in English, German, Spanish, Portuguese, Italian and French.
_ANGLE, _ACCELERATION = r"angle|winkel|[aáâ]ngulo|angolo", r"acc|acel|beschl"
# The first that fits counts; names in lower case without units and paths.
_GEAR_NAMES = (
    ("transmission_error", r"transmission|^d?te$|dte|^te[_ ]|[_ ]te$|drehfehler|drehweg"),
    ("torque", r"torque|moment|^t[12]$|^m[12]$"),
    ("speed", r"speed|rpm|omega|drehzahl|veloc|vitesse|^n[12]?$"),
    ("angle", rf"{_ANGLE}|theta|phi|encoder|enc"),
    ("tacho", r"tacho|tach|pulse|keyphas|trigger|once"),
    ("acceleration", rf"{_ACCELERATION}|^a_?[xyz]?\d?$|vibration|^case|casing|housing"),
)
_OSCILLATOR_NAMES = (
    ("base_acceleration", r"(base|ground|table|shaker).*(acc|^a)"),
    ("acceleration", rf"{_ACCELERATION}|^a_?[xyz]?$|ddot"),
    (
        "force",
        r"force|kraft|fuerza|forza|torque|load|input|entrada|excit|command|volt|spannung|tensi[oó]n|tensão|current|strom|corrient|"
        r"corrente|courant|^u_?\d?$|^f_?\d?$|^tau|^vir$|^i$",
    ),
    ("velocity", r"vel|speed|vitesse|geschw|rate|gyro|omega|dot$|^v$|^dq"),
    (
        "displacement",
        rf"disp|pos|{_ANGLE}|theta|phi|roll|pitch|yaw|heave|deflec|desplaz|spost|d[eé]plac|auslenk|output|"
        r"^[qxyz](_?\w)?$|^s$|way|weg",
    ),
)
_COMPONENT = re.compile(r"[/.]([xyzw])$")  # of what stands before it in a path: `/imu/angular_velocity/x`
_OF_NO_MOTION = re.compile(r"magnet|orient|quat|temperat")  # what has components and is no channel by these
_SET_POINT = re.compile(
    r"(^|[^a-z])(cmd|command(ed)?|set[ _-]?point|target|desired|ref(erence)?|soll(wert)?|consign[ae])($|[^a-z])"
    r"|[ _]set$"
)
_MEASURED = ("velocity", "acceleration", "displacement", "speed", "angle")  # of which a set point is none
_LETTERED = re.compile(r"(ch(an(nel)?)?|kanal|input|port|probe)[ ._-]*[a-d]")  # of an oscilloscope, and no quantity
_OF_FREQUENCY = ("Hz", "kHz", "MHz")  # an axis of a spectrum, or what an exciter was set to
_OTHERWISE = {"torque": "N*m", "tacho": "V"}
_LOWEST, _CLEARLY = 4, 1.2  # lines of a spectrum that hold drifts; ratio by which one column beats an earlier one
_DERIVED = 0.98  # correlation of a column with the slope of another
_HIGHER = 1.3  # ratio of the mean frequencies from which the faster column may be the input
_FEWEST_TURNS = 3  # between pulses of an index, assumed
_ROUND = (1000, 100, 10)  # encoders have a power of two of counts, or a round number of them
_SOME_TURNS = 7.0  # an angle within this is more likely in rad than in deg


@dataclass(frozen=True, eq=False)
class Guess:
    """What a column may be.

    Args:
        column: The column.
        channel: The channel, `pinion`, `gear` or `tacho` of the encoders, or None where nothing says.
        why: What the channel was guessed by.
        unit: Its unit, or UNKNOWN.
        unit_by: What the unit was guessed by; "" where the file says it.
        used: Whether it is the one of its channel that the YAML declares.
        counts: How many counts of a shaft's counter make a turn; None where nothing says it.
        index: The column that pulses once a turn of it; None where none does.
        clock: The column of its own time stamps; None where those of the record are its.
    """

    column: Column
    channel: str | None
    why: str
    unit: str
    unit_by: str
    used: bool = True
    counts: int | None = None
    index: Column | None = None
    clock: Column | None = None


def guessed(table: Table) -> tuple[Inspection, tuple[str, str], list[Guess]]:
    """What a file holds, the system that it may be of with what says so, and what each column may be.

    A clock beside all that is used is that of the record; one beside some of it is theirs.

    Raises:
        InputError: no column holds numbers, or they are a spectrum.
    """
    found, system, listed = _guessed(inspect_table(table))
    clocks = {id(guess.clock): guess.clock for guess in listed if guess.used}
    only = clocks.popitem()[1] if len(clocks) == 1 else None
    return (found, system, listed) if only is None else _guessed(inspect_table(table, only.reference))


def _guessed(found: Inspection) -> tuple[Inspection, tuple[str, str], list[Guess]]:
    system = system_of(found)
    listed = _of_one_run([replace(guess, clock=clock_of(found, guess.column)) for guess in guesses(found, system[0])])
    found = of_columns(found, [guess.column for guess in listed if guess.used and guess.clock is None])
    return found, system, listed


def _of_one_run(listed: list[Guess]) -> list[Guess]:
    """The same where the columns that were chosen have several clocks, and one clock has a column of each channel.

    Those are runs side by side, and the force of one is none of the motion of another.
    """
    wanted, runs = {guess.channel for guess in listed if guess.used}, {}
    for guess in (guess for guess in listed if guess.channel):
        runs.setdefault(id(guess.clock), []).append(guess)
    whole = next((run for run in runs.values() if wanted <= {guess.channel for guess in run}), None)
    if whole is None or len({id(guess.clock) for guess in listed if guess.used}) < 2:
        return listed
    kept = {id(guess.column) for guess in _one_each(whole) if guess.used and guess.channel in wanted}
    return [replace(guess, used=id(guess.column) in kept) for guess in listed]


def system_of(found: Inspection) -> tuple[str, str]:
    """The system that a file may be of, and what says so."""
    for column in found.measured:
        if _by_name(column, _GEAR_NAMES) == "transmission_error":
            return GEAR, f"the name of column '{column.reference}'"
        if _PINION.search(_plain(column)):
            return GEAR, f"the name of column '{column.reference}'"
        if column.kind in (TURNING, COUNTER):
            return GEAR, f"column '{column.reference}' may be of a shaft that turns: {column.says}"
    edges = next((column for column in found.columns if column.kind == EDGES), None)
    if edges is not None:
        return GEAR, f"column '{edges.reference}' may be of a shaft that turns: its values {edges.says}"
    pulses = [column for column in found.measured if column.kind == PULSES]
    driven = {_oscillator_channel(column)[0] for column in found.measured} & {"displacement", "force"}
    named = [column for column in pulses if _TACHO.search(_plain(column))]
    if pulses and (named or not driven):
        return GEAR, f"column '{(named or pulses)[0].reference}' may be a tacho: {(named or pulses)[0].says}"
    return OSCILLATOR, "no column looks like a shaft that turns"


def guesses(found: Inspection, system: str) -> list[Guess]:
    """What each column that says something may be, in the order of the file; one is used for each channel."""
    read = _gear_channel if system == GEAR else _oscillator_channel
    named = [(column, *read(column)) for column in found.measured]
    if system == OSCILLATOR:
        named = _completed(_without_references(named))
    listed = [_guess(column, channel, why) for column, channel, why in named]
    listed = _one_each(_counted(listed) if system == GEAR else listed)
    return _derived(listed, found) if system == OSCILLATOR else listed


def _oscillator_channel(column: Column) -> tuple[str | None, str]:
    unit = column.unit or unit_of_name(column.reference)
    by_unit = _channel_of_unit(unit)
    if by_unit:
        return by_unit, f"by its unit {unit}"
    if unit in _OF_FREQUENCY:
        return None, f"in {unit}"
    name = _by_name(column, _OSCILLATOR_NAMES)
    return name, "by its name" if name else ""


def _channel_of_unit(unit: str | None) -> str | None:
    """What an oscillator's channel in this unit is, where there is no doubt."""
    kinds = {
        "displacement": ("m", "rad"), "velocity": ("m/s", "rad/s"), "acceleration": ("m/s^2", "rad/s^2"),
        "force": ("N", "N*m"),
    }  # fmt: skip
    try:
        dimension = parse_unit(unit).dimension if unit else None
    except InputError:
        return None
    return next((name for name, units in kinds.items() if dimension in [parse_unit(u).dimension for u in units]), None)


def _without_references(named: list[tuple[Column, str | None, str]]) -> list[tuple[Column, str | None, str]]:
    """The same where a column jumps that only by its name is a motion: beside one that moves it is its set value."""
    motions = {"displacement", "velocity"}
    jumps = [channel in motions and is_staircase(column.inside) for column, channel, _ in named]
    moving = {channel: c for (c, channel, _), jump in zip(named, jumps, strict=True) if channel in motions and not jump}
    found = []
    for (column, channel, why), jump in zip(named, jumps, strict=True):
        if jump and why == "by its name" and channel in moving:
            said = f"jumps and stands still, as a set value beside '{moving[channel].reference}' does"
            found.append((column, None, said))
        else:
            found.append((column, channel, why))
    return found


def _completed(named: list[tuple[Column, str | None, str]]) -> list[tuple[Column, str | None, str]]:
    """The same where names say too little: what rests but for jumps drives, else the faster one; the other answers."""
    channels = {channel for _, channel, _ in named}
    if channels & {"displacement", "velocity", "acceleration"}:
        return named
    signals = [(column, channel) for column, channel, _ in named if column.spectrum]
    free = [column for column, channel in signals if channel is None] or [column for column, _ in signals]
    free.sort(key=lambda column: column.spectrum.centroid)  # an input by its name that nothing answers is the answer
    if not free:
        return named
    resting = [column for column in free if rests_between_jumps(column.inside)]
    moving = [column for column in free if column not in resting]
    if len(resting) == 1 and moving:
        chosen = _driven(moving[0], resting[0], "force" in channels)
    else:
        chosen = {id(free[0]): ("displacement", "the slowest column; what it is, only you know")}
        lies_higher = len(free) == 2 and free[1].spectrum.centroid > _HIGHER * free[0].spectrum.centroid
        if "force" not in channels and lies_higher:
            chosen[id(free[1])] = ("force", f"its content lies higher than that of '{free[0].reference}': an input?")
    return [(column, *chosen.get(id(column), (channel, why))) for column, channel, why in named]


def _driven(answer: Column, drives: Column, is_known: bool) -> dict[int, tuple[str, str]]:
    """What two columns are of which one moves on where the other rests, by their identity.

    Args:
        answer: The one that moves on.
        drives: The one that rests.
        is_known: Whether another column is the input by its name.
    """
    chosen = {id(answer): ("displacement", f"moves on where '{drives.reference}' rests; what it is, only you know")}
    if not is_known:
        chosen[id(drives)] = ("force", f"rests but for jumps where '{answer.reference}' moves on: an input?")
    return chosen


def _gear_channel(column: Column) -> tuple[str | None, str]:
    name = _by_name(column, _GEAR_NAMES)
    shaft = "gear" if re.search(_OF_THE_GEAR, _plain(column)) else "pinion"
    if re.search(_OF_THE_PINION, _plain(column)):
        shaft = "pinion"
    if column.kind == COUNTER:
        return shaft, column.says
    if column.kind == PULSES:
        return "tacho", column.says
    if column.kind == TURNING and counts_of_turn(column.inside):
        return shaft, column.says
    if column.kind == TURNING:
        return ("pinion_angle", column.says) if shaft == "pinion" else (None, "the angle of the gear")
    if name == "angle":
        return None, "named like an angle, and does not turn"
    if name in ("torque", "speed"):
        return f"{shaft}_{name}", "by its name"
    unit = column.unit or unit_of_name(column.reference)
    by_unit = _channel_of_unit(unit) if name is None else None
    if by_unit == "acceleration":
        return by_unit, f"by its unit {unit}"
    if by_unit == "force" and parse_unit(unit).dimension == parse_unit("N*m").dimension:
        return f"{shaft}_torque", f"by its unit {unit}"
    names_a_shaft = _PINION.search(_plain(column)) or re.search("gear|wheel", _plain(column))
    if by_unit == "velocity" and (names_a_shaft or not is_linear_speed(f"{shaft}_speed", unit)):
        return f"{shaft}_speed", f"by its unit {unit}"
    return name, "by its name" if name else ""


def is_linear_speed(channel: str | None, unit: str) -> bool:
    """Whether it is the speed of a shaft that is seen at a radius, in m/s."""
    linear = parse_unit("m/s").dimension
    return str(channel).endswith("_speed") and unit != UNKNOWN and parse_unit(unit).dimension == linear


def _by_name(column: Column, names: Sequence[tuple[str, str]]) -> str | None:
    plain, whole = _plain(column), _whole(column)
    if _LETTERED.fullmatch(whole):
        return None
    component = _COMPONENT.search(_bare(column))
    if component and _OF_NO_MOTION.search(plain):
        return None
    asked = _MEASURED if _is_asked_for(column) else ()
    found = (
        channel
        for channel, words in names
        if channel not in asked and (re.search(words, plain) or re.search(words, whole))
    )
    alone = (channel for channel, words in names if component and re.search(words, component[1]))
    return next(found, None) or next(alone, None)


def _is_asked_for(column: Column) -> bool:
    """Whether a name says that it is a set point."""
    return bool(_SET_POINT.search(_whole(column)))


def _whole(column: Column) -> str:
    """A name with all its words, without the path before it."""
    return _bare(column).split("/")[-1]


def _bare(column: Column) -> str:
    """A name in lower case, without the unit in its brackets, behind a stroke or an `in`."""
    if isinstance(column.reference, int):
        return ""
    bare = re.sub(r"[(\[][^)\]]*[)\]]\s*$", "", column.reference).strip()
    bare = re.sub(rf"(^|\s)in\s+{re.escape(column.unit)}$", "", bare) if column.unit else bare
    is_behind = "/" in bare or "*" in bare
    return bare.removesuffix(column.unit or "").rstrip(" /_").lower() if is_behind else bare.lower()


def _plain(column: Column) -> str:
    """The last word of a name, without the path before it, a unit at its end and the letter of a component."""
    words = [word for word in re.split(r"[/\s]+|\.(?=\D)", _bare(column)) if word]
    kept = words[-1] if words else ""
    if len(words) > 1 and (kept in NAMED_UNITS or _COMPONENT.search(_bare(column))):
        return words[-2]
    head, _, tail = kept.rpartition("_")
    return head if head and tail in NAMED_UNITS else kept


def _guess(column: Column, channel: str | None, why: str) -> Guess:
    unit, by = _unit(column, channel)
    return Guess(column, channel, why, unit, by, channel is not None)


def _unit(column: Column, channel: str | None) -> tuple[str, str]:
    """The unit and what it was guessed by: "" where the file says it."""
    if column.unit:
        try:
            parse_unit(column.unit)
        except InputError:
            return UNKNOWN, f"the file says '{column.unit}', which is no unit that is known"
        return column.unit, ""
    named = unit_of_name(column.reference)
    if named:
        return named, "from its name"
    turn = turn_of(column.inside)
    if turn is not None and unit_of_turn(turn):
        return unit_of_turn(turn), f"it falls back by {turn:.4g}"
    return _unit_by_meaning(column, channel)


def _unit_by_meaning(column: Column, channel: str | None) -> tuple[str, str]:
    name = _plain(column)
    meant = "torque" if re.search("torque", name) else channel
    if meant in _OTHERWISE:
        return _OTHERWISE[meant], "the usual one"
    if channel in ("displacement", "pinion_angle") and re.search(f"{_ANGLE}|theta|phi|roll|pitch|yaw", name):
        if column.kind != TURNING and np.max(np.abs(column.inside)) <= _SOME_TURNS:
            return "rad", f"an angle within {np.max(np.abs(column.inside)):.3g}"
        return ("deg", "an angle by its name") if column.kind != TURNING else (UNKNOWN, "")
    return UNKNOWN, ""


def _counted(listed: list[Guess]) -> list[Guess]:
    """The same with the counts of a turn: those after which a counter begins again, or between the pulses of an index.

    What pulses once a turn of a counter is no tacho. In gears the pulses of one shaft fit the counter of the other too,
    and the rounder number tells whose they are.
    """
    found = [replace(guess, counts=counts_of_turn(guess.column.inside)) for guess in listed]
    pairs = [
        (*between, at, place)
        for at, counter in enumerate(found)
        for place, pulses in enumerate(found)
        if (between := _counts_between(counter.column, pulses.column)) is not None
    ]
    for _, counts, at, place in sorted(pairs):
        counter, pulses = found[at], found[place]
        if counter.counts or pulses.channel is None:
            continue  # told by a rounder number
        found[at] = replace(counter, counts=counts, index=pulses.column)
        why = f"pulses once in {counts} counts of '{counter.column.reference}', as the index of an encoder"
        found[place] = replace(pulses, channel=None, why=why, used=False)
    return found


def _counts_between(counter: Column, pulses: Column) -> tuple[int, int] | None:
    """How little round the counts from pulse to pulse are, and they, as round as may be; None where they differ."""
    if counter.kind != COUNTER or pulses.kind != PULSES or counter.values.size != pulses.values.size:
        return None
    high = pulses.values > (np.nanmin(pulses.values) + np.nanmax(pulses.values)) / 2
    at = counter.values[rises(high) + 1]
    apart, step = np.abs(np.diff(at)), float(np.abs(np.diff(counter.values)).max())
    if apart.size < _FEWEST_TURNS or not np.ptp(apart) <= 2 * step or not apart.min() > step:
        return None
    mean, within = float(apart.mean()), step / apart.size
    tried = (2 ** round(np.log2(mean)), *(round(mean / unit) * unit for unit in _ROUND), round(mean))
    return next((how, int(counts)) for how, counts in enumerate(tried) if abs(counts - mean) <= max(within, 1.0))


def _one_each(listed: list[Guess]) -> list[Guess]:
    """One column for each channel: the one measured that stands out most from its noise and moves most to and fro."""
    best: dict[str, Guess] = {}
    for guess in listed:
        held = best.get(guess.channel) if guess.channel else None
        if guess.channel and (held is None or _is_before(guess, held)):
            best[guess.channel] = guess
    return [replace(guess, used=guess.channel is not None and best[guess.channel] is guess) for guess in listed]


def _is_before(guess: Guess, held: Guess) -> bool:
    """Whether it stands out more than another of its channel; what was measured does before what was asked for."""
    is_asked, other = (_is_asked_for(one.column) for one in (guess, held))
    if is_asked != other:
        return other
    return _prominence(guess.column) > _CLEARLY * _prominence(held.column)


def _prominence(column: Column) -> float:
    """The swing above the lowest lines of the spectrum over the noise or the step, less where it drifts instead."""
    if column.spectrum is None:
        return 0.0
    tiny = np.finfo(float).tiny
    swing = float(column.spectrum.density[_LOWEST:].sum() * column.spectrum.frequency[1]) ** 0.5
    return swing * (swing / max(column.deviation, tiny)) ** 2 / max(column.spectrum.noise, column.step, tiny)


def _derived(listed: list[Guess], found: Inspection) -> list[Guess]:
    """A velocity or acceleration that is the slope of a declared column is not declared beside it."""
    base = next((g for g in listed if g.used and g.channel == "displacement"), None)
    if base is None or found.rate is None:
        return listed
    result = []
    for guess in listed:
        order = {"velocity": 1, "acceleration": 2}.get(guess.channel or "")
        if guess.used and order and _is_slope(base.column.inside, guess.column.inside, order):
            why = f"{guess.why}; it is the slope of '{base.column.reference}': declare it where a sensor of its own "
            result.append(replace(guess, why=why + "measured it", used=False))
        else:
            result.append(guess)
    return result


def _is_slope(base: NDArray[np.float64], values: NDArray[np.float64], order: int) -> bool:
    """Whether a column goes up and down with the slope of another, seen with the noise of both smoothed."""
    n = min(base.size, values.size)
    slope = base[:n]
    for _ in range(order):
        slope = np.gradient(slope)
    width = max(1, n // 500)
    smooth = [np.convolve(one, np.ones(width) / width, "valid") for one in (slope, values[:n])]
    if min(np.ptp(one) for one in smooth) == 0:
        return False
    return bool(abs(np.corrcoef(*smooth)[0, 1]) > _DERIVED)


def inputs(listed: Sequence[Guess]) -> list[Guess]:
    """Those that may drive the system."""
    return [guess for guess in listed if guess.channel in INPUTS]
