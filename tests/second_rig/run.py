"""Answer the cases that have no answer yet, and note each as it comes."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path

from benchmarks.explaining import engine

from ..blind.run import answer_all, named, noted
from .work import Case, answer

NOTES = "cases.jsonl"
Log = Callable[[str], None]


def done_cases(path: Path) -> dict[str, Case]:
    """Cases noted so far by their names, the last note of each; a line that was cut off is left out."""
    return {case["case"]: case for case in noted(path)}


def ask(names: Sequence[str], folder: Path, processes: int, log: Log) -> list[Case]:
    """Answer what this version of the package has not answered yet; returns the cases asked for, old and new."""
    folder.mkdir(parents=True, exist_ok=True)
    version, path = engine(), folder / NOTES
    done = {name for name, case in done_cases(path).items() if case["engine"] == version}
    waiting = [name for name in names if name not in done]
    log(f"{len(names) - len(waiting)} of {len(names)} cases are done already, {len(waiting)} to do")
    with path.open("a", encoding="utf-8") as notes:

        def note(case: Case, *_: float) -> None:
            notes.write(json.dumps(case | {"engine": version}) + "\n")
            notes.flush()
            log(_line(case))

        answer_all(waiting, processes, note, log, None, answer)
    found = done_cases(path)
    return [found[name] for name in names if name in found]


def _line(case: Case) -> str:
    said = case["answer"]
    return (f"{case['case']} (hidden: {case['truth']['hidden'] or 'nothing'}): {said['verdict']}, {named(said)}: "
            f"{'right' if case['right'] else 'WRONG'} ({case['seconds']:.0f} s)")  # fmt: skip
