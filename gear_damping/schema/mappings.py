"""Mappings as pydantic models: every key is declared once, and every problem said at once.

A key has its meaning, what acts on it, and the kind of its value (`values`). A model also says why a key that has a
meaning elsewhere is refused in it. `read_declared` turns pydantic's errors into problems with path, rule and remedy.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from typing import Annotated, Any, ClassVar, get_args

from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler, ValidationError, create_model
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, core_schema

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.schema.values import Given, OneOf, Problems, Value, refuse

Path = tuple[str | int, ...]
_LOST = object()  # stands for an item of a list that was wrong
_DEEPEST = 12  # mappings within mappings that are copied, since a YAML may hold itself
_NUMBERED = re.compile(r"(.*?)_?\d+")  # a name such as `acceleration_2`
_LEFT = "leave the group as it is"


class Declared(BaseModel):
    """A mapping of the YAML.

    `refused` holds key -> (reason, remedy) for keys that have a meaning elsewhere but not here, `meant` name -> remedy
    for what people write instead of a key; `title` says what the mapping describes.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=False, arbitrary_types_allowed=True)
    refused: ClassVar[Mapping[str, tuple[str, str]]] = {}
    meant: ClassVar[Mapping[str, str]] = {}
    title: ClassVar[str] = ""
    unknown: ClassVar[str] = "unknown key"

    def given(self, name: str) -> bool:
        """Whether the key stands in the file."""
        return name in self.model_fields_set

    @classmethod
    def not_a_mapping(cls, place: Path, value: object) -> tuple[str, str]:
        """Rule and remedy where something else, a value, stands at `place`."""
        return f"must be a mapping with keys among {', '.join(names(cls))}", "write `key: value` lines"


class Group(Declared):
    """A group of the configuration, in which every key stands."""

    unknown: ClassVar[str] = "no such key"

    @classmethod
    def not_a_mapping(cls, place: Path, value: object) -> tuple[str, str]:
        """Rule and remedy where something else, a value, stands at `place`."""
        return "is a group of keys", f"give {'.'.join(map(str, place))}.<key>, or choose {place[-1]}=<choice>"


def group(kinds: Mapping[str, Any], others: Iterable[str] = ()) -> type[Group]:
    """The model of a group.

    Args:
        kinds: The kind of value under each key, or a mapping of kinds; what is not `Given` must not be null.
        others: Keys that are checked elsewhere.
    """
    held: dict[str, Any] = dict.fromkeys(others, Any)
    for name, kind in kinds.items():
        is_group = isinstance(kind, Mapping)
        held[name] = group(kind) if is_group else Annotated[Any, kind if isinstance(kind, Given) else Given(kind)]
    # A name of pydantic's own is a key like any other.
    declared = {f"key_{name}": (kind, key("", "", missing=_LEFT, alias=name)) for name, kind in held.items()}
    return create_model("Group", __base__=Group, **declared)


def key(meaning: str, acts: str, default: Any = None, missing: str = "", alias: str | None = None) -> Any:
    """A key of a mapping.

    Args:
        meaning: What the value is.
        acts: What the program does with it.
        default: What holds where the key is absent.
        missing: The remedy where a key that must be there is not; it may be absent where this is empty.
        alias: The key's name where Python could not use it.
    """
    extra = {"acts": acts, "missing": missing}
    value = ... if missing else default
    return Field(value, description=meaning, json_schema_extra=extra, alias=alias)


class Word:
    """Marks a mapping that may be one of a few words instead; they stand in `words`."""

    def __init__(self, *words: str) -> None:
        self.words = OneOf(words)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        def check(value: Any, inner: Any) -> Any:
            return self.words.read(value, "") if isinstance(value, str) else inner(value)

        return core_schema.no_info_wrap_validator_function(check, handler(source))


