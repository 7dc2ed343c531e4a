"""One way to say that an input is wrong: every problem at once, each with key, rule and remedy."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from errno import EDQUOT, EFBIG, ENOSPC, EROFS
from pathlib import Path
from uuid import uuid4

_VOWELS = "aeiouAEIOU"
_LONGEST = 300  # characters of a value in a message, some lines; a whole file may stand where a mapping should


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with what the user gave.

    Args:
        key: What is wrong: a configuration key, or a file with its channel.
        value: The value found there, or None where there is none to show.
        rule: What holds for the key.
        remedy: What the user can do about it.
        source: The file or command line that the value came from.
    """

    key: str
    rule: str
    value: object = None
    remedy: str = ""
    source: str = ""

    def __str__(self) -> str:
        shown = "" if self.value is None else f" = {_shortened(repr(self.value))}"
        remedy = f"; remedy: {self.remedy}" if self.remedy else ""
        source = f" (from {self.source})" if self.source else ""
        return f"{self.key}{shown}: {self.rule}{remedy}{source}"


class InputError(ValueError):
    """Raised when the user's input cannot be used; holds every problem that was found."""

    def __init__(self, problems: Problem | Sequence[Problem]) -> None:
        self.problems = [problems] if isinstance(problems, Problem) else list(problems)
        super().__init__("\n".join(dict.fromkeys(f"- {problem}" for problem in self.problems)))


def _shortened(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"


def nearest(word: str, choices: Sequence[str]) -> str:
    """The remedy sentence for a name that is not among `choices`: the nearest one, or the list.

    The same words in another order are nearest: of `pinion_inertia` that is `inertia_pinion`, not `inertia_gear`. Then
    comes the only one that has all the words: of `pinion_teeth` that is `n_teeth_pinion`.
    """
    found = [choice for choice in choices if _words(choice) == _words(word)]
    having = [choice for choice in choices if set(_words(word)) <= set(_words(choice))]
    found = found or (having if len(having) == 1 else [])
    found = found or get_close_matches(str(word), list(choices), n=1, cutoff=0.5)
    if found:
        return f"did you mean '{found[0]}'?"
    return "choose one of " + ", ".join(sorted(choices))


def _words(name: object) -> list[str]:
    return sorted(str(name).split("_"))


@contextmanager
def reading(path: Path | str, key: str = "file") -> Iterator[Path]:
    """The path; an OSError in the block is an InputError: this file cannot be read.

    Args:
        path: What the user named.
        key: The key that names it.

    Raises:
        InputError: the file is missing, or the machine does not give it.
    """
    try:
        yield Path(path)
    except OSError as error:
        raise InputError(unread(error, path, key)) from error


def unread(error: OSError, path: Path | str, key: str, source: str = "") -> Problem:
    """The problem with a file that the machine does not give."""
    reason = error.strerror or " ".join(str(error).split())
    remedy = "see that it is there, is a file, and that you have the right to read it"
    return Problem(key, f"cannot be read: {reason}", str(path), remedy, source)


@contextmanager
def writing(path: Path) -> Iterator[Path]:
    """The path; an OSError names it, as that of a full disk does not, and says that it was met in writing."""
    try:
        yield path
    except OSError as error:
        error.filename = error.filename or str(path)
        error.written = True
        raise


def met_in_writing(error: OSError) -> bool:
    """Whether it is an unwritable output that an error of the machine tells of."""
    return getattr(error, "written", False) or error.errno in (ENOSPC, EDQUOT, EROFS, EFBIG)


@contextmanager
def written_whole(path: Path, by_several: bool = False) -> Iterator[Path]:
    """A path to write to, which takes the place of `path` in the end; after an error nothing of it is left.

    Args:
        path: The file.
        by_several: Whether other processes may write it at the same time, so that each needs a path of its own.

    Raises:
        OSError: as what writes raises it, with the name of a file.
    """
    own = f".{uuid4().hex}" if by_several else ""
    unfinished = path.with_name(f"{path.name}{own}.part")
    with writing(path):
        try:
            yield unfinished
            os.replace(unfinished, path)
        except BaseException:
            unfinished.unlink(missing_ok=True)
            raise


def with_article(name: str) -> str:
    """A name in a sentence behind its indefinite article: `an oscillator`, `a gear_pair`."""
    return f"{'an' if name[:1] in _VOWELS else 'a'} {name}"
