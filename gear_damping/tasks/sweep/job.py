"""One job of a sweep: what is finished stays untouched, what was cut off goes on, what another does is waited for."""

import logging
import os
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gear_damping.config.folders import read_record, resumable
from gear_damping.config.source import Origin
from gear_damping.tasks.dispatch import OK, run_job
from gear_damping.tasks.lease import leased
from gear_damping.tasks.run_folder import EDITED, FINISHED
from gear_damping.tasks.sweep.folder import NOT_DECIDING, Place
from gear_damping.tasks.sweep.line import line_of

CUT_OFF = ".cut_off"  # what a file of an unfinished job is called from then on
LOG = "log.txt"
log = logging.getLogger("gear_damping")


def run_swept(config: Mapping[str, Any], origin: Origin, place: Place) -> int:
    """Do one job of a sweep, unless it is done; returns its exit code."""
    if _is_finished(place.folder, config):
        log.info("%s", line_of(place, "was finished before"))
        return OK
    with leased(place.folder):
        if _is_finished(place.folder, config):  # by whom we waited for
            log.info("%s", line_of(place, "was finished by another process"))
            return OK
        _set_aside(place.folder, config)
        begun = time.monotonic()
        with _told_in(place.folder / LOG):
            code = run_job(_going_on(config, place.folder), origin, place.folder)
        log.info("%s", line_of(place, f"{time.monotonic() - begun:.0f} s"))
        return code


def limit_cores(launcher: Mapping[str, Any]) -> None:
    """Use this job's share of the cores: those that it was given, or those of the machine among `n_jobs` jobs.

    Args:
        launcher: Its settings; without any share all cores are left to the job.
    """
    given, jobs = launcher.get("cpus_per_task"), launcher.get("n_jobs")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if given is None and jobs is None:
        return
    threads = given if given is not None else max(1, cores // (min(jobs, cores) if jobs > 0 else cores))
    os.environ["OMP_NUM_THREADS"] = str(threads)
    if "torch" in sys.modules:
        sys.modules["torch"].set_num_threads(threads)


def _is_finished(folder: Path, config: Mapping[str, Any]) -> bool:
    """Whether the folder holds the finished job of this configuration."""
    record = read_record(folder)
    return bool(record) and record["status"] == FINISHED and _deciding(record["config"]) == _deciding(config)


def _deciding(config: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in config.items() if key not in NOT_DECIDING}


def _going_on(config: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The configuration, which takes up what the job has left already; without bars, of which there would be many."""
    resume = config.get("resume")
    if resume is None and resumable(config["task"], folder):
        resume = str(folder)
    return dict(config) | {"progress": False, "resume": resume}


def _set_aside(folder: Path, config: Mapping[str, Any]) -> None:
    """What a job that was cut off left for people to edit makes room for that of the finished one, and is kept."""
    left = folder / EDITED.get(config["task"], "")
    if left.is_file() and read_record(folder):
        left.replace(left.with_name(left.name + CUT_OFF))


@contextmanager
def _told_in(path: Path) -> Iterator[None]:
    """What the job says goes into its file, and not between the lines of the others."""
    own, before = logging.FileHandler(path, encoding="utf-8"), list(logging.root.handlers)
    own.setFormatter(logging.Formatter("%(message)s"))
    logging.root.handlers[:] = [own]
    try:
        yield
    finally:
        logging.root.handlers[:] = before
        own.close()
