"""Ask the questions, note each answer as it comes, and write what they add up to."""

from __future__ import annotations

import json
import multiprocessing
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from pathlib import Path
from typing import Any

from benchmarks.explaining import engine

from .judge import Case
from .rates import rates
from .strata import Question
from .table import table
from .work import answer, quiet_worker

ANSWER = ("verdict", "misfit", "damping_ratio_percent", "seconds", "converged")  # what is kept of an answer,
CAUSE = ("name", "status", "confusable_with", "parameters", "excess_explained")  # and of a cause
CASES, RATES, TABLE = "cases.jsonl", "rates.json", "table.md"
Log = Callable[[str], None]


def done_cases(path: Path) -> list[Case]:
    """Cases noted so far, the last note of each; a line that was cut off is left out."""
    return list({(case["stratum"], case["seed"]): case for case in noted(path)}.values())


def noted(path: Path) -> Iterator[dict[str, Any]]:
    """The lines of a file of notes, none where there is no file; one that was cut off is left out."""
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        try:
            yield json.loads(line)
        except json.JSONDecodeError:
            continue


def begin_from(kept: Path, path: Path) -> None:
    """On a fresh clone, go on from the cases that are kept with a page."""
    if kept.exists() and not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(kept.read_text(encoding="utf-8"), encoding="utf-8")


def keep(cases: Sequence[Case], path: Path) -> None:
    """Write all that the page follows from, a case a line; of the answers no sentences and no figures of records."""
    lines = []
    for case in sorted(cases, key=lambda case: (case["stratum"], case["seed"])):
        answers = {key: _shortened(case[key]) for key in ("answer", "answer_with_more") if key in case}
        lines.append(json.dumps(case | answers) + "\n")
    path.write_text("".join(lines), encoding="utf-8")


def _shortened(answer: dict[str, Any]) -> dict[str, Any]:
    causes = [{key: cause[key] for key in CAUSE if key in cause} for cause in answer["causes"]]
    unseen = [{"name": entry["name"]} for entry in answer.get("not_observable") or []]
    short = {key: answer[key] for key in ANSWER if key in answer}
    if short.get("misfit"):
        short["misfit"] = {key: short["misfit"][key] for key in ("before", "after")}
    return short | {"causes": causes, "not_observable": unseen}


def ask(
    questions: Sequence[Question],
    folder: Path,
    processes: int,
    log: Log,
    minutes: float | None = None,
    solve: Callable[[Question], dict[str, Any]] = answer,
    redo: bool = False,
) -> list[Case]:
    """Answer the questions that have no answer yet; returns all cases of the folder, old and new.

    minutes: no question begins after so many. redo: ask again what another version of the package answered.
    """  # fmt: skip
    folder.mkdir(parents=True, exist_ok=True)
    version = engine()
    old = done_cases(folder / CASES)
    done = {(c["stratum"], c["seed"]) for c in old if not redo or c["engine"] == version}
    waiting = [question for question in questions if question.key not in done]
    log(f"{len(questions) - len(waiting)} of {len(questions)} cases are done already, {len(waiting)} to do")
    with (folder / CASES).open("a", encoding="utf-8") as notes:

        def note(case: Case, place: int, rate: float) -> None:
            notes.write(json.dumps(case | {"engine": version}) + "\n")
            notes.flush()
            log(_line(case, place, len(waiting), rate))

        answer_all(waiting, processes, note, log, minutes, solve, lambda one: f"{one.stratum} {one.seed}")
    return done_cases(folder / CASES)


def _line(case: Case, place: int, total: int, seconds_each: float) -> str:
    hidden = "+".join(effect["name"] for effect in case["truth"]["effects"]) or case["truth"]["fault"] or "nothing"
    said = case["answer"]
    left = f"about {(total - place) * seconds_each / 60:.0f} min left"
    return (f"[{place}/{total}] {case['stratum']} {case['seed']} (hidden: {hidden}): {said['verdict']}, {named(said)} "
            f"({case['seconds']:.0f} s; {left})")  # fmt: skip


def named(said: dict[str, Any]) -> str:
    """The causes of an answer; a question mark behind those that are not established."""
    return ", ".join(f"{c['name']}{'' if c['status'] == 'established' else '?'}" for c in said["causes"]) or "no name"


def answer_all(
    waiting: Sequence[Any],
    processes: int,
    note: Callable[[Case, int, float], None],
    log: Log,
    minutes: float | None,
    solve: Callable[[Any], Case],
    name: Callable[[Any], str] = str,
) -> None:
    """Keep the workers busy; on Ctrl-C they are stopped and what is noted stays.

    note: told each answer, how many there are with it, and the seconds that each took on average. minutes: nothing
    begins after so many. name: what is said of one that failed.
    """  # fmt: skip
    begun = time.monotonic()
    queue, place = iter(waiting), 0
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(processes, mp_context=context, initializer=quiet_worker)
    running: dict = {}
    try:
        while True:
            late = minutes is not None and time.monotonic() - begun > 60 * minutes
            while len(running) < processes and not late and (question := next(queue, None)) is not None:
                running[pool.submit(solve, question)] = question
            if not running:
                break
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                place += 1
                question, problem = running.pop(future), future.exception()
                if problem is None:
                    note(future.result(), place, (time.monotonic() - begun) / place)
                else:
                    log(f"{name(question)} is left out: {type(problem).__name__}: {problem}")
    except BaseException:
        for process in list(getattr(pool, "_processes", {}).values()):
            process.terminate()
        raise
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def write(cases: Sequence[Case], folder: Path, page: Path | None, command: str) -> dict[str, Any]:
    """Write rates.json and the table, and the page of the documentation where one is asked for."""
    found = rates(cases)
    (folder / RATES).write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    text = table(found, cases, command)
    for path in filter(None, (folder / TABLE, page)):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return found
