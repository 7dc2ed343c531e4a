"""The door for measured data: a measurement.yaml becomes a Measurement, or one InputError.

What reads and assembles data is imported where data is read, so that a YAML alone is checked within a second.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from math import pi
from numbers import Real
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from gear_damping.at_home import at_home
from gear_damping.errors import InputError, Problem, with_article
from gear_damping.measurement.declaration import Plan, RecordPlan, declared_plan
from gear_damping.measurement.declared_units import UnitSystem, written
from gear_damping.measurement.files import UNKNOWN, Files, as_a_file, read_yaml, unfilled
from gear_damping.measurement.fitted_twice import with_what_is_fitted_twice
from gear_damping.measurement.formats.registry import MAX_BYTES, readers
from gear_damping.measurement.own_system import own_systems
from gear_damping.measurement.record import Finding, Measurement, Quantity, Record
from gear_damping.measurement.record_checks import oversampled_alike
from gear_damping.own_files import plugin_paths
from gear_damping.schema.values import Problems

if TYPE_CHECKING:
    from gear_damping.measurement.raw import RawRecord

RECORD = re.compile(r"records\[(\d+)\]")
ONE_RATE = 1e-6  # rates that differ by less are one, written with other digits
DAMPING_RATIO = "damping_ratio"  # the parameter of any system that states its damping over the critical one
OTHER_RATE = 0.01  # rates that differ by more are said


def check_declaration(path: str | Path, plugins: Sequence[str | Path] = ()) -> Plan:
    """Check a measurement.yaml without opening the files that it names, and without importing what reads them.

    Args:
        path: The YAML file.
        plugins: Files of one's own that declare systems.

    Returns:
        What it declares.

    Raises:
        InputError: everything that is wrong with the YAML, all at once.
    """
    content = _filled(path)
    with _telling_names(content):
        return _checked(content, str(path), plugins)


def load_measurement(
    path: str | Path, max_bytes: float | None = None, plugins: Sequence[str | Path] = ()
) -> Measurement:
    """Read a measurement.yaml and the files that it names.

    Args:
        path: The YAML file; the files in it are relative to its folder.
        max_bytes: Larger files are refused before they are read; the readers' own limit where None.
        plugins: Files of one's own that read further formats, or declare systems.

    Returns:
        The measurement; what is suspicious in it stands in `findings`.

    Raises:
        InputError: everything that cannot be read or understood, all at once.
    """
    if max_bytes is not None and (not isinstance(max_bytes, Real) or isinstance(max_bytes, bool) or max_bytes <= 0):
        rule = "must be a positive number of bytes"
        raise InputError(Problem("max_bytes", rule, max_bytes, "for example max_bytes=4e9"))
    content = _filled(path)
    with _telling_names(content):
        return _loaded(content, at_home(path), max_bytes, plugin_paths(plugins))


def _filled(path: str | Path) -> object:
    """The content of a measurement.yaml.

    Raises:
        InputError: it cannot be read, or something in it waits to be filled in.
    """
    if not isinstance(path, str | PathLike):
        rule = f"must be a path, and is {with_article(type(path).__name__)}"
        remedy = "give the path of a measurement.yaml, or what was read from it to identify and explain"
        raise InputError(Problem("path", rule, remedy=as_a_file(path) or remedy))
    content = read_yaml(at_home(path))
    rule, remedy = f"{UNKNOWN} stands for what is not filled in yet", "write what the rig or its recorder says"
    if missing := list(unfilled(content)):
        with _telling_names(content):
            raise InputError([Problem(key, rule, remedy=remedy, source=str(path)) for key in missing])
    return content


@contextmanager
def _telling_names(content: object) -> Iterator[None]:
    """Problems of a record that has a name say it: of thirty records nobody counts to `records[17]`."""
    try:
        yield
    except InputError as error:
        declared = content.get("records") if isinstance(content, dict) else None
        listed = declared if isinstance(declared, list) else []
        names = [one.get("name") if isinstance(one, dict) else None for one in listed]
        raise InputError([_with_name(problem, names) for problem in error.problems]) from None


def _with_name(problem: Problem, names: Sequence[object]) -> Problem:
    found = RECORD.match(problem.key)
    name = names[int(found[1])] if found and int(found[1]) < len(names) else None
    if not isinstance(name, str):
        return problem
    said = f"record '{name}'"
    return replace(problem, source=f"{problem.source}, {said}" if problem.source else said)


def _checked(content: object, source: str, plugins: Sequence[str | Path]) -> Plan:
    problems = Problems()
    plan = declared_plan(content, problems, source, own_systems(plugins))
    if plan is not None:
        _names(plan.records, problems, source)
        declared = list(_units(plan))
        if plan.si is not None or all(unit for _, unit, *_ in declared):
            known = [(name, unit) for name, unit, *_ in declared if unit]
            units = UnitSystem(plan.si, known)
            _compare_units(plan, units, problems, source)
    problems.raise_any()
    return plan


def _loaded(content: object, path: Path, max_bytes: int | None, plugins: Sequence[str | Path]) -> Measurement:
    from gear_damping.measurement.assemble import Assembler

    problems, source = Problems(), str(path)
    systems = own_systems(plugins)
    plan = declared_plan(content, problems, source, systems)
    if plan is None:
        problems.raise_any()
    files = Files(path.parent, MAX_BYTES if max_bytes is None else max_bytes, readers(plugins))
    raw = _read(plan, files, problems, source)
    declared = [(channel.plan.name, channel.unit) for record in raw for channel in record.channels]
    declared += [(name, quantity.unit) for record in raw for name, quantity in record.plan.conditions.items()]
    units = UnitSystem(plan.si, declared)
    own = _compare_units(plan, units, problems, source)
    names = _names(plan.records, problems, source)
    assembler = Assembler(plan, units, problems, source)
    records = [assembler.record(record, names[record.plan.key]) for record in raw]
    problems.raise_any()
    parameters = {**plan.parameters, **own}
    _refuse_unseen_spring(parameters.get("stiffness"), records, source)
    _refuse_longer_than_records(plan, records, source)
    driven = _free(_of_one_force(_overdamped(records, parameters), parameters.get("stiffness")))
    kept, own_system = oversampled_alike(_compared(driven)), systems.get(plan.system)
    found = Measurement(plan.system, parameters, kept, path.resolve(), plan.segment_s, own_system)
    return replace(found, records=with_what_is_fitted_twice(kept, found.base.responses))


def _units(plan: Plan) -> Iterable[tuple[str, str | None, str, float | None, str]]:
    """Name, unit, key, radius on a shaft, and value as written, of what has a unit that must fit the others."""
    for record in plan.records:
        for channel in record.channels:
            yield channel.name, channel.unit, f"{channel.key}.unit", channel.shaft_radius, ""
            for limit, quantity in () if channel.geometry else channel.limits.items():  # of an angle: with its header
                said = written(quantity)
                yield channel.name, quantity.unit, f"{channel.key}.{limit}", channel.shaft_radius, said
        for name, quantity in record.conditions.items():
            yield name, quantity.unit, f"{record.key}.conditions.{name}", None, ""


def _compare_units(plan: Plan, units: UnitSystem, problems: Problems, source: str) -> dict[str, Quantity]:
    """Note every unit that is not of its kind; returns the parameters in the rig's own units."""
    for name, unit, key, radius, said in _units(plan):
        with problems.collecting():
            if unit:
                units.conversion(name, unit, key, source, radius, said)
    own = {}
    for name, quantity in plan.own.items():
        with problems.collecting():
            own[name] = units.force_gain(quantity, source)
    return own


