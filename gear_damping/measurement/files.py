"""The files of a measurement: its YAML, in which 1e-6 is a number and a key may appear once, and where data lie."""

import hashlib
import os
import re
from collections.abc import Iterator, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import ClassVar

import yaml

from gear_damping.at_home import at_home
from gear_damping.errors import InputError, Problem, reading
from gear_damping.measurement.formats.registry import Reader, read_table
from gear_damping.measurement.formats.table import Table
from gear_damping.measurement.quantities import EACH_ITS_OWN

_NUMBERS = ("tag:yaml.org,2002:float", "tag:yaml.org,2002:int")
_FLOAT = re.compile(
    r"""^(?:[-+]?(?:[0-9][0-9_]*)\.[0-9_]*(?:[eE][-+]?[0-9]+)?
        |[-+]?(?:[0-9][0-9_]*)(?:[eE][-+]?[0-9]+)
        |[-+]?\.[0-9][0-9_]*(?:[eE][-+]?[0-9]+)?
        |[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))$""",
    re.VERBOSE,
)
# What cures a YAML that cannot be read, by a word of the parser's reason; else the two usual mistakes.
_CURES = {"appears twice": "keep the one that is right", "'\\t'": "indent with spaces, not with tabs"}
_ALIKE = 0.8  # share of the letters that two names of files must have in common to be taken for one
_CURE = "mind indentation, and quote texts that hold any of : # [ ] { } ,"
DATA_VARIABLE = "GEAR_DAMPING_DATA"
YAML = (".yaml", ".yml")  # ends of declarations; what ends otherwise is a file of data
UNKNOWN = "???"  # in a measurement.yaml that task=inspect began: what nobody can guess


def as_a_file(value: object) -> str:
    """The remedy where values in memory, a table of pandas or arrays, were given for a measurement; "" of others."""
    if hasattr(value, "to_csv"):
        written, name = "to_csv('run.csv')", "run.csv"
    elif hasattr(value, "__array__") or (isinstance(value, dict | list | tuple) and value):
        written, name = "np.savez('run.npz', t=t, x=x)", "run.npz"
    else:
        return ""
    return f"write values in memory to a file, {written}, of which task=inspect measurement.path={name} writes a YAML"


class _Loader(yaml.SafeLoader):
    """YAML 1.1 wants 1.0e-6 and takes 1e-6 for text, 010 for 8 and 1:30 for 90; people write the first, and mean 10."""

    yaml_implicit_resolvers: ClassVar[dict] = {
        letter: [(tag, pattern) for tag, pattern in kinds if tag not in _NUMBERS]
        for letter, kinds in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }

    def construct_decimal(self, node: yaml.ScalarNode) -> int:
        """A whole number, with or without zeros before it."""
        return int(node.value.replace("_", ""))

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict:
        """Refuse a key that appears twice, where YAML would silently keep the last."""
        seen = set()
        for key_node, _ in node.value:
            where = key_node.start_mark
            if not isinstance(key_node, yaml.ScalarNode):
                raise yaml.constructor.ConstructorError(None, None, "a key is a name, not a list or a mapping", where)
            if key_node.value in seen:
                raise yaml.constructor.ConstructorError(None, None, f"the key '{key_node.value}' appears twice", where)
            seen.add(key_node.value)
        return super().construct_mapping(node, deep)


_Loader.add_implicit_resolver(_NUMBERS[0], _FLOAT, list("-+0123456789."))
_Loader.add_implicit_resolver(_NUMBERS[1], re.compile(r"^[-+]?[0-9][0-9_]*$"), list("-+0123456789"))
_Loader.add_constructor(_NUMBERS[1], _Loader.construct_decimal)


