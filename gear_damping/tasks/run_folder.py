"""What every run leaves in its folder: run.json, kept true from the first second to the last."""

import hashlib
import json
import logging
import math
import subprocess
import sys
import time
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from gear_damping.config.measured import INSPECT, YAML_SUFFIXES
from gear_damping.config.shown import shown
from gear_damping.config.source import Origin
from gear_damping.errors import Problem, reading, with_article, writing, written_whole
from gear_damping.tasks.lease import is_held

log = logging.getLogger("gear_damping")
RUNNING, FINISHED, FAILED, INTERRUPTED = "running", "finished", "failed", "interrupted"
CUT_OFF = "cut off"  # what a run is that says `running` while nobody works on it: run.json itself never says it
EDITED = {"explain": "extended_simulator.yaml", "inspect": "measurement.yaml"}  # what people edit, by task
PACKAGES = ("gear-damping", "torch", "lightning", "hydra-core", "torchdiffeq", "numpy", "scipy")


class RunFolder:
    """The folder of one run, with its run.json."""

    def __init__(self, path: Path, config: Mapping[str, Any], origin: Origin) -> None:
        """Open the folder and say that the run is running.

        Args:
            path: The folder; made where it is missing.
            config: The resolved configuration.
            origin: Where its values come from: what was typed, of a sweep for this job, and the choice of each group.
        """
        self.path = path
        with writing(path):
            path.mkdir(parents=True, exist_ok=True)
        self._begin = time.monotonic()
        self.record: dict[str, Any] = {
            "status": RUNNING,
            "task": config.get("task"),
            "command": shown(word.lstrip("+") for word in origin.overrides),
            "config": dict(config),
            "choices": dict(origin.choices),
            "seed": config.get("seed"),
            "git": git_state(),
            "versions": versions(),
            "inputs": {},
            "started": datetime.now(UTC).isoformat(timespec="seconds"),
            "wall_time_s": 0.0,
            "metrics": {},
        }
        self._write()

    def add_inputs(self, paths: Iterable[Path], key: str = "file") -> None:
        """Note the digests of files that the run reads.

        Args:
            paths: The files.
            key: The key that names them.

        Raises:
            InputError: one of them cannot be read.
        """
        for path in paths:
            with reading(path, key):
                self.record["inputs"][str(path)] = hashlib.sha256(path.read_bytes()).hexdigest()
        self._write()

    def close(self, status: str, metrics: Mapping[str, Any] | None = None, error: str | None = None) -> None:
        """Say how the run ended."""
        self.record |= {"status": status, "wall_time_s": round(time.monotonic() - self._begin, 3)}
        self.record["metrics"] = dict(metrics or {})
        if error:
            self.record["error"] = error
        self._write()

    def write_json(self, name: str, content: Any) -> Path:
        """Write a JSON file into the folder, whole or not at all."""
        return write_json(self.path / name, content)

    def write_text(self, name: str, text: str) -> None:
        """Write a text into the folder, whole or not at all."""
        with written_whole(self.path / name) as path:
            path.write_text(text)

    def _write(self) -> None:
        self.write_json("run.json", self.record)


def problem_with_used(folder: Path, config: Mapping[str, Any]) -> Problem | None:
    """The problem with a folder that holds already what the task leaves for people to edit, if it does.

    Nothing is written there then, run.json neither.
    """
    name = EDITED.get(config.get("task") or "")
    measured = (config.get("measurement") or {}).get("path") or ""
    is_declared = config.get("task") == INSPECT and Path(measured).suffix.lower() in YAML_SUFFIXES  # leaves no YAML
    if name is None or is_declared or not (folder / name).exists():
        return None
    remedy = "give another folder, or move the file away"
    return Problem("hydra.run.dir", f"holds {with_article(name)} already", str(folder), remedy)


def status_of(folder: Path, record: Mapping[str, Any]) -> str:
    """How a run stands: as run.json says, unless its process ended without a word, killed or on a full disk.

    Args:
        folder: Of the run.
        record: What its run.json says.
    """
    is_dead = record["status"] == RUNNING and not is_held(folder)
    return CUT_OFF if is_dead else str(record["status"])


def write_json(path: Path, content: Any) -> Path:
    """Write JSON that any reader understands: numbers that are not finite become null."""
    with written_whole(path) as unfinished:
        unfinished.write_text(json.dumps(_plain(content), indent=2, allow_nan=False) + "\n")
    return path


def _plain(content: Any) -> Any:
    if isinstance(content, Mapping):
        return {str(key): _plain(value) for key, value in content.items()}
    if isinstance(content, (list, tuple)):
        return [_plain(value) for value in content]
    if isinstance(content, float):
        return content if math.isfinite(content) else None
    return str(content) if isinstance(content, Path) else content


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that decide a result."""
    found = {"python": sys.version.split()[0]}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found


def git_state() -> dict[str, Any]:
    """Revision of the checkout that the package runs from, and whether it was changed; None outside of one."""
    folder = Path(__file__).resolve().parents[2]
    if not (folder / ".git").exists():
        return {"revision": None, "dirty": None}
    try:
        revision, changes = (
            subprocess.run(["git", "-C", str(folder), *command], capture_output=True, text=True, check=True).stdout
            for command in (["rev-parse", "HEAD"], ["status", "--porcelain"])
        )
    except OSError as error:
        return _without_git(f"git cannot be run: {error.strerror}")
    except subprocess.CalledProcessError as error:
        return _without_git(f"git fails: {error.stderr.strip().splitlines()[0] if error.stderr.strip() else error}")
    return {"revision": revision.strip(), "dirty": bool(changes.strip())}


@cache
def _without_git(why: str) -> dict[str, Any]:
    """Nothing is known of the checkout; said once."""
    log.warning("%s; run.json states no revision, and a sweep does not notice that the code was changed", why)
    return {"revision": None, "dirty": None}
