"""Where the configuration lies: beside the package in a checkout, inside it in a wheel."""

from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]


@cache
def conf_folder() -> Path:
    """The folder of the configuration groups."""
    inside, beside = PACKAGE / "conf", PACKAGE.parent / "conf"
    return inside if inside.is_dir() else beside


@cache
def groups() -> dict[str, tuple[str, ...]]:
    """The choices of each group that a user may set, by group."""
    folder = conf_folder()
    found = {}
    for group in sorted(path for path in folder.iterdir() if path.is_dir() and path.name != "hydra"):
        found[group.name] = tuple(sorted(path.stem for path in group.glob("*.yaml")))
    return found
