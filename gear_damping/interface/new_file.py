"""Files that are written for the user, none of which takes the place of another."""

from pathlib import Path

from gear_damping.interface.arguments import file_path


def written_anew(path: Path | str, text: str) -> Path:
    """Write a text into a file that is not there yet; folders on the way are made.

    Raises:
        InputError: it is no path.
        FileExistsError: there is such a file, which stays as it is.
    """
    path = file_path("path", path, "the new file")
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise FileExistsError(f"{path} is there and stays as it is: give another path, or delete it first") from None
    return path
