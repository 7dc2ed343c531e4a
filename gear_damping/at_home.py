"""Paths that begin at home, in whatever way they are given."""

from pathlib import Path


def at_home(text: str | Path) -> Path:
    """The path with `~` filled in where it is a home; a name may begin so, as those of temporary copies do."""
    try:
        return Path(text).expanduser()
    except RuntimeError:  # of nobody who is known here
        return Path(text)
