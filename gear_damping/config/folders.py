"""Folders of runs: whether one can be made and written to, and whether an interrupted task can go on from it."""

import os
from pathlib import Path

RESUMABLE = {"paper": "parts/*.json", "train": "*/seed_*/last.ckpt"}  # what an interrupted task leaves in its folder


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
    if existing.is_dir() and os.access(existing, os.W_OK | os.X_OK):
        return None
    return f"cannot be made: {existing} is not a folder that can be written to"
