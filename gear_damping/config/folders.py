"""Folders of runs: what one says of itself, whether it can be made, and whether a task can go on from it."""

import json
import os
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

RESUMABLE = {"paper": "parts/*.json", "train": "*/seed_*/last.ckpt"}  # what an interrupted task leaves in its folder


def read_record(folder: Path) -> dict[str, Any] | None:
    """What run.json of a folder says; None where there is none that can be read."""
    try:
        found = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) and "status" in found else None


def resumable(task: str, folder: Path) -> bool:
    """Whether a folder holds something that a task can go on from."""
    return task in RESUMABLE and any(folder.glob(RESUMABLE[task]))


def unusable(folder: Path) -> str | None:
    """Why nothing can be written to a folder that is there or is to be made; None where it can."""
    folder = folder.absolute()
    try:
        existing = next(path for path in (folder, *folder.parents) if path.exists())
    except OSError as error:  # a name that no folder can bear
        return f"cannot be made: {error.strerror}"
    if not (existing.is_dir() and os.access(existing, os.W_OK | os.X_OK)):
        return f"cannot be made: {existing} is not a folder that can be written to"
    try:
        os.rmdir(mkdtemp(prefix=".", dir=existing))
    except OSError as error:  # a file system that is none, such as /proc, allows everything and does nothing
        return f"cannot be made: {existing} takes no folder ({error.strerror})"
    return None
