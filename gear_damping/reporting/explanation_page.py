"""`python -m gear_damping.reporting.explanation_page`: write docs/explanation.md, what every key of the file means."""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from gear_damping.explanation.report_schema import Explanation, Part

HEAD = """# explanation.json

What `task=explain` writes beside its report, key by key. A key that is null or absent says nothing in that answer.
Figures of effects are in the units of [effects.md](effects.md), of an oscillator in the units of its records. Written
by `make docs` from the declarations that tests hold every answer against.
"""
_PLAIN = {str: "text", float: "number", int: "whole number", bool: "true or false", type(None): "null", dict: "mapping"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the page; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m gear_damping.reporting.explanation_page", description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path("docs"), help="where explanation.md is written")
    path = parser.parse_args(arguments).folder / "explanation.md"
    path.write_text(page(), encoding="utf-8")
    print(f"wrote {path}")
    return 0


def page() -> str:
    """The file, and every mapping in it, as tables."""
    return "\n".join([HEAD, *(line for part in _parts(Explanation) for line in _table(part))]).rstrip() + "\n"


def _parts(part: type[Part]) -> list[type[Part]]:
    """A mapping and those in it, each once, in the order in which they come up."""
    found = {part: None}
    for info in part.model_fields.values():
        for inner in _models(info.annotation):
            found |= dict.fromkeys(_parts(inner))
    return list(found)


def _models(kind: Any) -> list[type[Part]]:
    if isinstance(kind, type) and issubclass(kind, Part):
        return [kind]
    return [model for argument in get_args(kind) for model in _models(argument)]


def _table(part: type[Part]) -> Iterator[str]:
    title = "The file" if part is Explanation else f"`{part.__name__}`"
    yield f"## {title}\n"
    if part is not Explanation:
        yield f"{part.__doc__}\n"
    yield "| key | holds | unit | meaning |"
    yield "|---|---|---|---|"
    for name, info in part.model_fields.items():
        unit = (info.json_schema_extra or {}).get("unit") or "–"
        yield f"| `{name}` | {_holds(info)} | {unit} | {info.description} |"
    yield ""


def _holds(info: FieldInfo) -> str:
    return _kind(info.annotation).replace(" or null", ", or null" if info.is_required() else ", or absent")


def _kind(kind: Any) -> str:
    origin, inside = get_origin(kind), get_args(kind)
    if origin is Literal:
        return ", ".join(f"`{value}`" for value in inside)
    if origin in (Union, UnionType):
        return " or ".join(_kind(one) for one in inside)
    if origin is list:
        return f"list of {_kind(inside[0])}"
    if origin is tuple:
        return "[low, high]"
    if origin is dict:
        return f"mapping of {_kind(inside[1])} by name"
    return _PLAIN.get(kind) or f"[`{kind.__name__}`](#{kind.__name__.lower()})"


if __name__ == "__main__":
    raise SystemExit(main())
