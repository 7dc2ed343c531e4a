"""Which code explains: answers of two versions of it are no one count."""

import ast
import hashlib
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1] / "gear_damping"
DOORS = ("gear_damping.explanation.explain", "gear_damping.measurement.load")  # what a case is explained through
FOUND_BY_NAME = ("physics/effects", "physics/systems", "measurement/formats")  # folders whose files no import names
NATIVE = ("*.cpp", "*.h")


def engine() -> str:
    """A fingerprint of the code that explains, and of no other."""
    digest = hashlib.sha256()
    for path in explaining():
        digest.update(path.read_bytes())
    return digest.hexdigest()[:8]


def explaining() -> list[Path]:
    """The files that an explanation runs through: what its doors import, and what is found by its name."""
    waiting = [_file_of(door) for door in DOORS]
    waiting += [path for folder in FOUND_BY_NAME for path in (PACKAGE / folder).glob("*.py")]
    found: set[Path] = set()
    while waiting:
        path = waiting.pop()
        if path is not None and path not in found:
            found.add(path)
            waiting += [_file_of(name) for name in _imported(path)]
    return sorted(found | {path for kind in NATIVE for path in PACKAGE.rglob(kind)})


def _imported(path: Path) -> list[str]:
    """Names that a file imports, at its top or in a function; of `from a import b` both a and a.b."""
    names: list[str] = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return names


def _file_of(name: str) -> Path | None:
    """The file of a module of the package; None for anything else."""
    first, *rest = name.split(".")
    if first != PACKAGE.name:
        return None
    place = PACKAGE.joinpath(*rest)
    return next((p for p in (place.with_suffix(".py"), place / "__init__.py") if p.is_file()), None)
