"""What is done with something damaged; it is read, or refused by an InputError, and everything else is an escape."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from pathlib import Path

import yaml

from gear_damping.errors import InputError

from . import rigs, seeds
from .mutate import changed_tree, changed_words, damaged

READ, REFUSED = "read", "refused"
SHORT = 0.05  # min of a search
Case = Callable[[random.Random, Path], str]


def file_target(kind: str, folder: Path) -> Case:
    """Damaged files of one kind, through everything that task=inspect does before it draws."""
    from gear_damping.measurement.formats.registry import read_table
    from gear_damping.measurement.guessing import guessed
    from gear_damping.measurement.starting_yaml import starting_yaml

    kept = [(path.suffix, path.read_bytes()) for path in seeds.FILES[kind](folder)]

    def case(source: random.Random, place: Path) -> str:
        suffix, content = source.choice(kept)
        path = place / f"damaged{suffix}"
        path.write_bytes(damaged(content, source))
        found, system, listed = guessed(read_table(path))
        starting_yaml(found, system, listed)
        return READ

    return _refusing(case)


def declaration_target(folder: Path) -> Case:
    """Damaged declarations of sound data: as trees, and now and then as text."""
    from gear_damping.measurement.load import load_measurement

    texts = [path.read_text() for path in seeds.declarations(folder)]

    def case(source: random.Random, place: Path) -> str:
        text = source.choice(texts)
        path = folder / f"damaged_{place.name}.yaml"
        if source.random() < 0.3:
            path.write_bytes(damaged(text.encode(), source))
        else:
            changed = changed_tree(yaml.safe_load(text), source)
            path.write_text(yaml.safe_dump(changed, sort_keys=False, allow_unicode=True))
        try:
            load_measurement(path)
        finally:
            path.unlink()
        return READ

    return _refusing(case)


def command_target(folder: Path) -> Case:
    """Damaged words of a command, through everything that is checked before a run begins."""
    from gear_damping.config.command_line import read_command_line
    from gear_damping.tasks.composed import problems_of

    def case(source: random.Random, place: Path) -> str:
        words = changed_words(source.choice(seeds.OVERRIDES), source)
        typed = read_command_line(words)
        return REFUSED if typed.problems or problems_of(typed.first_job()) else READ

    return _refusing(case)


def rig_target(ask: str) -> Case:
    """Oscillators of any make, through everything that task=identify or a short task=explain does."""
    import gear_damping as gd

    def case(source: random.Random, place: Path) -> str:
        measured = gd.load(rigs.drawn(source, place))
        if ask == "explain":
            gd.explain(measured, minutes=SHORT).report(place / "report.html")
        else:
            found = gd.identify(measured)
            json.dumps(found.content)
            found.table()
        return READ

    return _refusing(case)


def _refusing(case: Case) -> Case:
    def asked(source: random.Random, place: Path) -> str:
        try:
            return case(source, place)
        except InputError as error:
            if not error.problems or not str(error).strip():
                raise AssertionError("an InputError without a message") from error
            return REFUSED

    return asked


def target(name: str, folder: Path) -> Case:
    """The target of a name."""
    if name == "measurement.yaml":
        return declaration_target(folder)
    if name in RIGS:
        return rig_target(name)
    return command_target(folder) if name == "command" else file_target(name, folder)


RIGS = ("identify", "explain")  # seconds a case, not thousandths
TARGETS = (*seeds.FILES, "measurement.yaml", "command", *RIGS)
