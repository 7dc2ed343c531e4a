"""The index of all runs: found below outputs/, written beside them at the end of each run and by task=collect."""

import logging
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gear_damping.config.folders import read_record
from gear_damping.errors import written_whole
from gear_damping.reporting.headline import headline
from gear_damping.reporting.run_report import REPORT
from gear_damping.tasks.run_folder import CUT_OFF, FAILED, FINISHED, RUNNING, status_of
from gear_damping.tasks.sweep.folder import NOTE, read_sweep

if TYPE_CHECKING:
    from gear_damping.reporting.run_index import IndexRow

OUTPUTS = Path("outputs")  # where runs go unless the command says otherwise, as in conf/config.yaml
INDEX = "index.html"
RUN = "run.json"
NOT_SHOWN = ("collect",)  # tasks that only look at other runs
MAIN = (  # figures of all tasks, those first that are shown first
    "sweep.png", "evaluation.png", "predicted_against_true.png", "identification.png", "damping.png",
    "explanation.png", "plan_map.png", "simulation.png", "inspection.png", "figure_07.png",
)  # fmt: skip
TRIES = 3  # of writing an index, while other runs end in between
log = logging.getLogger("gear_damping")


def refresh_index(folders: list[Path], root: Path = OUTPUTS) -> None:
    """Bring the index up to date where any of the folders lies below its root. A run never fails for it."""
    root = root.absolute()
    if not any(root in folder.absolute().parents for folder in folders):
        return
    try:
        write_index(root)
    except Exception as error:  # whatever lies in the folders of other runs
        log.warning("%s could not be brought up to date: %s: %s", root / INDEX, type(error).__name__, error)


def write_index(root: Path) -> int:
    """Write the index of all runs below a folder, whole or not at all; returns how many rows it has.

    Where another run ends meanwhile, both write, and the last one to do so has seen what both left: who finds that
    something changed while it wrote does it again.

    Raises:
        OSError: it cannot be written.
    """
    from gear_damping.reporting.run_index import index_page  # here, since every command imports this file

    rows: list[IndexRow] = []
    for _ in range(TRIES):
        before = _state(root)
        rows = [row for folder in before if (row := _row(root, folder)) is not None]
        with written_whole(root / INDEX, by_several=True) as path:
            path.write_text(index_page(rows), encoding="utf-8")
        if _state(root) == before:
            break
    return len(rows)


def _state(root: Path) -> dict[Path, int]:
    """When each run, and each sweep with its jobs, last wrote how it stands."""
    return {folder: max(_written(path) for path in paths) for folder, paths in _found(root)}


def _found(folder: Path) -> Iterator[tuple[Path, list[Path]]]:
    """Folders of runs and of sweeps, with the files that say how they stand; what lies inside of them is theirs."""
    try:
        entries = {entry.name: entry for entry in os.scandir(folder)}
    except OSError:  # gone meanwhile, or not ours to read
        return
    if NOTE in entries:
        yield folder, [folder / NOTE, *folder.glob(f"*/{RUN}")]
    elif RUN in entries:
        yield folder, [folder / RUN]
    else:
        for entry in entries.values():
            if entry.is_dir(follow_symlinks=False):
                yield from _found(Path(entry.path))


def _written(path: Path) -> int:
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0


def _row(root: Path, folder: Path) -> "IndexRow | None":
    if (folder / NOTE).exists():
        return _sweep_row(root, folder)
    record = read_record(folder)
    if record is None or not isinstance(record.get("metrics"), Mapping):
        return _made(root, folder, {"status": "unreadable", "result": f"{RUN} cannot be read"})
    if record.get("task") in NOT_SHOWN:
        return None
    status = status_of(folder, record)
    result = headline(record["metrics"]) if status == FINISHED else _reason(record)
    seconds = record.get("wall_time_s") if status not in (RUNNING, CUT_OFF) else None
    return _made(root, folder, _common(record) | {"status": status, "result": result, "seconds": seconds})


def _sweep_row(root: Path, folder: Path) -> "IndexRow":
    """A sweep, by what its jobs say of themselves."""
    sweep = read_sweep(folder)
    there = [(path.parent, read_record(path.parent)) for path in folder.glob(f"*/{RUN}")]
    jobs = [record for _, record in there if record is not None]
    if sweep is None:
        return _made(root, folder, {"status": "unreadable", "result": f"{NOTE} cannot be read"})
    states = [status_of(place, record) for place, record in there if record is not None]
    finished = states.count(FINISHED)
    total = max(sweep.jobs or 0, len(jobs))
    status = FINISHED if total and finished == total else f"{finished} of {total} jobs"
    words = [f"{total} jobs"]
    words += [f"{states.count(kind)} {kind}" for kind in (FAILED, CUT_OFF, RUNNING) if kind in states]
    words.append(f"over {', '.join(sweep.keys)}" if sweep.keys else "")
    common = _common(min(jobs, key=lambda job: str(job.get("started")))) if jobs else {}
    task = f"sweep of {common['task']}" if jobs else "sweep"
    seconds = sum(float(job.get("wall_time_s") or 0) for job in jobs)
    return _made(
        root,
        folder,
        common | {"task": task, "status": status, "result": ", ".join(filter(None, words)), "seconds": seconds},
    )


def _common(record: Mapping[str, Any]) -> dict[str, Any]:
    name = (record.get("config") or {}).get("name")
    return {"task": str(record.get("task")), "name": str(name or "–"), "started": str(record.get("started") or "")}


def _reason(record: Mapping[str, Any]) -> str:
    """Why a run failed, in one line."""
    return str(record.get("error") or "").split("\n")[0].removeprefix("- ")


def _made(root: Path, folder: Path, content: Mapping[str, Any]) -> "IndexRow":
    from gear_damping.reporting.run_index import IndexRow

    there = {entry.name for entry in os.scandir(folder)}
    at = folder.relative_to(root).as_posix()
    pictures = [name for name in MAIN if name in there] or sorted(name for name in there if name.endswith(".png"))
    files = {
        "figure": f"{at}/{pictures[0]}" if pictures else None,
        "report": f"{at}/{REPORT}" if REPORT in there else None,
    }
    known = {"started": "", "task": at.partition("/")[0], "name": folder.parent.name} | dict(content)
    return IndexRow(folder=at, **files, **known)
