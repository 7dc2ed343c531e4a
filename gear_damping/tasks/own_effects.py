"""Errors inside the user's own effect files, said as what they are."""

import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from gear_damping.errors import InputError, Problem


@contextmanager
def errors_in(plugins: Sequence[str]) -> Iterator[None]:
    """Turn what the code of `plugins` raises into an InputError that names file, line and error.

    Raises:
        InputError: something inside was raised by a line of one of the files.
    """
    try:
        yield
    except InputError:
        raise
    except Exception as error:  # the user's own code can fail in any way
        files = {Path(path).resolve(): path for path in plugins}
        frames = [frame for frame in traceback.extract_tb(error.__traceback__) if Path(frame.filename) in files]
        if not frames:
            raise
        said = " ".join(f"{type(error).__name__}: {error}".split())
        rule = f"line {frames[-1].lineno}, in {frames[-1].name}, fails with {said}"
        path = files[Path(frames[-1].filename)]
        raise InputError(Problem("simulator.plugins", rule, path, "correct the file")) from error