class Item:
    """Marks a mapping of a list, which is None where it was wrong."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        def check(value: Any, inner: Any) -> Any:
            return None if value is _LOST else inner(value)

        return core_schema.no_info_wrap_validator_function(check, handler(source))


class Listed:
    """Marks a list of at least one mapping; `what` and `example` say of what."""

    def __init__(self, what: str, example: str) -> None:
        self.what, self.example = what, example

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        def check(value: Any) -> Any:
            if not isinstance(value, list) or not value:
                refuse(f"must be a list of at least one {self.what}", value, self.example)
            return value

        return core_schema.no_info_before_validator_function(check, handler(source))


def names(model: type[Declared]) -> dict[str, FieldInfo]:
    """The keys of a mapping as they are written, with their declarations."""
    return {info.alias or name: info for name, info in model.model_fields.items()}


def values_of(model: Declared) -> dict[str, Any]:
    """The values of a mapping by its keys as they are written, groups within it as mappings."""
    found = {name: getattr(model, own) for own, name in _written(model).items()}
    return {name: values_of(value) if isinstance(value, Declared) else value for name, value in found.items()}


def _written(model: Declared) -> dict[str, str]:
    return {own: info.alias or own for own, info in type(model).model_fields.items() if own in model.model_fields_set}


def inner_model(info: FieldInfo) -> type[Declared] | None:
    """The model of a mapping (or of a list of mappings) under a key; None for a plain value."""
    kinds = [info.annotation]
    for kind in kinds:
        if isinstance(kind, type) and issubclass(kind, Declared):
            return kind
        kinds += get_args(kind)
    return None


def kind_of(info: FieldInfo) -> Value | None:
    """The kind of value under a key; None for a mapping."""
    return next((found for found in info.metadata if isinstance(found, Value)), None)


def read_declared(
    model: type[Declared], content: object, problems: Problems, source: str | Callable[[str], str], prefix: str = ""
) -> Declared | None:
    """What the content declares, without the parts that are wrong.

    Wrong parts are noted and taken out, and what is left is read again until it holds. A mapping that lost a key is
    not compared in itself any more: a rule among its keys could blame what is right.

    Args:
        model: The model of the whole file.
        content: What the YAML holds.
        problems: Takes everything that is wrong.
        source: The YAML file, or what says for each key where its value came from.
        prefix: Stands before each key, `model.` for example.

    Returns:
        The model, or None where nothing of the content can be used.
    """
    content, lost = _own_copy(content), set()
    while True:
        try:
            return model.model_validate(content)
        except ValidationError as error:
            found = [pair for one in error.errors() for pair in _problems(model, one)]
        cuts = {place for place, _, _ in found}
        for place, problem, among in found:
            if place not in lost and not (among is not None and _touched(among, lost)):
                problems.append(_placed(problem, place, source, prefix))
        left = [_cut(content, place, lost) for place in sorted(cuts, key=len, reverse=True)]
        if not all(left):
            return None


def _own_copy(content: object, depth: int = 0) -> object:
    """A copy in which no part is shared, as anchors of YAML do, and every key is a text."""
    if depth < _DEEPEST and isinstance(content, dict):
        return {str(name): _own_copy(value, depth + 1) for name, value in content.items()}
    if depth < _DEEPEST and isinstance(content, list):
        return [_own_copy(value, depth + 1) for value in content]
    return content


def _touched(place: Path, lost: set[Path]) -> bool:
    """Whether a key of the mapping at `place`, or a part of its value, was taken out."""
    return any(cut[: len(place)] == place and 0 < len(cut) - len(place) <= 2 for cut in lost)


def _placed(problem: Problem, place: Path, source: str | Callable[[str], str], prefix: str) -> Problem:
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in place).lstrip(".")
    key = prefix + text or "the file"
    return Problem(key, problem.rule, problem.value, problem.remedy, source if isinstance(source, str) else source(key))


def _cut(content: object, place: Path, lost: set[Path]) -> bool:
    """Take a part out, or what holds it where it is not there itself; False where that is everything."""
    lost.add(place)
    if not place:
        return False
    holder = content
    for part in place[:-1]:
        try:
            holder = holder[part]
        except (KeyError, IndexError, TypeError):
            if any(place[:depth] in lost for depth in range(1, len(place))):
                return True  # went with what held it
            return _cut(content, place[:-1], lost)  # a name with dots is no place
    if isinstance(holder, dict) and place[-1] in holder:
        del holder[place[-1]]
        return True
    if isinstance(holder, list) and isinstance(place[-1], int) and holder[place[-1]] is not _LOST:
        holder[place[-1]] = _LOST
        return True
    return _cut(content, place[:-1], lost)


def _problems(model: type[Declared], error: Mapping[str, Any]) -> list[tuple[Path, Problem, Path | None]]:
    """An error of pydantic's as problems: place, problem, and the mapping whose keys it compares, if it does."""
    place, kind, value = error["loc"], error["type"], error["input"]
    raised = error.get("ctx", {}).get("error")
    if isinstance(raised, InputError):
        among = place if _model_at(model, place) and isinstance(value, Mapping) else None
        return [(place + _parts(problem.key), problem, among) for problem in raised.problems]
    if kind == "missing":
        info = names(_model_at(model, place[:-1]))[place[-1]]
        return [(place, Problem("", "is missing", None, info.json_schema_extra["missing"]), None)]
    if kind == "extra_forbidden":
        return [(place, _unknown(_model_at(model, place[:-1]), place[-1], value), None)]
    if kind == "model_type":
        rule, remedy = _model_at(model, place).not_a_mapping(place, value)
        return [(place, Problem("", rule, value, remedy), None)]
    return [(place, Problem("", error["msg"], value), None)]


def _unknown(model: type[Declared], name: object, value: object) -> Problem:
    if name in model.refused:
        reason, remedy = model.refused[name]
        return Problem("", f"has no meaning for {model.title}: {reason}", value, remedy)
    if name in model.meant:
        return Problem("", model.unknown, None, model.meant[name])
    within = [part for part in names(model) if name in _names_at(model, (part,))]
    if within:
        return Problem("", model.unknown, None, f"it is a key of {' or of '.join(within)}: write it there")
    known, numbered = tuple(names(model)), _NUMBERED.fullmatch(str(name))
    if numbered and numbered[1] in known:
        remedy = f"there is one '{numbered[1]}' and no second: leave out the one that is not needed"
        return Problem("", model.unknown, None, remedy)
    return Problem("", model.unknown, None, nearest(str(name), known))


def _names_at(model: type[Declared], place: Path) -> tuple[str, ...]:
    """The keys of the mapping at a place; none where a plain value or a list stands."""
    found = _model_at(model, place)
    return tuple(names(found)) if found is not None else ()


def _parts(key: str) -> Path:
    return tuple(key.split(".")) if key else ()


def _model_at(model: type[Declared], place: Path) -> type[Declared] | None:
    """The model of the mapping at a place; None where a plain value stands."""
    for part in place:
        if model is None:
            return None
        model = model if isinstance(part, int) else inner_model(names(model)[part])
    return model
