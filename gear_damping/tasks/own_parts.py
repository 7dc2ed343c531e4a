"""Errors inside the user's own files of effects, estimators, wavelets and formats, said as what they are."""

import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gear_damping.errors import InputError, Problem
from gear_damping.own_files import REMEDY

GROUPS = ("simulator", "model", "measurement")  # that name files of one's own under `plugins`


def plugins_of(config: Mapping[str, Any]) -> dict[str, str]:
    """The files of one's own that a configuration names, which may be wrong in any way, with the key of each."""
    found = {}
    for group in GROUPS:
        node = config.get(group)
        named = node.get("plugins") if isinstance(node, Mapping) else None
        paths = named if isinstance(named, list) else []
        found |= {path: f"{group}.plugins" for path in paths if isinstance(path, str)}
    return found


@contextmanager
def errors_in(plugins: Mapping[str, str], source_of: Callable[[str], str] = lambda key: "") -> Iterator[None]:
    """Turn what the code of `plugins` raises into an InputError that names file, line and error.

    Args:
        plugins: The files, with the key that names each.
        source_of: Where the configuration has a key from.

    Raises:
        InputError: something inside was raised by a line of one of the files.
    """
    try:
        yield
    except InputError:
        raise
    except Exception as error:  # the user's own code can fail in any way
        files = {Path(path).resolve(): path for path in plugins}
        places = [(frame, Path(frame.filename).resolve()) for frame in traceback.extract_tb(error.__traceback__)]
        frames = [(frame, place) for frame, place in places if place in files]
        if not frames:
            raise
        said = " ".join(f"{type(error).__name__}: {error}".split())
        frame, place = frames[-1]
        rule, key = f"line {frame.lineno}, in {frame.name}, fails with {said}", plugins[files[place]]
        raise InputError(Problem(key, rule, files[place], REMEDY, source_of(key))) from error
