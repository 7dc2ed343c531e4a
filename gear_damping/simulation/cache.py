"""Data sets of runs on disk: an NPZ file and its manifest, found again by the hash of their plan."""

import json
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from gear_damping.errors import written_whole
from gear_damping.physics.model import Model
from gear_damping.simulation.runs import Runs

GROUPS = ("values", "derived", "states", "inputs")


def save_runs(folder: Path, key: str, manifest: dict, runs: Runs) -> Path:
    """Write `<key>.npz` and `<key>.json`; the manifest comes last, so that a set without one is unfinished."""
    folder.mkdir(parents=True, exist_ok=True)
    arrays = {f"{g}/{k}": v.numpy() for g in GROUPS for k, v in getattr(runs, g).items()}
    arrays |= {"status": runs.status.numpy(), "reference_velocity": runs.reference_velocity.numpy()}
    target = folder / f"{key}.npz"
    with written_whole(target) as unfinished, unfinished.open("wb") as file:
        np.savez(file, sampling_rate=runs.sampling_rate, **arrays)
    note = {"hash": key, "n_diverged": runs.n_diverged, "plan": manifest}
    with written_whole(target.with_suffix(".json")) as path:
        path.write_text(json.dumps(note, indent=1, sort_keys=True))
    return target


def load_runs(folder: Path, key: str, model: Model, values: dict[str, Tensor]) -> Runs | None:
    """The runs saved under `key`, or None; a set whose drawn values differ is not the same set."""
    target = folder / f"{key}.npz"
    if not (target.is_file() and target.with_suffix(".json").is_file()):
        return None
    groups: dict[str, dict[str, Tensor]] = {name: {} for name in GROUPS}
    with np.load(target) as file:
        for name in file.files:
            group, _, key_in_group = name.partition("/")
            if group in groups:
                groups[group][key_in_group] = torch.from_numpy(file[name])
        status, velocity = (torch.from_numpy(file[name]) for name in ("status", "reference_velocity"))
        rate = float(file["sampling_rate"])
    if any(not torch.equal(groups["values"].get(k, v[:0]), v) for k, v in values.items()):
        return None
    return Runs(
        model=model,
        sampling_rate=rate,
        status=status,
        reference_velocity=velocity,
        n_diverged=int((status != 0).sum()),
        **groups,
    )
