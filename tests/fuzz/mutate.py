"""Ways to damage what was valid: bytes of a file, nodes of a tree, words of a command."""

from __future__ import annotations

import copy
import random
from collections.abc import Sequence
from typing import Any

WORDS = (
    b"nan", b"inf", b"-inf", b"1e400", b"-1", b"0", b"", b",", b";", b"\n", b"\r\n", b"\x00", b"\xff\xfe", b'"', b"'",
    b"#", b"%s", b"{}", b"\xef\xbb\xbf", b"1.2.3", b"99999999999999999999", b"true", b"2024-01-01", b"=1+1", b"\\",
)  # fmt: skip
NUMBERS = (0, 1, -1, 2, 0.5, -0.0, 1e308, -1e308, 1e-320, 2**31, 2**63, 10**40, float("nan"), float("inf"))
ODD = (
    None, True, False, "", "x", "1", "nan", "../../etc/passwd", "/dev/zero", "ü", "\x00", "a" * 5000, [], {}, [[]],
    [None], {"value": None}, {"value": []}, {"unit": "m"}, {"value": 1, "unit": "furlong"}, {"value": 1, "unit": None},
    {"value": {"value": 1}}, {1: 2}, {None: 1}, [1, 2, 3], {"column": 99}, "80um", "3 kHz", "1e", "=",
)  # fmt: skip


def damaged(content: bytes, source: random.Random) -> bytes:
    """The content of a file after one to six changes of its bytes."""
    found = bytearray(content)
    for _ in range(source.randint(1, 6)):
        source.choice((_flip, _flip, _cut, _insert, _word, _double, _swap, _number, _truncate))(found, source)
    return bytes(found)


def _place(found: bytearray, source: random.Random) -> int:
    """Anywhere; half of the time in the head, where formats say what they are."""
    end = min(len(found), 600) if source.random() < 0.5 else len(found)
    return source.randrange(end) if end else 0


def _flip(found: bytearray, source: random.Random) -> None:
    if found:
        found[_place(found, source)] ^= 1 << source.randrange(8)


def _number(found: bytearray, source: random.Random) -> None:
    """A field of one to eight bytes becomes extreme."""
    at, length = _place(found, source), source.choice((1, 2, 4, 8))
    value = source.choice((0, 1, 2 ** (8 * length) - 1, 2 ** (8 * length - 1), 2 ** (8 * length - 1) - 1))
    found[at : at + length] = value.to_bytes(length, source.choice(("little", "big")))


def _cut(found: bytearray, source: random.Random) -> None:
    at = _place(found, source)
    del found[at : at + source.choice((1, 2, 8, 64, 512))]


def _insert(found: bytearray, source: random.Random) -> None:
    at = _place(found, source)
    found[at:at] = source.randbytes(source.choice((1, 2, 8, 64)))


def _word(found: bytearray, source: random.Random) -> None:
    at = _place(found, source)
    found[at : at + source.randint(0, 6)] = source.choice(WORDS)


def _double(found: bytearray, source: random.Random) -> None:
    at = _place(found, source)
    found[at:at] = found[at : at + source.choice((4, 32, 256))] * source.randint(1, 3)


def _swap(found: bytearray, source: random.Random) -> None:
    one, two, length = _place(found, source), _place(found, source), source.choice((1, 4, 16))
    first, second = found[one : one + length], found[two : two + length]
    if len(first) == len(second):
        found[one : one + length], found[two : two + length] = second, first


def _truncate(found: bytearray, source: random.Random) -> None:
    if source.random() < 0.3:
        del found[_place(found, source) :]


def changed_tree(tree: Any, source: random.Random) -> Any:
    """A tree of mappings and lists after one to three changes of its nodes."""
    found = copy.deepcopy(tree)
    for _ in range(source.randint(1, 3)):
        holders = list(_holders(found))
        if not holders:
            return found
        holder, key = source.choice(holders)
        _change(holder, key, source)
    return found


def _holders(node: Any) -> list[tuple[Any, Any]]:
    found = []
    items = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, value in items:
        found.append((node, key))
        found += _holders(value)
    return found


def _change(holder: Any, key: Any, source: random.Random) -> None:
    value = holder[key]
    way = source.randrange(7)
    if way == 0:
        del holder[key]
    elif way == 1:
        holder[key] = source.choice(ODD)
    elif way == 2:
        holder[key] = source.choice(NUMBERS)
    elif way == 3 and isinstance(holder, dict):
        holder[source.choice(("file", "column", "unit", "value", "x", "", 7, None, True, f"{key}s"))] = value
    elif way == 4 and isinstance(value, (int, float)) and not isinstance(value, bool):
        holder[key] = value * source.choice((-1, 1e-9, 1e9, 0))
    elif way == 5:
        holder[key] = [value, value]
    else:
        holder[key] = str(value)


def changed_words(words: Sequence[str], source: random.Random) -> list[str]:
    """The words of a command after one to three changes."""
    found = list(words)
    for _ in range(source.randint(1, 3)):
        place = source.randrange(len(found))
        key, _, value = found[place].partition("=")
        odd = str(source.choice((*ODD, *NUMBERS)))
        found[place] = source.choice(
            (f"{key}={odd}", f"{key}", f"{key}x={value}", f"{key}.{key}={value}", f"{key}={value}{value}", odd,
             f"~{key}", f"{key}=[{value}", f"+{key}={value}", f"{key}=", f"{key}={{{key}: {odd}}}")
        )  # fmt: skip
    return found
