"""Answer the cases that have no answer yet, and note each as it comes."""

from __future__ import annotations

import json
import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from ..blind.run import engine
from ..blind.work import quiet_worker
from .work import Case, answer

NOTES = "cases.jsonl"
Log = Callable[[str], None]


def done_cases(path: Path) -> dict[str, Case]:
    """Cases noted so far by their names, the last note of each; a line that was cut off is left out."""
    found: dict[str, Case] = {}
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        try:
            case = json.loads(line)
        except json.JSONDecodeError:
            continue
        found[case["case"]] = case
    return found


def ask(names: Sequence[str], folder: Path, processes: int, log: Log) -> list[Case]:
    """Answer what this version of the package has not answered yet; returns the cases asked for, old and new."""
    folder.mkdir(parents=True, exist_ok=True)
    version, path = engine(), folder / NOTES
    done = {name for name, case in done_cases(path).items() if case["engine"] == version}
    waiting = [name for name in names if name not in done]
    log(f"{len(names) - len(waiting)} of {len(names)} cases are done already, {len(waiting)} to do")
    with path.open("a", encoding="utf-8") as notes:

        def note(case: Case) -> None:
            notes.write(json.dumps(case | {"engine": version}) + "\n")
            notes.flush()
            log(_line(case))

        _answer_all(waiting, processes, note, log)
    found = done_cases(path)
    return [found[name] for name in names if name in found]


def _answer_all(names: Sequence[str], processes: int, note: Callable[[Case], None], log: Log) -> None:
    """Keep the workers busy; on Ctrl-C they are stopped and what is noted stays."""
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(processes, mp_context=context, initializer=quiet_worker)
    try:
        running = {pool.submit(answer, name): name for name in names}
        for future in as_completed(running):
            problem = future.exception()
            if problem is None:
                note(future.result())
            else:
                log(f"{running[future]} is left out: {type(problem).__name__}: {problem}")
    except BaseException:
        for process in list(getattr(pool, "_processes", {}).values()):
            process.terminate()
        raise
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _line(case: Case) -> str:
    said = case["answer"]
    named = ", ".join(f"{c['name']}{'' if c['status'] == 'established' else '?'}" for c in said["causes"]) or "no name"
    return (f"{case['case']} (hidden: {case['truth']['hidden'] or 'nothing'}): {said['verdict']}, {named}: "
            f"{'right' if case['right'] else 'WRONG'} ({case['seconds']:.0f} s)")  # fmt: skip
