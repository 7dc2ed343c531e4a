"""Errors inside the user's own effect files, said as what they are."""

import traceback
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gear_damping.errors import InputError, Problem


def plugins_of(config: Mapping[str, Any]) -> list[str]:
    """The effect files that a configuration names, which may be wrong in any way."""
    simulator = config.get("simulator")
    named = simulator.get("plugins") if isinstance(simulator, Mapping) else None
    return [path for path in named if isinstance(path, str)] if isinstance(named, list) else []


@contextmanager
def errors_in(plugins: Sequence[str], source: str = "") -> Iterator[None]:
    """Turn what the code of `plugins` raises into an InputError that names file, line and error.

    Args:
        plugins: The files.
        source: Where the configuration names them.

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
        rule = f"line {frame.lineno}, in {frame.name}, fails with {said}"
        raise InputError(Problem("simulator.plugins", rule, files[place], "correct the file", source)) from error