def _read(plan: Plan, files: Files, problems: Problems, source: str) -> "list[RawRecord]":
    from gear_damping.measurement.raw import RawReader

    records = []
    for record in plan.records:
        with problems.collecting():
            table = files.table(record.file, f"{record.key}.file", source)
            raw = RawReader(record, table, problems, source).read(files.sha256(table.path))
            records += [raw] if raw else []
    return records


def _names(plans: tuple[RecordPlan, ...], problems: Problems, source: str) -> dict[str, str]:
    """A unique name for each record: the given one, else its file's, numbered where that repeats."""
    given = Counter(plan.name for plan in plans if plan.name)
    for name, count in given.items():
        if count > 1:
            rule = f"{count} records bear the name '{name}'"
            problems.append(Problem("records", rule, remedy="give each its own", source=source))
    stems = Counter(Path(plan.file).stem for plan in plans if not plan.name)
    names, seen = {}, Counter()
    for plan in plans:
        stem = Path(plan.file).stem
        seen[stem] += not plan.name
        alone = stems[stem] == 1 and stem not in given
        names[plan.key] = plan.name or (stem if alone else f"{stem}_{seen[stem]}")
    return names


def _refuse_unseen_spring(stiffness: Quantity | None, records: list[Record], source: str) -> None:
    """An oscillator's stated spring makes it swing at a frequency that its records can show."""
    stated = (stiffness.value if stiffness else 0.0) ** 0.5 / (2 * pi)
    highest = max(record.sampling_rate for record in records) / 2
    if stated > highest:
        rule = f"a natural frequency of {stated:.4g} Hz, and these records show nothing beyond {highest:.4g} Hz"
        remedy = "check its unit: it is the stiffness over the mass, in 1/s^2"
        raise InputError(Problem("parameters.stiffness", rule, stiffness.value, remedy, source))


