"""What the files of a trained network are called. Nothing is imported here that takes long."""

from pathlib import Path

STEM = "model"  # of the files that are shared
WEIGHTS, DESCRIPTION, CHECKPOINT = ".safetensors", ".json", "best.ckpt"


def holds_network(folder: Path) -> bool:
    """Whether a folder is that of a network."""
    return any((folder / name).is_file() for name in (STEM + DESCRIPTION, CHECKPOINT))
