"""Numbers as programs and people write them, and the marks that they write where there is none."""

import re
from collections.abc import Sequence

_ABSENT = re.compile(
    r"|[-?*#_=]+|n\.?/?a\.?|#n/a|<na>|nat|null|none|nil|no[ _]?data|missing|invalid|err(or)?"
    r"|#(nv|num!|div/0!|value!|wert!)"
    r"|\+?o\.?l\.?|o\.?v\.?[ldr]\w?|over(flow|range|load)?|[+-]?1\.#\w+|[+-]?∞",
    re.I,
)
_MINUS = str.maketrans("\u2212\u2013", "--")  # a minus and a dash that typesetters write for it
_BLANKS = re.compile("[\u00a0\u2009\u202f' \u2019](?=\\d{3})")  # that part thousands, an apostrophe too
_FORTRAN = re.compile(r"(?<=[\d.])[dD](?=[+-]?\d)")  # its exponent of double precision
_WITHOUT_E = re.compile(r"(?<=[.,]\d)(?=[+-]\d{2,3}$)|(?<=\d\d)(?=[+-]\d{2,3}$)")  # `9.93+00`, as Nastran has it
_NEGATIVE = re.compile(r"^(?:\((\d+[.,]\d+)\)|(\d+[.,]\d+)\s?-|-\s+(\d+[.,]?\d*))$")  # of accounts, of SAP, apart
# Cells with a sign, of which one in ten ends in a zero where the sign is a decimal one and zeros are not written.
FEWEST_PARTED = 10
_OTHER = {".": ",", ",": "."}


def is_absent(cell: str) -> bool:
    """Whether a cell says that there is no value: it is empty, or holds a mark of an overload or of a fault."""
    return _ABSENT.fullmatch(cell.strip()) is not None


def plain(cell: str) -> str:
    """A number's text with the signs of plain numbers: its minus, its exponent, and no blanks between thousands."""
    text = _NEGATIVE.sub(r"-\1\2\3", cell.strip().translate(_MINUS))
    if "." in text or "," in text:
        text = _WITHOUT_E.sub("e", text)
    return _FORTRAN.sub("e", _BLANKS.sub("", text)) if text[-1:].isdigit() or text[-1:] == "." else text


def is_number(cell: str) -> bool:
    """Whether a cell is a number with a decimal point."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def is_written(cell: str) -> bool:
    """Whether a cell is a number in any of its writings."""
    return is_number(cell) or is_number(plain(cell).replace(",", "."))


def parts_thousands(cells: Sequence[str], sign: str, other_is_decimal: bool = False) -> bool:
    """Whether a sign, `.` or `,`, parts the thousands of a column's numbers.

    Three digits stand behind it every time, and what has none is less than a thousand. Another sign behind it, or a
    second one, decides it; else some numbers must be without it, or the other sign be the decimal one of the file.
    """
    decimal = re.escape(_OTHER[sign])
    parted = re.compile(rf"[+-]?[1-9]\d{{0,2}}(\{sign}\d{{3}})+({decimal}\d*)?")
    small = re.compile(rf"[+-]?\d{{1,3}}({decimal}\d*)?")
    # Most columns are plain numbers, and the first of them settles it: nothing else is looked at.
    if not all(parted.fullmatch(cell.strip()) or is_absent(cell) for cell in cells if sign in cell):
        return False
    held = [cell.strip() for cell in cells if not is_absent(cell)]
    with_sign = [cell for cell in held if sign in cell]
    without = [cell for cell in held if sign not in cell]
    if not with_sign or not all(small.fullmatch(cell) for cell in without):
        return False
    decided = any(_OTHER[sign] in cell or cell.count(sign) > 1 for cell in with_sign)
    return decided or (len(with_sign) >= FEWEST_PARTED and (bool(without) or other_is_decimal))


def are_decimals_alone(lines: Sequence[str]) -> bool:
    """Whether lines hold one number with a decimal comma each, and not two that a comma parts.

    A zero right behind the comma, or an exponent, is none of a number of its own.
    """
    alone = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?")
    texts = [line.strip() for line in lines]
    behind = [text.partition(",")[2] for text in texts]
    shaped = len(texts) > 1 and all(alone.fullmatch(text) for text in texts)
    return shaped and any((one[0] == "0" and len(one) > 1) or "e" in one.lower() for one in behind)