def _refuse_longer_than_records(plan: Plan, records: list[Record], source: str) -> None:
    """Segments and delays lie within records."""
    longest, problems = max(record.duration for record in records), []
    if plan.segment_s is not None and plan.segment_s > longest:
        rule = f"is longer than every record, the longest of {longest:.4g} s"
        problems.append(Problem("segments", rule, f"{plan.segment_s:g} s", "shorten it, or leave it out", source))
    fastest = max(record.sampling_rate for record in records)
    if plan.segment_s is not None and plan.segment_s * fastest < 1:
        rule = f"is shorter than the time to the next sample at {fastest:.6g} Hz"
        problems.append(Problem("segments", rule, f"{plan.segment_s:g} s", "check its unit, or leave it out", source))
    for declared, record in zip(plan.records, records, strict=True):
        for name, channel in record.channels.items():
            if abs(channel.delay) >= record.duration:
                key, rule = f"{declared.key}.channels.{name}.delay", f"the record is {record.duration:.4g} s long"
                problems.append(Problem(key, rule, f"{channel.delay:g} s", "check its unit", source))
    if problems:
        raise InputError(problems)


def _free(records: list[Record]) -> list[Record]:
    """Free decays, where all that the file says of a force is that there was none."""
    forces = [record.conditions.get("force") for record in records]
    if any(force is None or force.value for force in forces):
        return records
    return [replace(r, conditions={n: q for n, q in r.conditions.items() if n != "force"}) for r in records]


def _of_one_force(records: list[Record], stiffness: Quantity | None) -> list[Record]:
    """The records without a constant force that is one in all of them, where no spring is: the fit has its own."""
    forces = [record.conditions.get("force") for record in records]
    if stiffness is None or stiffness.value or None in forces:
        return records
    if len({force.value for force in forces}) > 1 or not forces[0].value:
        return records
    message = (
        f"the force of {written(forces[0])} under conditions is left out: a constant force on what has no spring is "
        "fitted by itself, and its size tells nothing more"
    )
    note = Finding("constant_force", message, channel="force", severity="note")
    left = [{name: held for name, held in r.conditions.items() if name != "force"} for r in records]
    return [
        replace(record, conditions=conditions, findings=(*record.findings, replace(note, record=record.name)))
        for record, conditions in zip(records, left, strict=True)
    ]


def _overdamped(records: list[Record], parameters: Mapping[str, Quantity]) -> list[Record]:
    """The records; where a stated damping is beyond the critical one, the first with a note of that."""
    ratio = parameters.get(DAMPING_RATIO)
    if ratio is None or ratio.value <= 1:
        return records
    of_teeth = ", and teeth in mesh have a few per cent" if "n_teeth_pinion" in parameters else ""
    message = (
        f"parameters.{DAMPING_RATIO} states {100 * ratio.value:g} %, beyond critical: nothing that is let go swings "
        f"then{of_teeth}; write {ratio.value:g} % where that was meant"
    )
    note = Finding("overdamped", message, records[0].name, severity="note")
    return [replace(records[0], findings=(*records[0].findings, note)), *records[1:]]


def _compared(records: list[Record]) -> tuple[Record, ...]:
    """Make one of rates that differ by rounding, and note the records whose rate differs from the first one's."""
    first = records[0]
    compared, rates = [], []
    for record in records:
        same = next((rate for rate in rates if abs(record.sampling_rate / rate - 1) < ONE_RATE), record.sampling_rate)
        rates.append(same)
        record = replace(record, sampling_rate=same)
        sampled_evenly = record.uniform and first.uniform  # where events are stamped, they have no rate
        if sampled_evenly and abs(same / first.sampling_rate - 1) > OTHER_RATE:
            message = (
                f"sampled at {same:.6g} Hz, '{first.name}' at {first.sampling_rate:.6g} Hz; "
                "check that both rates are right"
            )
            finding = Finding("mixed_rates", message, record.name, severity="note")
            record = replace(record, findings=(*record.findings, finding))
        compared.append(record)
    return tuple(compared)
