"""Whether a folder can be made and written to: said before any work."""

import os
from pathlib import Path


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
