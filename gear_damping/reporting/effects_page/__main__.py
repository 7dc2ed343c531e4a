"""`python -m gear_damping.reporting.effects_page`: write docs/effects.md and its figures."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from gear_damping.errors import InputError
from gear_damping.physics.catalogue import builtin_effects, catalogue
from gear_damping.reporting.effects_page.page import FIGURES, page
from gear_damping.reporting.effects_page.picture import write_signature
from gear_damping.reporting.effects_page.signatures import signature


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the page of the whole catalogue, or of the effects in the user's own files; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m gear_damping.reporting.effects_page", description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path("docs"), help="where effects.md is written")
    parser.add_argument("--plugins", nargs="*", default=[], help="your own effect files: the page of these alone")
    chosen = parser.parse_args(arguments)
    try:
        write_page(chosen.folder, chosen.plugins)
    except InputError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


def write_page(folder: Path, plugins: Sequence[str | Path] = ()) -> Path:
    """Simulate every effect with and without it, and write the page with its figures.

    Args:
        folder: Gets `effects.md` and `figures/effects/*.png`.
        plugins: Files with effects; where there are any, the page is of their effects alone.

    Raises:
        InputError: a file cannot be used.
    """
    known = catalogue(plugins)
    kinds = {name: kind for name, kind in known.items() if not plugins or name not in builtin_effects()}
    figures = folder / FIGURES
    figures.mkdir(parents=True, exist_ok=True)
    measured = {}
    for name, kind in kinds.items():
        measured[name] = signature(kind, known)
        write_signature(measured[name], figures / f"{name}.png")
    path = folder / "effects.md"
    path.write_text(page(kinds, measured), encoding="utf-8")
    print(f"wrote {path}: {len(kinds)} effects")
    return path


if __name__ == "__main__":
    raise SystemExit(main())
