"""Python files that each declare a part: those of a room of the package, and a user's own."""

import importlib.util
import inspect
import pkgutil
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

from gear_damping.errors import InputError, Problem

REMEDY = "correct the file"
_run: dict[Path, tuple[bytes, ModuleType]] = {}  # what each of the user's files held when it was run, and its module


def modules_of(room: ModuleType) -> list[ModuleType]:
    """The modules of a package that each declare parts, in the order of their names."""
    return [importlib.import_module(f"{room.__name__}.{one.name}") for one in pkgutil.iter_modules(room.__path__)]


def plugin_paths(given: str | Path | Iterable[str | Path]) -> tuple[str | Path, ...]:
    """The files of one's own that were handed over in Python; one path that stands alone is one, not its letters.

    Raises:
        InputError: they are no paths.
    """
    found = (given,) if isinstance(given, str | Path) or not isinstance(given, Iterable) else tuple(given)
    if wrong := [one for one in found if not isinstance(one, str | Path)]:
        raise InputError(Problem("plugins", "must be paths of Python files", wrong[0], "write plugins=['mine.py']"))
    return found


def load_module(path: Path, key: str) -> ModuleType:
    """The module of a file that the user named under `key`.

    A file is run once in a process, whoever asks for it, and once more where it has changed since.

    Raises:
        InputError: it is missing, is no Python file, or cannot be run.
    """
    if path.suffix != ".py":
        raise InputError(Problem(key, "is no Python file", str(path), "give the path of a .py file"))
    if not path.is_file():
        raise InputError(Problem(key, "no such file", str(path), "give the path of a .py file"))
    place = path.resolve()
    spec = importlib.util.spec_from_file_location(f"gear_damping_plugin_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    try:
        content = path.read_bytes()
        if place in _run and _run[place][0] == content:
            return _run[place][1]
        exec(compile(content, str(path), "exec"), vars(module))  # by way of no stale bytecode
    except (Exception, SystemExit) as error:  # the user's own code can fail in any way
        rule = f"cannot be loaded: {_place(error, path)}{type(error).__name__}: {' '.join(str(error).split())}"
        raise InputError(Problem(key, rule, str(path), REMEDY)) from error
    _run[place] = content, module
    return module


def classes_of(module: ModuleType, base: type) -> list[type]:
    """The classes of a module that are meant for use; one without a name that others derive from is not."""
    own = [c for c in vars(module).values() if inspect.isclass(c) and issubclass(c, base)]
    own = [c for c in dict.fromkeys(own) if c.__module__ == module.__name__]
    bases = {parent for c in own for parent in c.__mro__[1:]}
    return [c for c in own if c not in bases or ("name" in vars(c) and not inspect.isabstract(c))]


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


def _place(error: BaseException, path: Path) -> str:
    """The line of the file that fails; empty where the error names none or names it itself."""
    if isinstance(error, SyntaxError):
        return ""
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if Path(frame.filename).resolve() == path.resolve()]
    return f"line {lines[-1]}: " if lines else ""