def read_yaml(path: Path) -> object:
    """The content of a YAML file.

    Raises:
        InputError: no such file, one that cannot be read, not text, not YAML, no keys, or a key appears twice.
    """
    data = f"of a file of data, task=inspect measurement.path={path} writes one to start from"
    is_yaml = path.suffix.lower() in YAML
    if not path.is_file():
        rule = "is a folder, no file" if path.is_dir() else "no such file"
        held = sorted(one.name for one in path.glob("*.y*ml"))[:1] if path.is_dir() else []
        remedy = f"give the path of a measurement.yaml{''.join(f', as {path / one}' for one in held)}"
        raise InputError(Problem("measurement.path", rule, str(path), remedy))
    try:
        with reading(path, "measurement.path"):
            content = yaml.load(path.read_text(encoding="utf-8-sig"), Loader=_Loader)
    except UnicodeDecodeError as error:
        utf8 = f"save it as UTF-8 ({error.reason})"
        remedy = f"{utf8}; {data}" if is_yaml else f"{data}; a measurement.yaml: {utf8}"
        raise InputError(Problem("measurement.path", "not UTF-8 text", str(path), remedy)) from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f" at line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        reason = getattr(error, "problem", None) or str(error)
        remedy = next((cure for word, cure in _CURES.items() if word in reason), _CURE)
        remedy = remedy if is_yaml else f"{data}; a measurement.yaml: {remedy}"
        raise InputError(Problem(str(path), f"not valid YAML{where}: {reason}", remedy=remedy)) from None
    if isinstance(content, str):
        rule, remedy = "holds text without keys, which is no measurement.yaml", f"write `key: value` lines; {data}"
        raise InputError(Problem("measurement.path", rule, str(path), remedy))
    return content


def unfilled(content: object, key: str = "", above: tuple[int, ...] = ()) -> Iterator[str]:
    """Keys that still hold what a started measurement.yaml has where nobody can guess.

    Args:
        content: Of the file, or of a key.
        key: The key.
        above: What holds it: a YAML may hold itself.
    """
    if id(content) in above:
        return
    if isinstance(content, str) and content == UNKNOWN:
        yield key
    inside = content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    for name, value in inside:
        part = f"[{name}]" if isinstance(content, list) else f".{name}" if key else str(name)
        yield from unfilled(value, key + part, (*above, id(content)))


def data_root() -> Path:
    """The folder of measured records: GEAR_DAMPING_DATA, or `shared/data` beside the checkout."""
    chosen = os.environ.get(DATA_VARIABLE)
    if chosen:
        return at_home(chosen)
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
    path = folder / at_home(filled)
    try:
        if path.is_file():
            return path
        what = "is a folder, not a file" if path.is_dir() else "no such file"
    except OSError as error:  # a name that no file can bear
        what = error.strerror
    if held := _matching(path):
        remedy = f"{EACH_ITS_OWN}: {', '.join(held)}"
        raise InputError(Problem(key, f"a record has one file, and this is a pattern: {path}", text, remedy, source))
    remedy = f"{_neighbour(path)}'file' is relative to {folder.resolve()}"
    if filled != text:
        remedy = f"set the environment variable {DATA_VARIABLE} to the folder that holds the records"
    raise InputError(Problem(key, f"{what}: {path}", text, remedy, source))


def _matching(path: Path) -> list[str]:
    """The files beside it that a pattern means; none where it is no pattern."""
    if not any(sign in path.name for sign in "*?"):
        return []
    return sorted(one.name for one in path.parent.glob(path.name))


def _neighbour(path: Path) -> str:
    """The file beside it that has nearly the name of a missing one, as the start of a remedy."""
    names = sorted(one.name for one in path.parent.iterdir() if one.is_file()) if path.parent.is_dir() else []
    beside = {name.lower(): name for name in names}
    found = get_close_matches(path.name.lower(), beside, n=1, cutoff=_ALIKE)
    return f"did you mean '{beside[found[0]]}'? " if found else ""


class Files:
    """Files that are read and digested once, however many records lie in them."""

    def __init__(self, folder: Path, max_bytes: int, known: Mapping[str, Reader] | None = None) -> None:
        self._folder, self._max_bytes, self._known = folder, max_bytes, known
        self._tables: dict[Path, Table] = {}
        self._digests: dict[Path, str] = {}

    def table(self, file: str, key: str, source: str) -> Table:
        """The table of a file named in the YAML; raises InputError where it cannot be read."""
        path = resolve_file(file, self._folder, key, source)
        if path not in self._tables:
            self._tables[path] = read_table(path, self._max_bytes, self._known)
        return self._tables[path]

    def sha256(self, path: Path) -> str:
        """The digest of a file in hexadecimal."""
        if path not in self._digests:
            with reading(path), path.open("rb") as file:
                self._digests[path] = hashlib.file_digest(file, "sha256").hexdigest()
        return self._digests[path]
