"""`measurement.path` of a sweep: a folder or a pattern stands for all of its measurements."""

from glob import glob
from pathlib import Path

from gear_damping.config.measured import YAML_SUFFIXES

PATH, NAME = "measurement.path", "measurement.yaml"
WILD = set("*?[")  # characters of a pattern


def all_named(value: str) -> str:
    """The typed value of a sweep with every file that it stands for, as Hydra takes it; others as they are."""
    path = value.strip().strip("'\"")
    if not path or "," in path:
        return value
    try:
        found = _measurements(Path(path))
    except OSError:  # a name that no file can bear
        return value
    return ",".join(map(_quoted, found)) or value


def _measurements(path: Path) -> list[Path]:
    """Every measurement.yaml below a folder, or else the YAML files in it; of a pattern the files that match."""
    if path.is_dir():
        below = sorted(path.rglob(NAME))
        return below or sorted(one for one in path.iterdir() if one.suffix.lower() in YAML_SUFFIXES)
    if path.exists() or not WILD & set(str(path)):
        return []
    return sorted(one for one in map(Path, glob(str(path), recursive=True)) if one.is_file())


def _quoted(path: Path) -> str:
    """As Hydra takes it whatever it holds."""
    escaped = str(path).replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"
