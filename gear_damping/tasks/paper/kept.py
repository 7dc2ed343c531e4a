"""Finished parts of a study: one JSON file each, kept as long as what decides it stays the same."""

import hashlib
import json
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from gear_damping.tasks.run_folder import write_json

PARTS = "parts"  # folder of the finished ones
FITS = "fits"  # folder of what is being trained
DIGEST = 8  # hexadecimal digits that tell settings apart

Part = dict[str, Any]


class KeptParts:
    """The parts of a run folder.

    Args:
        folder: The run's.
        resume: The folder of an earlier run whose parts are taken over first; None: those of this folder alone.
    """

    def __init__(self, folder: Path, resume: Path | None = None) -> None:
        self.folder = folder
        (folder / PARTS).mkdir(parents=True, exist_ok=True)
        for name in (PARTS, FITS):
            earlier = None if resume is None else resume / name
            if earlier is not None and earlier.is_dir() and earlier.resolve() != (folder / name).resolve():
                shutil.copytree(earlier, folder / name, dirs_exist_ok=True)

    def path(self, name: str) -> Path:
        """Where a part lies."""
        return self.folder / PARTS / f"{name}.json"

    def find(self, name: str, decided_by: Mapping[str, Any]) -> Part | None:
        """The finished part of this name, if the same decided it; what other settings left is none."""
        if not self.path(name).is_file():
            return None
        part = json.loads(self.path(name).read_text())
        return part if part["decided_by"] == json.loads(json.dumps(decided_by)) else None

    def get(self, name: str, decided_by: Mapping[str, Any], make: Callable[[Path], Part]) -> tuple[Part, bool]:
        """The part, and whether it was there already.

        Args:
            name: Of the part.
            decided_by: Everything that decides it, as plain values.
            make: Makes it, in the folder that it is given.
        """
        found = self.find(name, decided_by)
        if found is not None:
            return found, True
        digest = hashlib.sha256(json.dumps(decided_by, sort_keys=True).encode()).hexdigest()
        fit = self.folder / FITS / f"{name}-{digest[:DIGEST]}"  # checkpoints of other settings are not gone on with
        write_json(self.path(name), make(fit))
        return json.loads(self.path(name).read_text()), False
