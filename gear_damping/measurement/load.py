"""The door for measured data: a measurement.yaml becomes a Measurement, or one InputError."""

from collections import Counter
from dataclasses import replace
from pathlib import Path

from gear_damping.errors import Problem
from gear_damping.measurement.assemble import Assembler
from gear_damping.measurement.declaration import declared_plan
from gear_damping.measurement.fields import Problems
from gear_damping.measurement.formats.registry import MAX_BYTES
from gear_damping.measurement.own_units import UnitSystem
from gear_damping.measurement.plan import Plan, RecordPlan
from gear_damping.measurement.raw import Files, RawReader, RawRecord
from gear_damping.measurement.record import Finding, Measurement, Record
from gear_damping.measurement.timebase import RATE_TOLERANCE
from gear_damping.measurement.yaml_file import read_yaml


def load_measurement(path: str | Path, max_bytes: int = MAX_BYTES) -> Measurement:
    """Read a measurement.yaml and the files that it names.

    Args:
        path: The YAML file; the files in it are relative to its folder.
        max_bytes: Larger files are refused before they are read.

    Returns:
        The measurement; what is suspicious in it stands in `findings`.

    Raises:
        InputError: everything that cannot be read or understood, all at once.
    """
    path = Path(path)
    content = read_yaml(path)
    problems, source = Problems(), str(path)
    plan = declared_plan(content, problems, source)
    if plan is None:
        problems.raise_any()
    raw = _read(plan, path.parent, max_bytes, problems, source)
    declared = [(channel.plan.name, channel.unit) for record in raw for channel in record.channels]
    declared += [(name, quantity.unit) for record in raw for name, quantity in record.plan.conditions.items()]
    units = UnitSystem(plan.system, declared)
    own = {}
    for name, quantity in plan.own.items():
        with problems.collecting():
            own[name] = units.force_gain(quantity, source)
    names = _names(plan.records, problems, source)
    assembler = Assembler(plan, units, problems, source)
    records = [assembler.record(record, names[record.plan.key]) for record in raw]
    problems.raise_any()
    return Measurement(plan.system, {**plan.parameters, **own}, _compared(records), path.resolve())


def _read(plan: Plan, folder: Path, max_bytes: int, problems: Problems, source: str) -> list[RawRecord]:
    files = Files(folder, max_bytes)
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


def _compared(records: list[Record]) -> tuple[Record, ...]:
    """Note the records whose rate differs from the first one's."""
    first = records[0]
    compared = []
    for record in records:
        if abs(record.sampling_rate / first.sampling_rate - 1) > RATE_TOLERANCE:
            message = (
                f"sampled at {record.sampling_rate:.6g} Hz, '{first.name}' at {first.sampling_rate:.6g} Hz; "
                "check that both rates are right"
            )
            finding = Finding("mixed_rates", message, record.name, severity="note")
            record = replace(record, findings=(*record.findings, finding))
        compared.append(record)
    return tuple(compared)
