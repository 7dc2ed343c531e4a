"""Where measured files lie."""

import os
from pathlib import Path

from gear_damping.errors import InputError, Problem

DATA_VARIABLE = "GEAR_DAMPING_DATA"


def data_root() -> Path:
    """The folder of measured records: GEAR_DAMPING_DATA, or `shared/data` beside the checkout."""
    chosen = os.environ.get(DATA_VARIABLE)
    if chosen:
        return Path(chosen).expanduser()
    return Path(__file__).resolve().parents[2].parent / "shared" / "data"


def resolve_file(text: str, folder: Path, key: str, source: str) -> Path:
    """The file that `text` names: `${GEAR_DAMPING_DATA}` filled in, relative to `folder`.

    Raises:
        InputError: another variable is used, or no file lies there.
    """
    filled = text.replace("${" + DATA_VARIABLE + "}", str(data_root()))
    if "${" in filled:
        rule = f"only ${{{DATA_VARIABLE}}} is filled in"
        raise InputError(Problem(key, rule, text, "write the path itself", source))
    path = folder / Path(filled).expanduser()
    try:
        if path.is_file():
            return path
        what = "is a folder, not a file" if path.is_dir() else "no such file"
    except OSError as error:  # a name that no file can bear
        what = error.strerror
    remedy = f"'file' is relative to {folder}"
    if filled != text:
        remedy = f"set the environment variable {DATA_VARIABLE} to the folder that holds the records"
    raise InputError(Problem(key, f"{what}: {path}", text, remedy, source))
